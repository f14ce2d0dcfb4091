#include "testbench/kinds/bih_model.h"

#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "modules/bih_core/bih_walk.h"
#include "modules/config/error.h"
#include "modules/job_manager/ray_setup.h"
#include "testbench/kinds/bih_walker.h"
#include "testbench/kinds/checksum.h"
#include "testbench/kinds/driver.h"
#include "testbench/pictures/grouped.h"

namespace rtusim {

bih_model::bih_model(const design& d, const scene& what, const triangle_driver_params& driver, unsigned leaf_triangles)
    : driver_(driver),
      model_(load_triangles(what.model.model, d.of<bih_kind>().words, leaf_triangles, d.of<bih_kind>().core.address_bits,
                            what.model.patch_quads)),
      contents_(model_.hierarchy) {}

void bih_model::settle(design& d) const { d.of<bih_kind>().words.edge_shift = model_.edge_shift; }

host_figures bih_model::host() const {
  host_figures h;
  auto figures = std::make_shared<triangle_figures>();
  figures->losses = model_.losses;
  figures->edge_shift = model_.edge_shift;
  h.model = std::move(figures);
  return h;
}

std::vector<job_packet> bih_model::camera_jobs(const design&, const scene& what, unsigned threads, host_figures&) const {
  auto packets = triangle_jobs(what.view, what.picture, model_.grid, driver_.norm, driver_.skip_misses, threads);
  if (packets.empty())
    throw input_error("camera", "no ray meets the box of the model", "a camera that looks at it, or driver.skip_misses = false");
  return packets;
}

std::vector<job_packet> bih_model::list_jobs(const design&, const ray_list& rays, unsigned threads, host_figures&) const {
  return triangle_jobs(rays, model_.grid, driver_.norm, driver_.skip_misses, threads);
}

std::uint64_t bih_model::walk_cycles(const design& d, const std::vector<job_packet>& jobs) const {
  const ray_setup set_up(d.of<bih_kind>().words, model_.hierarchy.corner);
  bih_walk walk(d.of<bih_kind>().core_with_widths(), model_.hierarchy);
  ray_setup_stats ignored;
  std::uint64_t cycles = 0;
  for (const job_packet& packet : jobs) {
    triangle_job job;
    set_up(packet, ignored, job);
    cycles += walk(job.ray, [](std::uint32_t, std::uint64_t) {}).cycles();
  }
  return cycles;
}

std::unique_ptr<ray_walker> bih_model::walker(const design& d) const {
  return std::make_unique<bih_walker>(d.of<bih_kind>(), model_.hierarchy);
}

frame::places bih_model::places(const design&, const std::vector<job_packet>& jobs, const frame& picture) const {
  frame::places where;
  where.points =
      points_of(jobs, picture, [this](const job_packet& job, double distance) { return point_on_ray(job, model_.grid, distance); });
  return where;
}

loaded_model::result_keeper bih_model::keeper(const design& d, const std::vector<job_packet>& jobs, frame& picture) const {
  const bih_kind& kind = d.of<bih_kind>();
  const auto surfaces =
      std::make_shared<triangle_surfaces>(model_, kind.words, triangle_pipeline::distance_unit_of(kind.intersector.errata));
  return [surfaces, &jobs, &picture](const traversal_result& r, std::uint64_t latency_cycles) {
    picture.store(r, latency_cycles, surfaces->at(jobs[r.sequence], static_cast<const mesh_result&>(r)));
  };
}

void bih_model::describe(nlohmann::ordered_json& inputs) const {
  checksum crc;
  for (const auto& words : model_.hierarchy.words) crc(words);
  inputs["model_triangles"] = model_.hierarchy.triangles.size();
  inputs["model_crc32"] = crc.text();
}

std::string bih_model::size_text() const { return grouped(model_.hierarchy.triangles.size()) + " triangles"; }

void bih_model::add_log_line(fmt::memory_buffer& to, cycle c, const traversal_result& any) const {
  const auto& r = static_cast<const mesh_result&>(any);
  fmt::format_to(std::back_inserter(to), "{},{},{},{},{},{},{},{},{}\n", c, r.core, r.job_word, static_cast<int>(r.hit),
                 r.hit ? std::int64_t{model_.faces[r.triangle]} : -1, r.t_hit, r.u, r.v, r.cost);
}

}  // namespace rtusim
