#include "testbench/kinds/svo_host.h"

#include "testbench/kinds/svo_model.h"
#include "testbench/units/svo_bench.h"

namespace rtusim {

void svo_host::describe(config::schema& s, const std::function<bool()>& is_chosen) {
  s.add("driver", driver_, design::home, "rtu");
  s.read_when({"driver.last_sign_only", "driver.only_zero_replaced"}, is_chosen, "rtu.core = svo");
}

std::unique_ptr<loaded_model> svo_host::load(const design& d, const scene& what) const {
  return std::make_unique<svo_model>(d, what, driver_);
}

std::vector<lone_unit> svo_host::units() const {
  return {{"svo_core", &bench_svo_core, true, false}, {"float_to_fixed", &bench_float_to_fixed}};
}

}  // namespace rtusim
