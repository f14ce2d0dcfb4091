#include "scenes/voxels/svo_builder.h"

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "modules/config/error.h"
#include "scenes/meshes/mesh.h"
#include "scenes/voxels/voxeliser.h"

namespace rtusim {
namespace {

const std::string models = RTUSIM_SOURCE_DIR "/testbench/golden/svo/models/";
const std::string data = RTUSIM_SOURCE_DIR "/scenes/data/";

// Voxels filled one by one, and some cubes as a whole, so that there are leaves on all levels.
voxel_grid random_grid(unsigned resolution, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution filled(share);
  voxel_grid grid(resolution);
  for (unsigned z = 0; z < resolution; ++z)
    for (unsigned y = 0; y < resolution; ++y)
      for (unsigned x = 0; x < resolution; ++x)
        if (filled(random)) grid.fill(x, y, z);
  for (unsigned level = 1; level < grid.levels(); ++level)
    grid.fill_cube(level, static_cast<std::uint32_t>(random() & ((1U << (3 * (grid.levels() - level))) - 1)));
  return grid;
}

// How many children the unit as built would look for at another word.
unsigned misplaced_as_built(const svo_image& image, std::uint64_t entry = 0) {
  const std::uint32_t word = image.words[entry];
  if (child_nodes(word) == 0) return 0;
  const std::uint64_t group = child_group(image, entry);
  unsigned misplaced = 0;
  for (unsigned slot = 0; slot < 8; ++slot) {
    if (((node_mask(word) >> slot) & 1) == 0) continue;
    // Behind a far pointer it takes the far word's bits 14:8 and 6:0 for the masks.
    const std::uint32_t far_word = is_far(word) ? image.words[entry + child_pointer(word)] : 0;
    const unsigned seen = is_far(word) ? child_nodes_before(far_word & 0x7f7f, slot) : child_nodes_before(word, slot);
    misplaced += seen != child_nodes_before(word, slot);
    misplaced += misplaced_as_built(image, group + child_nodes_before(word, slot));
  }
  return misplaced;
}

}  // namespace

TEST_CASE("the golden models rebuilt from their voxels are the same words", "[svo_builder]") {
  struct model {
    const char* name;
    unsigned resolution;
    bool far_as_built;
  };
  const model table[] = {{"dragon_8", 8, false},
                         {"dragon_32", 32, false},
                         {"dragon_32s", 32, false},
                         {"dragon_128", 128, false},
                         {"dragon_256_farok", 256, true}};
  for (const model& m : table) {
    CAPTURE(m.name);
    const svo_image golden = read_svo(models + m.name + ".svo");
    const svo_image rebuilt = build_svo(voxels_of(golden, m.resolution), m.name, {m.far_as_built});
    CHECK((rebuilt.words == golden.words));
  }
}

TEST_CASE("an image's voxels are the grid's", "[svo_builder]") {
  for (const unsigned resolution : {2U, 4U, 8U, 16U, 32U})
    for (const double share : {0.01, 0.3, 0.5, 0.9, 0.999})
      for (unsigned seed = 0; seed < 5; ++seed) {
        CAPTURE(resolution, share, seed);
        const voxel_grid grid = random_grid(resolution, share, seed);
        if (grid.count() == 0) continue;
        const svo_image image = build_svo(grid, "random");
        const svo_summary summary = describe(image, "random");
        CHECK(summary.filled_voxels << (3 * (grid.levels() - summary.levels)) == grid.count());
        CHECK(summary.nodes == image.words.size());
        CHECK((voxels_of(image, resolution) == grid));
      }
}

TEST_CASE("the smallest and the fullest images", "[svo_builder]") {
  voxel_grid full(16);
  full.fill_cube(4, 0);
  CHECK(build_svo(full, "full").words == std::vector<std::uint32_t>{0x0000ffff});

  voxel_grid octant(16);
  octant.fill_cube(3, 5);
  CHECK(build_svo(octant, "octant").words == std::vector<std::uint32_t>{0x00002020});

  voxel_grid voxel(8);
  voxel.fill(7, 0, 0);
  CHECK(build_svo(voxel, "voxel").words == std::vector<std::uint32_t>{0x00010200, 0x00010200, 0x00000202});

  voxel_grid coarse(2);
  coarse.fill(0, 1, 0);
  CHECK(build_svo(coarse, "coarse").words == std::vector<std::uint32_t>{0x00000404});
  CHECK((voxels_of(build_svo(coarse, "coarse"), 2) == coarse));

  CHECK_THROWS_AS(build_svo(voxel_grid(8), "empty"), input_error);
  CHECK_THROWS_AS(voxels_of(build_svo(voxel, "voxel"), 4), simulation_error);
}

TEST_CASE("coarse voxels are filled if anything in them is", "[svo_builder]") {
  const voxel_grid grid = random_grid(32, 0.01, 9);
  const svo_image image = build_svo(grid, "random");
  voxel_grid coarse(8);
  for (unsigned z = 0; z < 32; ++z)
    for (unsigned y = 0; y < 32; ++y)
      for (unsigned x = 0; x < 32; ++x)
        if (grid.at(x, y, z)) coarse.fill(x / 4, y / 4, z / 4);
  CHECK((coarse_voxels_of(image, 8) == coarse));
  CHECK((coarse_voxels_of(image, 64) == voxels_of(image, 64)));
  // Twenty levels of one shared descriptor behind another, and nothing at their end.
  svo_image shared;
  for (int level = 0; level < 20; ++level) shared.words.push_back(make_descriptor(false, 1, 0x01, 0));
  shared.words.push_back(make_descriptor(false, 0, 0, 0));
  CHECK(coarse_voxels_of(shared, 4).count() == 0);
}

TEST_CASE("far pointers reach what 15 bits do not", "[svo_builder]") {
  const voxel_grid grid = random_grid(128, 0.3, 1);
  const svo_image image = build_svo(grid, "random");
  const svo_summary summary = describe(image, "random");
  CHECK(summary.far_words >= 6);
  CHECK(image.words.size() == summary.nodes + summary.far_words);
  CHECK((voxels_of(image, 128) == grid));
  CHECK(misplaced_as_built(image) > 0);

  const svo_image as_built = build_svo(grid, "random", {true});
  CHECK((voxels_of(as_built, 128) == grid));
  CHECK(misplaced_as_built(as_built) == 0);
  CHECK(as_built.words.size() > image.words.size());
}

TEST_CASE("an image beyond the address space is built, and refused by its check", "[svo_builder]") {
  const voxel_grid grid = random_grid(256, 0.3, 2);
  const svo_image image = build_svo(grid, "random");
  CHECK(image.words.size() > (std::size_t{1} << 20));
  CHECK_THROWS_AS(check_svo(image, "random"), input_error);
  CHECK_NOTHROW(check_svo(image, "random", {22, 11}));
  CHECK((voxels_of(image, 256) == grid));
}

TEST_CASE("the dragon at 256^3 needs far pointers", "[svo_builder]") {
  const voxel_grid grid = voxelise_surface(read_mesh(data + "dragon_res3.ply.gz"), 256);
  const svo_image image = build_svo(grid, "dragon");
  CHECK(describe(image, "dragon").far_words == 3);
  CHECK((voxels_of(image, 256) == grid));
}

}  // namespace rtusim
