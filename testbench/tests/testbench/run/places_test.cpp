// Where pictures say that rays met the model.

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "modules/formats/svo_image.h"
#include "modules/job_manager/job_manager.h"
#include "modules/svo_core/svo_kind.h"
#include "modules/svo_core/svo_walk.h"
#include "scenes/voxels/svo_builder.h"
#include "testbench/kinds/svo_model.h"
#include "testbench/run/job_file.h"
#include "testbench/run/run_setup.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

const std::string source = RTUSIM_SOURCE_DIR;

/// A frame of results as the cores give them, from the walk alone.
frame traced(const run_setup& s, const svo_model& model, const std::vector<job_packet>& jobs) {
  frame picture(s.what.picture, s.hardware.of<svo_kind>().format.fraction_bits);
  const svo_walk walk(s.hardware.of<svo_kind>().core_with_format());
  const numeric::float_to_fixed_converter converter(s.hardware.of<svo_kind>().format, s.hardware.of<svo_kind>().conversion);
  const word_view memory = view_of(model.octree(), s.hardware.of<svo_kind>().memory_);
  for (std::uint32_t n = 0; n < jobs.size(); ++n) {
    numeric::float_to_fixed_stats ignored;
    traversal_job job;
    convert(jobs[n], converter, ignored, job);
    const svo_outcome o = walk(job, memory);
    voxel_result r;
    r.job_word = jobs[n].job_word;
    r.sequence = n;
    r.hit = o.hit;
    r.t_hit = o.t_hit;
    r.normal_axis = o.hit ? o.axis : no_axis;
    r.normal_sign = o.hit ? 1 : 0;
    picture.store(r, 20);
  }
  return picture;
}

/// How far a point lies outside of a voxel, in voxels.
double outside(const std::array<std::uint32_t, 3>& voxel, const std::array<float, 3>& point, unsigned cells) {
  double most = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = (static_cast<double>(point[axis]) + 1) / 2 * cells;
    most = std::max({most, voxel[axis] - at, at - (voxel[axis] + 1)});
  }
  return most;
}

}  // namespace

TEST_CASE("places: every hit names a filled voxel, next to the point where it lies", "[places]") {
  for (const char* architecture : {"espe2019", "espe2019_as_built"})
    for (const char* model_file : {"dragon_32", "dragon_128", "deep_4096"}) {
      // From outside, from within the model, and along its faces.
      for (const char* view : {"camera.near=2", "camera.near=0.5", "camera.near=0.01"}) {
        const run_setup s({"",
                           source + "/testbench/architectures/" + architecture + ".toml",
                           {"frame.width=96", "frame.height=54", "memory.address_bits=24", "svo_core.stack_depth=16", view},
                           source + "/testbench/golden/svo/models/" + model_file + ".svo"});
        const svo_model model(s.hardware, s.what, {});
        const auto jobs = model.jobs(s.hardware, s.what, 1, true).packets;
        const frame picture = traced(s, model, jobs);
        const frame::places where = model.places(s.hardware, jobs, picture);
        CAPTURE(architecture, model_file, view, where.cells);
        REQUIRE(where.cells == model.voxels_an_edge());
        // The words of the octree themselves: down from the root by the voxel's bits.
        const auto is_filled = [&](const std::array<std::uint32_t, 3>& voxel) {
          const svo_image image{model.octree()};
          std::uint32_t entry = 0;
          for (unsigned half = where.cells / 2; half != 0; half /= 2) {
            const unsigned slot = ((voxel[0] & half) != 0) | ((voxel[1] & half) != 0) << 1 | ((voxel[2] & half) != 0) << 2;
            const std::uint32_t word = image.words[entry];
            if (!is_valid(word, slot)) return false;
            if (is_leaf(word, slot)) return true;
            entry = static_cast<std::uint32_t>(child_group(image, entry) + child_nodes_before(word, slot));
          }
          return false;
        };
        std::size_t hits = 0, far = 0;
        for (std::size_t i = 0; i < where.voxels.size(); ++i) {
          if (!picture.pixels()[i].hit) continue;
          ++hits;
          CAPTURE(i, where.voxels[i]);
          REQUIRE(is_filled(where.voxels[i]));
          far += outside(where.voxels[i], where.points[i], where.cells) > 0.01 * where.cells / 32;
        }
        if (std::string(architecture) == "espe2019") CHECK(far <= hits / 100);
        if (std::string(model_file) == "dragon_32" && std::string(view) == "camera.near=2") CHECK(hits > 300);
      }
    }
}

}  // namespace rtusim
