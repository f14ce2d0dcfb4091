#include "testbench/kinds/bih_host.h"

#include "testbench/kinds/bih_model.h"
#include "testbench/units/bih_bench.h"
#include "testbench/units/triangle_bench.h"

namespace rtusim {

void bih_builder_params::describe(config::section& s) {
  s.number("leaf_triangles", leaf_triangles, {1, 4096}, "triangles", "most triangles of a leaf");
}

void bih_host::describe(config::schema& s, const std::function<bool()>& is_chosen) {
  s.add("driver", driver_, design::home, "rtu");
  s.add("bih_builder", builder_, design::home, "quantisation");
  s.read_when({"driver.norm", "driver.skip_misses", "bih_builder"}, is_chosen, "rtu.core = bih");
}

std::unique_ptr<loaded_model> bih_host::load(const design& d, const scene& what) const {
  return std::make_unique<bih_model>(d, what, driver_, builder_.leaf_triangles);
}

std::vector<lone_unit> bih_host::units() const {
  return {{"t_div", &bench_t_div}, {"triangle_unit", &bench_triangle_unit}, {"bih_core", &bench_bih_core, false, true}};
}

std::vector<std::string> bih_host::timing_only() const { return {"bih_core.rays_in_flight"}; }

host_figures bih_host::blank_figures() const {
  host_figures figures;
  figures.model = std::make_shared<triangle_figures>();
  return figures;
}

}  // namespace rtusim
