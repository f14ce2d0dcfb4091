#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "modules/config/files.h"
#include "modules/formats/packet_widths.h"
#include "modules/timing/offer.h"

namespace rtusim {

class clock_domain;

/// A VCD file (IEEE 1364-2005, 18.2) of every channel, state and counter of a clock domain, for the cycles of a window.
///
/// Cycle c lasts from c to c + 1 periods: the values within it are those that its closing edge samples. `clock` rises as each
/// begins. A channel shows what it offers, and while it offers nothing zeros. What a window shows of a cycle is
/// what a recording of the whole run shows of it.
///
/// Written here and not by SystemC's tracer, which opens files by guessable names, follows links, and does not look whether what it
/// writes comes to the disk.
class waveform {
 public:
  /// `file` is replaced when the recording is complete.
  /// Errors: input_error when it can't be written.
  waveform(const std::filesystem::path& file, const packet_widths& widths);

  /// For units, channels and payloads, in their `trace`: adds one variable of `bits` bits (0: all of its type).
  template <class T>
  void add(const T& variable, const std::string& name, unsigned bits = 0) {
    static_assert(std::is_integral_v<T> || (std::is_enum_v<T> && sizeof(T) == 1));
    const unsigned all = std::is_same_v<T, bool> ? 1 : sizeof(T) * 8;
    const auto value = [](const void* at) { return static_cast<std::uint64_t>(*static_cast<const T*>(at)); };
    variables_.push_back({&variable, value, name, bits != 0 ? bits : all});
  }
  /// The same of what a member function of `owner` tells.
  template <auto Member, class Owner>
  void add_from(const Owner& owner, const std::string& name, unsigned bits) {
    const auto value = [](const void* at) { return static_cast<std::uint64_t>((static_cast<const Owner*>(at)->*Member)()); };
    variables_.push_back({&owner, value, name, bits});
  }
  const packet_widths& widths() const { return widths_; }

  /// Starts the file with the values of the coming cycle.
  void open(clock_domain& domain);
  /// Shows the coming cycle, as it begins. Errors: input_error when the disk is full.
  void show(clock_domain& domain);
  /// Ends the recording before the coming cycle and puts the file in place. Without an open recording there is no file.
  /// Errors: input_error when the file could not be written to its end.
  void close();
  bool recorded() const { return recorded_; }
  /// How many values, unsigned or signed, were wider than their variables, and lost bits.
  std::uint64_t cut_values() const { return cut_values_; }

 private:
  struct traced {
    const void* at;
    std::uint64_t (*value)(const void* at);
    std::string name;  // with those of the modules before it, and points between
    unsigned bits;
    std::string code = {};
    std::uint64_t shown = 0;
  };

  void declare();
  void write_time(std::uint64_t picoseconds);
  void write_value(const traced& v);
  void write_fall();

  packet_widths widths_;
  std::optional<config::output_file> output_;
  std::vector<traced> variables_;  // the first is `clock_`
  fmt::memory_buffer text_;        // to be written
  std::uint64_t fall_ = 0;         // of the cycle that was shown last: its middle, in picoseconds,
  std::uint64_t end_ = 0;          // and its end
  std::uint64_t cut_values_ = 0;
  bool recorded_ = false;
  bool clock_ = false;
  std::uint64_t cycle_ = 0;
};

/// The fields of what runs between the units, as a waveform shows them; each type of payload has its own beside it.
void trace_fields(waveform& w, const std::string& name, const std::uint32_t& word);
void trace_fields(waveform& w, const std::string& name, const std::int64_t& word);

}  // namespace rtusim
