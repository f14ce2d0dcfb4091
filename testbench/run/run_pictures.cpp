#include "testbench/run/run_pictures.h"

#include <fmt/format.h>

#include "testbench/pictures/grouped.h"

namespace rtusim {

run_pictures::run_pictures(const run_setup& s, const loaded_model& model, const std::vector<job_packet>& jobs, bool from_driver)
    : setup_(s), model_(model), jobs_(jobs), picture_(s.what.picture, s.unit.fixed_point.fraction_bits, s.unit.has_triangles()) {
  if (model.triangles()) surfaces_.emplace(*model.triangles(), s.unit.quantisation_, s.unit.triangle_unit_.errata.t_halved ? 2 : 1);
  if (from_driver) picture_.leave_out_all_but(jobs);
}

void run_pictures::finish(const run_figures& figures, bool places) {
  picture_.set_way(figures.results.way_cycles());
  if (places) picture_.set_places(model_.places(setup_, jobs_, picture_));

  const rtu_params& rtu = setup_.unit.rtu;
  const std::string name = std::filesystem::path(setup_.what.model.model).filename().string();
  const auto& triangles = model_.triangles();
  const std::string size = triangles ? fmt::format("{} triangles", grouped(triangles->hierarchy.triangles.size()))
                                     : fmt::format("{} voxels an edge", model_.voxels_an_edge());
  const std::uint64_t cycles = figures.results.total_cycles();
  text_ = {fmt::format("{}, {}", name, size),
           fmt::format("{} x {} pixels, {} rays traced by {} {} {} in {} cycles: {:.2f} ms at {} MHz", picture_.width(), picture_.height(),
                       grouped(figures.results.rays), rtu.cores, triangles ? "triangle" : "voxel", rtu.cores == 1 ? "core" : "cores",
                       grouped(cycles), static_cast<double>(cycles) / rtu.clock_mhz / 1e3, rtu.clock_mhz)};
}

}  // namespace rtusim
