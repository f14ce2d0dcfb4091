#include "modules/memory/memory.h"

#include <catch2/catch.hpp>

#include <vector>

namespace rtusim {

TEST_CASE("memory: addresses count modulo its size, words beyond the image read 0", "[memory]") {
  const std::vector<std::uint32_t> image{7, 8, 9};
  memory::params p;
  p.address_bits = 3;
  const memory unit("memory", p, image);
  const word_view words = unit.words();
  for (std::uint32_t turn = 0; turn < 3; ++turn) {
    CAPTURE(turn);
    CHECK(words[turn * 8] == 7);
    CHECK(words[turn * 8 + 2] == 9);
    CHECK(words[turn * 8 + 3] == 0);
    CHECK(words[turn * 8 + 7] == 0);
  }
  CHECK(words[~0u] == 0);
}

TEST_CASE("memory: an image that is longer is cut", "[memory]") {
  const std::vector<std::uint32_t> image{7, 8, 9};
  memory::params p;
  p.address_bits = 1;
  const memory unit("memory", p, image);
  CHECK(unit.words()[0] == 7);
  CHECK(unit.words()[1] == 8);
  CHECK(unit.words()[2] == 7);
  CHECK(unit.words().size == 2);
}

}  // namespace rtusim
