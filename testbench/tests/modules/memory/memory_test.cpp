#include "modules/memory/memory.h"

#include <catch2/catch.hpp>

#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/timing/clock_domain.h"
#include "testbench/tests/in_child.h"

namespace rtusim {
namespace {

/// What `say` tells of a memory with these words and address bits, in a process of its own.
std::string of_memory(const std::vector<std::uint32_t>& image, unsigned address_bits, const std::function<std::string(memory&)>& say) {
  return in_child([&] {
    const clock_domain clock("clock_domain", 100);
    memory::params p;
    p.address_bits = address_bits;
    memory unit("memory", p, image);
    return say(unit);
  });
}

/// Words at some addresses.
std::string at(const memory& unit, const std::vector<std::uint32_t>& addresses) {
  std::string text;
  for (const std::uint32_t a : addresses) text += fmt::format("{} ", unit.words()[a]);
  return text;
}

struct reader final : memory_reader {
  std::uint64_t count;
  explicit reader(std::uint64_t n) : count(n) {}
  std::uint64_t fetches() override { return count; }
};

}  // namespace

TEST_CASE("memory: addresses count modulo its size, words beyond the image read 0", "[memory]") {
  const auto words = [](const memory& unit) { return at(unit, {0, 2, 3, 7, 8, 10, 11, 15, 16, 18, 19, 23, ~0u}); };
  CHECK(of_memory({7, 8, 9}, 3, words) == "7 9 0 0 7 9 0 0 7 9 0 0 0 ");
}

TEST_CASE("memory: an image that is longer is cut", "[memory]") {
  const auto words = [](const memory& unit) { return at(unit, {0, 1, 2}) + std::to_string(unit.words().size); };
  CHECK(of_memory({7, 8, 9}, 1, words) == "7 8 7 2");
}

TEST_CASE("memory: its fetches are those of all its readers", "[memory]") {
  const auto fetches = [](memory& unit) {
    reader one(5), other(1'000'000'000'000);
    unit.attach(one);
    unit.attach(other);
    return std::to_string(unit.statistics().fetches);
  };
  CHECK(of_memory({7}, 3, fetches) == "1000000000005");
  CHECK(of_memory({7}, 3, [](memory& unit) { return std::to_string(unit.statistics().fetches); }) == "0");
}

}  // namespace rtusim
