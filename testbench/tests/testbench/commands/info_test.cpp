// The figures of `info`, counted again from the words of the file.

#include "testbench/commands/info_command.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/formats/svo_image.h"
#include "scenes/voxels/svo_builder.h"
#include "testbench/tests/program.h"
#include "testbench/tests/random.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

using test::scratch_folder;

const std::string golden = RTUSIM_SOURCE_DIR "/testbench/golden/svo/models/";

/// The same figures by a walk from the root down over the file's bytes.
class counted {
 public:
  explicit counted(const std::string& bytes) : bytes_(bytes) {
    depth_of(0, 1);
    walk(0, 1, {0, 0, 0});
  }

  std::string text() const {
    const std::uint64_t edge = std::uint64_t{1} << levels_;
    const double share = static_cast<double>(filled_) / static_cast<double>(edge * edge * edge);
    std::string all = fmt::format("octree of {} levels: {} voxels an edge\n{:>12} bytes\n{:>12} nodes\n{:>12} far words\n{:>12} leaves\n",
                                  levels_, edge, bytes_.size(), nodes_.size(), far_words_.size(), leaves_);
    all += fmt::format("{:>12} voxels filled ({:.3f} % of the cube)\n", filled_, 100 * share);
    for (std::size_t k = 0; k < 3 && filled_ != 0; ++k)
      all += fmt::format("{} {:>10} to {}, the first and the last voxel filled\n", "xyz"[k], first_[k], last_[k]);
    return all;
  }

 private:
  std::uint64_t word(std::uint64_t index) const {
    std::uint64_t sum = 0;
    for (std::size_t b = 4; b-- > 0;) sum = sum * 256 + static_cast<unsigned char>(bytes_.at(4 * index + b));
    return sum;
  }
  /// The words of the children that have one, by slot; 0 for the others.
  std::array<std::uint64_t, 8> children(std::uint64_t at) {
    std::array<std::uint64_t, 8> found{};
    const std::uint64_t w = word(at);
    std::uint64_t next = at + w / 65'536 % 32'768;
    bool any = false;
    for (unsigned slot = 0; slot < 8; ++slot) any = any || (bit(w, 8 + slot) && !bit(w, slot));
    if (!any) return found;
    if (bit(w, 31)) {
      far_words_.insert(next);
      next = at + word(next);
    }
    for (unsigned slot = 0; slot < 8; ++slot)
      if (bit(w, 8 + slot) && !bit(w, slot)) found[slot] = next++;
    return found;
  }
  static bool bit(std::uint64_t w, unsigned n) { return w >> n & 1; }

  void depth_of(std::uint64_t at, unsigned level) {
    levels_ = std::max(levels_, level);
    for (const std::uint64_t child : children(at))
      if (child != 0) depth_of(child, level + 1);
  }
  void walk(std::uint64_t at, unsigned level, std::array<std::uint64_t, 3> lower) {
    const std::uint64_t w = word(at);
    const bool is_new = nodes_.insert(at).second;
    const std::uint64_t half = std::uint64_t{1} << (levels_ - level);
    const auto below = children(at);
    for (unsigned slot = 0; slot < 8; ++slot) {
      auto corner = lower;
      for (unsigned k = 0; k < 3; ++k) corner[k] += bit(slot, k) ? half : 0;
      if (below[slot] != 0) walk(below[slot], level + 1, corner);
      if (!bit(w, slot)) continue;
      if (is_new) ++leaves_;
      filled_ += half * half * half;
      for (std::size_t k = 0; k < 3; ++k) {
        first_[k] = std::min(first_[k], corner[k]);
        last_[k] = std::max(last_[k], corner[k] + half - 1);
      }
    }
  }

  const std::string& bytes_;
  unsigned levels_ = 0;
  std::set<std::uint64_t> nodes_, far_words_;
  std::uint64_t leaves_ = 0, filled_ = 0;
  std::array<std::uint64_t, 3> first_{~std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0}}, last_{};
};

std::string bytes_of_words(const std::vector<std::uint32_t>& words) {
  std::string bytes;
  for (const std::uint32_t w : words)
    for (unsigned b = 0; b < 4; ++b) bytes += static_cast<char>(w >> 8 * b & 0xff);
  return bytes;
}

}  // namespace

