#include "testbench/run/run_pictures.h"

#include <fmt/format.h>

#include "testbench/pictures/grouped.h"

namespace rtusim {

run_pictures::run_pictures(const run_setup& s, const loaded_model& model, const std::vector<job_packet>& jobs, bool from_driver)
    : setup_(s),
      model_(model),
      jobs_(jobs),
      picture_(s.what.picture, s.hardware.kind().fraction_bits(), model.has_surfaces()),
      keep_(model.keeper(s.hardware, jobs, picture_)) {
  if (from_driver) picture_.leave_out_all_but(jobs);
}

void run_pictures::finish(const run_figures& figures, bool places) {
  picture_.set_way(figures.results.way_cycles());
  if (places) picture_.set_places(model_.places(setup_.hardware, jobs_, picture_));

  const rtu_params& rtu = setup_.hardware.rtu;
  const std::string name = std::filesystem::path(setup_.what.model.model).filename().string();
  const std::uint64_t cycles = figures.results.total_cycles();
  text_ = {fmt::format("{}, {}", name, model_.size_text()),
           fmt::format("{} x {} pixels, {} rays traced by {} {} {} in {} cycles: {:.2f} ms at {} MHz", picture_.width(), picture_.height(),
                       grouped(figures.results.rays), rtu.cores, model_.cores_word(), rtu.cores == 1 ? "core" : "cores", grouped(cycles),
                       static_cast<double>(cycles) / rtu.clock_mhz / 1e3, rtu.clock_mhz)};
}

}  // namespace rtusim
