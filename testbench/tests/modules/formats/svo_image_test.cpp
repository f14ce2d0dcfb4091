#include "modules/formats/svo_image.h"

#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "modules/config/error.h"

namespace rtusim {
namespace {

const std::string models = RTUSIM_SOURCE_DIR "/testbench/golden/svo/models/";

// A folder of its own for a test's files.
class scratch_folder {
 public:
  scratch_folder() : path_(std::filesystem::temp_directory_path() / ("rtusim-svo-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~scratch_folder() { std::filesystem::remove_all(path_); }
  std::filesystem::path file(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

void put(const std::filesystem::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string refusal(const svo_image& image, const svo_limits& limits = {}) {
  try {
    check_svo(image, "m.svo", limits);
  } catch (const input_error& e) {
    return e.what();
  }
  return "accepted";
}

// A chain of nodes with one child each; the last has one leaf.
svo_image chain(unsigned levels) {
  svo_image image;
  for (unsigned i = 1; i < levels; ++i) image.words.push_back(make_descriptor(false, 1, 0x80, 0));
  image.words.push_back(make_descriptor(false, 0, 0x80, 0x80));
  return image;
}

}  // namespace

TEST_CASE("a descriptor's fields", "[svo_image]") {
  constexpr std::uint32_t word = make_descriptor(true, 0x7abc, 0xf5, 0x21);
  STATIC_REQUIRE(word == 0xfabcf521);
  STATIC_REQUIRE(is_far(word));
  STATIC_REQUIRE(child_pointer(word) == 0x7abc);
  STATIC_REQUIRE(valid_mask(word) == 0xf5);
  STATIC_REQUIRE(leaf_mask(word) == 0x21);
  STATIC_REQUIRE(node_mask(word) == 0xd4);
  STATIC_REQUIRE(child_nodes(word) == 4);
  STATIC_REQUIRE(is_valid(word, 0));
  STATIC_REQUIRE_FALSE(is_valid(word, 1));
  STATIC_REQUIRE(is_leaf(word, 5));
  STATIC_REQUIRE_FALSE(is_leaf(word, 7));
  const unsigned before[8] = {0, 0, 0, 1, 1, 2, 2, 3};
  for (unsigned slot = 0; slot < 8; ++slot) {
    CAPTURE(slot);
    CHECK(child_nodes_before(word, slot) == before[slot]);
  }
}

TEST_CASE("the golden models are read, described and written back", "[svo_image]") {
  struct model {
    const char* name;
    unsigned levels;
    std::uint64_t words, nodes, far_words, filled;
  };
  const model table[] = {{"dragon_8", 3, 35, 35, 0, 129},           {"dragon_32", 5, 685, 685, 0, 2357},
                         {"dragon_128", 7, 12804, 12804, 0, 39903}, {"dragon_256_farok", 8, 54871, 52679, 3, 160134},
                         {"rand_16_far", 4, 440, 410, 30, 0},       {"deep_4096", 12, 2278, 2278, 0, 0}};
  const scratch_folder scratch;
  for (const model& m : table) {
    CAPTURE(m.name);
    const auto file = models + m.name + ".svo";
    const svo_image image = read_svo(file);
    const svo_summary summary = describe(image, file);
    CHECK(image.words.size() == m.words);
    CHECK(summary.bytes == m.words * 4);
    CHECK(summary.levels == m.levels);
    CHECK(summary.nodes == m.nodes);
    CHECK(summary.far_words == m.far_words);
    if (m.filled != 0) {
      CHECK(summary.filled_voxels == m.filled);
      CHECK(summary.filled_share == Approx(double(m.filled) / double(std::uint64_t{1} << (3 * m.levels))));
    }
    write_svo(scratch.file("copy.svo"), image);
    CHECK(bytes_of(scratch.file("copy.svo")) == bytes_of(file));
  }
}

TEST_CASE("an image's errors name the file and the word", "[svo_image]") {
  using Catch::Matchers::Contains;
  using Catch::Matchers::StartsWith;
  const auto node = [](std::uint32_t pointer, std::uint32_t valid = 0x01) { return make_descriptor(false, pointer, valid, 0); };
  const std::uint32_t leaf = make_descriptor(false, 0, 0x01, 0x01);
  const std::uint32_t far = make_descriptor(true, 1, 0x01, 0);

  CHECK_THAT(refusal({}), StartsWith("m.svo: an empty image"));
  CHECK_THAT(refusal({{leaf, leaf, leaf}}, {1, 11}), Contains("an image of 3 words; expected at most 2"));
  CHECK_THAT(refusal({{node(2), leaf}}), StartsWith("m.svo: word 0: its children are words 2 to 2"));
  CHECK_THAT(refusal({{node(1, 0x03), leaf}}), StartsWith("m.svo: word 0: its children are words 1 to 2"));
  CHECK_THAT(refusal({{node(1), node(0x7fff)}}), StartsWith("m.svo: word 1: "));
  CHECK_THAT(refusal({{far}}), StartsWith("m.svo: word 0: its far word is word 1"));
  CHECK_THAT(refusal({{far, 3, leaf}}), StartsWith("m.svo: word 0: its children are words 3 to 3"));
  CHECK_THAT(refusal({{far, 0xffffffff, leaf}}), StartsWith("m.svo: word 0: its children are words 4294967295"));
  CHECK_THAT(refusal({{node(0)}}), StartsWith("m.svo: word 0: its child, word 0"));
  CHECK_THAT(refusal({{node(1), node(1), far, 0}}), StartsWith("m.svo: word 2: its child, word 2"));
  CHECK_THAT(refusal({{make_descriptor(false, 0, 0x01, 0x03)}}), StartsWith("m.svo: word 0: leaf mask 0x03, valid mask 0x01"));
  CHECK_THAT(refusal(chain(13)), StartsWith("m.svo: word 12: 13 levels"));
  CHECK_THAT(refusal(chain(4), {20, 2}), StartsWith("m.svo: word 3: 4 levels of descriptors from the root on; expected at most 3"));

  CHECK(refusal(chain(12)) == "accepted");
  CHECK(refusal(chain(3), {20, 2}) == "accepted");
  CHECK(refusal({{far, 2, leaf}}) == "accepted");
  CHECK(refusal({{make_descriptor(true, 0x7fff, 0x01, 0x01)}}) == "accepted");  // a pointer that nobody follows
}

TEST_CASE("a file that is no image is refused", "[svo_image]") {
  const scratch_folder scratch;
  const auto refused = [&](const std::string& bytes, const svo_limits& limits = {}) {
    put(scratch.file("bad.svo"), bytes);
    CHECK_THROWS_AS(read_svo(scratch.file("bad.svo"), limits), input_error);
  };
  refused("");
  refused("abc");
  refused(std::string(4 + 1, '\0'));
  refused(std::string(4 * 3, '\0'), {1, 11});
  refused(std::string(4 * 1000, '\0'), {1, 11});
  CHECK_THROWS_AS(read_svo(scratch.file("none.svo")), input_error);
  CHECK_THROWS_AS(read_svo(scratch.file("")), input_error);
  CHECK_THROWS_AS(write_svo(scratch.file("none/out.svo"), chain(1)), input_error);

  const std::string golden = bytes_of(models + "dragon_32.svo");
  for (std::size_t bytes = 0; bytes < golden.size(); bytes += 37) refused(golden.substr(0, bytes));
}

TEST_CASE("shared subtrees are walked once, and counted wherever they appear", "[svo_image]") {
  // Every child of a node is a word like the others of its level: 8^11 paths to the leaves.
  svo_image image;
  for (unsigned level = 0; level < 11; ++level)
    for (unsigned i = 0; i < (level == 0 ? 1U : 8U); ++i) image.words.push_back(make_descriptor(false, (level == 0 ? 1 : 8 - i), 0xff, 0));
  for (unsigned i = 0; i < 8; ++i) image.words.push_back(make_descriptor(false, 0, 0x81, 0x81));
  const svo_summary summary = describe(image, "shared");
  CHECK(summary.levels == 12);
  CHECK(summary.nodes == image.words.size());
  CHECK(summary.leaves == 16);
  CHECK(summary.filled_voxels == (std::uint64_t{1} << 34));
  CHECK(summary.filled_share == 0.25);
  CHECK(summary.lower == std::array<double, 3>{0, 0, 0});
  CHECK(summary.upper == std::array<double, 3>{1, 1, 1});

  // The last voxel of each axis but y, whose fourth it is, at the end of twelve levels.
  svo_image corner;
  for (unsigned level = 0; level < 12; ++level) {
    const std::uint32_t slot = level < 10 ? 0b101 : 0b111;
    corner.words.push_back(make_descriptor(false, level < 11, 1U << slot, level < 11 ? 0 : 1U << slot));
  }
  const svo_summary cornered = describe(corner, "corner");
  const double voxel = std::ldexp(1.0, -12);
  CHECK(cornered.lower == std::array<double, 3>{1 - voxel, 3 * voxel, 1 - voxel});
  CHECK(cornered.upper == std::array<double, 3>{1, 4 * voxel, 1});
}

TEST_CASE("garbage is refused or sound, and never more", "[svo_image]") {
  std::mt19937 random(1);
  unsigned sound = 0;
  for (unsigned n = 0; n < 3000; ++n) {
    svo_image image;
    for (unsigned i = 0; i < 1 + random() % 200; ++i) {
      auto word = static_cast<std::uint32_t>(random());
      // Mostly small pointers and few children, so that some get far.
      if (n % 3 != 0) word &= 0x801fffff & ~static_cast<std::uint32_t>(random());
      image.words.push_back(n % 2 != 0 ? word & ~(~(word >> 8) & 0xff) : word);
    }
    try {
      describe(image, "garbage");
      ++sound;
    } catch (const input_error&) {}
  }
  CHECK(sound > 0);
  CHECK(sound < 3000);
}

}  // namespace rtusim