TEST_CASE("info: an octree's figures, far words and shared subtrees among them", "[convert]") {
  const scratch_folder folder;
  // The root's lowest eighth is filled; in its highest the highest voxel is, behind a far pointer.
  CHECK(info_text(folder.file("far.svo", bytes_of_words({0x80018101, 2, 0x00008080}))) ==
        "octree of 2 levels: 4 voxels an edge\n          12 bytes\n           2 nodes\n           1 far words\n           2 leaves\n"
        "           9 voxels filled (14.062 % of the cube)\nx          0 to 3, the first and the last voxel filled\n"
        "y          0 to 3, the first and the last voxel filled\nz          0 to 3, the first and the last voxel filled\n");
  // One voxel, at (1, 2, 3) of 4: the eighth 6, and in it the voxel 5.
  CHECK(info_text(folder.file("one.svo", bytes_of_words({0x00014000, 0x00002020}))) ==
        "octree of 2 levels: 4 voxels an edge\n           8 bytes\n           2 nodes\n           0 far words\n           1 leaves\n"
        "           1 voxels filled (1.562 % of the cube)\nx          1 to 1, the first and the last voxel filled\n"
        "y          2 to 2, the first and the last voxel filled\nz          3 to 3, the first and the last voxel filled\n");
  // Two eighths that lead to the same voxels, one by a far word: each descriptor and leaf counts once, the voxels twice.
  CHECK(info_text(folder.file("shared.svo", bytes_of_words({0x00010300, 0x00030100, 0x80010100, 2, 0x00000303}))) ==
        "octree of 3 levels: 8 voxels an edge\n          20 bytes\n           4 nodes\n           1 far words\n           2 leaves\n"
        "           4 voxels filled (0.781 % of the cube)\nx          0 to 5, the first and the last voxel filled\n"
        "y          0 to 0, the first and the last voxel filled\nz          0 to 0, the first and the last voxel filled\n");
}

TEST_CASE("info: the figures of octrees, by another walk over their words", "[convert]") {
  for (const char* name : {"dragon_8", "dragon_32", "dragon_32s", "dragon_128", "dragon_256_farok", "rand_16_far", "deep_4096"}) {
    CAPTURE(name);
    const std::string file = golden + name + ".svo";
    CHECK(info_text(file) == counted(test::bytes_of(file)).text());
  }
  const scratch_folder folder;
  test::rng random(5);
  for (unsigned n = 0; n < 40; ++n) {
    // A few voxels in a part of the cube, so that the bounds tell the axes apart.
    voxel_grid grid(n % 2 == 0 ? 16 : 64);
    std::array<unsigned, 3> least{}, room{};
    for (std::size_t k = 0; k < 3; ++k) {
      least[k] = random() % grid.resolution();
      room[k] = 1 + random() % (grid.resolution() - least[k]);
    }
    for (unsigned i = 0; i < 1 + n * n; ++i)
      grid.fill(least[0] + random() % room[0], least[1] + random() % room[1], least[2] + random() % room[2]);
    write_svo(folder / "random.svo", build_svo(grid, "random"));
    CAPTURE(n);
    CHECK(info_text(folder / "random.svo") == counted(test::bytes_of(folder / "random.svo")).text());
  }
}

TEST_CASE("info: voxels, each axis by itself", "[convert]") {
  const scratch_folder folder;
  // In a binvox file y runs fastest, then z, then x: (1, 3, 2) and (2, 0, 1).
  std::string file = "#binvox 1\ndim 4 4 4\ntranslate -1 0.5 3\nscale 2.5\ndata\n";
  for (const auto& [value, count] : {std::pair{0, 27}, {1, 1}, {0, 8}, {1, 1}, {0, 27}}) {
    file += static_cast<char>(value);
    file += static_cast<char>(count);
  }
  CHECK(info_text(folder.file("two.binvox", file)) ==
        "voxels in a cube of 4 an edge; as an octree of 2 levels, 4 voxels an edge:\n          12 bytes\n           3 nodes\n"
        "           0 far words\n           2 leaves\n           2 voxels filled (3.125 % of the cube)\n"
        "x          1 to 2, the first and the last voxel filled\ny          0 to 3, the first and the last voxel filled\n"
        "z          1 to 2, the first and the last voxel filled\n         2.5 long, from -1 0.5 3: where the cube lies\n");
}

TEST_CASE("info: meshes, their bounds, open edges and turned ones", "[convert]") {
  const scratch_folder folder;
  const std::string corners = "v 9 9 9\nv -1 0 0.5\nv 2 0 0.5\nv -1 3.25 0.5\nv -1 0 -4\n";  // the first is of no face
  constexpr auto head = "mesh\n           {} vertices\n           {} triangles\n           {} open edges\n";
  const std::string box = "x           -1 to 2\ny            0 to 3.25\nz           -4 to 0.5\n";
  const auto text = [&](const std::string& faces) { return info_text(folder.file("m.obj", corners + faces)); };
  const auto with = [&](unsigned triangles, unsigned open, const std::string& turned = "") {
    return fmt::format(head, 5, triangles, open) + turned + box;
  };
  const std::string a = "f 2 3 4\n", b = "f 2 5 3\n", c = "f 2 4 5\n", d = "f 3 5 4\n";
  CHECK(text(a + b + c + d) == with(4, 0));
  CHECK(text(a + b + c) == with(3, 3));
  CHECK(text(a + b) == with(2, 4));
  CHECK(text(a + b + c + "f 3 4 5\n") == with(4, 0, "           3 edges whose faces run the same way: some are turned\n"));
  CHECK(text("f 2 4 3\n" + b + c + "f 3 4 5\n") == with(4, 0, "           4 edges whose faces run the same way: some are turned\n"));
  // Two faces that hang together by a turned edge and are open else.
  CHECK(text(a + "f 2 3 5\n") == with(2, 4, "           1 edges whose faces run the same way: some are turned\n"));
}

}  // namespace rtusim
