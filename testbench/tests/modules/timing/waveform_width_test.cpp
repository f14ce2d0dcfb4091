// Variables of a waveform at the ends of their width, read back.

#include "modules/timing/waveform.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/timing/clock_domain.h"
#include "testbench/bench/stream.h"
#include "testbench/tests/scratch.h"
#include "testbench/tests/vcd.h"

namespace rtusim {
namespace {

enum class letter : std::uint8_t { a, b, c };

/// Registers of many widths, which move at every edge, and more of them than codes of two characters.
class registers final : public unit {
 public:
  explicit registers(const sc_core::sc_module_name& name) : unit(name), many_(2 * 94 * 94) {
    for (std::uint32_t i = 0; i < many_.size(); ++i) many_[i] = i;
  }

  static std::uint64_t word(cycle c) {
    constexpr std::uint64_t top = std::uint64_t{1} << 63;
    const std::uint64_t words[] = {0, ~std::uint64_t{0}, top, top >> 1, 1, 0xA5A5A5A5A5A5A5A5, top | 1, 2};
    return words[c % 8];
  }

 private:
  void reset() override {}
  void settle_registers() override {
    word_ = word(next_edge());
    signed_ = static_cast<std::int64_t>(word_);
    byte_ = static_cast<std::int8_t>(next_edge() % 2 == 0 ? -1 : 1);
    bit_ = next_edge() % 2 != 0;
    letter_ = static_cast<letter>(next_edge() % 3);
  }
  bool level(const channel_base&) const override { return false; }
  void trace(waveform& w) const override {
    for (const unsigned bits : {1u, 2u, 31u, 32u, 33u, 62u, 63u, 64u}) w.add(word_, fmt::format("registers.word_{}", bits), bits);
    w.add(word_, "registers.word");
    w.add(signed_, "registers.signed_63", 63);
    w.add(signed_, "registers.signed");
    w.add(byte_, "registers.byte_2", 2);
    w.add(byte_, "registers.byte");
    w.add(bit_, "registers.bit");
    w.add(letter_, "registers.letter");
    for (std::size_t i = 0; i < many_.size(); ++i) w.add(many_[i], fmt::format("registers.many_{}", i));
  }

  std::uint64_t word_ = 0;
  std::int64_t signed_ = 0;
  std::int8_t byte_ = 0;
  bool bit_ = false;
  letter letter_ = letter::a;
  std::vector<std::uint32_t> many_;
};

}  // namespace

TEST_CASE("waveform: values of 1, 63 and 64 bits, and of more variables than codes of two characters", "[timing]") {
  const test::scratch_folder folder;
  {
    clock_domain clock("clock_domain", 100);
    const std::vector<std::uint32_t> items(20);
    stream_source<std::uint32_t> source("source", {}, items);
    stream_sink<std::uint32_t> sink("sink", {}, items.size());
    registers unit("registers");
    channel<std::uint32_t> between("between");
    source.out(between);
    sink.in(between);
    waveform w(folder / "w.vcd", {});
    clock.record(w, 0, never);
    clock.start();
    w.close();
  }
  const test::vcd read(folder / "w.vcd");
  REQUIRE(read.cycles() == 20);
  const auto low = [](std::uint64_t value, unsigned bits) { return bits == 64 ? value : value % (std::uint64_t{1} << bits); };
  for (cycle c = 0; c < 20; ++c) {
    CAPTURE(c);
    const std::uint64_t word = registers::word(c);
    for (const unsigned bits : {1u, 2u, 31u, 32u, 33u, 62u, 63u, 64u}) {
      const std::string name = fmt::format("registers.word_{}", bits);
      CAPTURE(name);
      CHECK(read.width(name) == bits);
      CHECK(read.value(c, name) == low(word, bits));
    }
    CHECK(read.value(c, "registers.word") == word);
    CHECK(read.value(c, "registers.signed") == word);
    CHECK(read.value(c, "registers.signed_63") == low(word, 63));
    CHECK(read.value(c, "registers.byte_2") == (c % 2 == 0 ? 3 : 1));
    CHECK(read.value(c, "registers.byte") == (c % 2 == 0 ? 0xFF : 1));
    CHECK(read.value(c, "registers.bit") == c % 2);
    CHECK(read.value(c, "registers.letter") == c % 3);
    CHECK(read.value(c, "cycle") == c);
    CHECK(read.value(c, "between.transfers") == c);
  }
  for (const auto& [name, bits] : {std::pair{"word", 64u}, {"signed", 64u}, {"byte", 8u}, {"bit", 1u}, {"letter", 8u}, {"many_0", 32u}})
    CHECK(read.width(std::string("registers.") + name) == bits);
  for (std::uint64_t i = 0; i < 2 * 94 * 94; ++i) REQUIRE(read.value(0, fmt::format("registers.many_{}", i)) == i);
}

}  // namespace rtusim
