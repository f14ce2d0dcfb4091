#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <type_traits>

#include <systemc>

#include "modules/config/files.h"
#include "modules/formats/packets.h"
#include "modules/formats/triangle_job.h"
#include "modules/timing/offer.h"

namespace rtusim {

class clock_domain;

/// Bits of the packets' words, as which a waveform shows them.
struct packet_widths {
  unsigned t = 32;           ///< t of jobs and results
  unsigned uv = 0;           ///< u and v of results; 0: the cores are no triangle cores
  unsigned position = 0;     ///< of triangle jobs
  unsigned direction = 0;
  unsigned reciprocal = 0;
};

/// A VCD file of every channel, state and counter of a clock domain, for the cycles of a window.
///
/// Cycle c lasts from c to c + 1 periods: the values within it are those that its closing edge samples. `clock` rises as each
/// begins. A channel shows what it offers, and while it offers nothing zeros. What a window shows of a cycle is
/// what a recording of the whole run shows of it.
class waveform : public sc_core::sc_module {
 public:
  /// `file` is replaced when the recording is complete.
  /// Errors: input_error when it can't be written, or is a device or a pipe.
  waveform(const sc_core::sc_module_name& name, std::filesystem::path file, const packet_widths& widths);
  ~waveform() override;

  /// For units, channels and payloads, in their `trace`: adds one variable of `bits` bits (0: all of its type).
  template <class T>
  void add(const T& variable, const std::string& name, unsigned bits = 0) {
    static_assert(std::is_integral_v<T> || (std::is_enum_v<T> && sizeof(T) == 1));
    const int width = static_cast<int>(bits != 0 ? bits : sizeof(T) * 8);
    if constexpr (std::is_same_v<T, bool>) {
      sc_core::sc_trace(file_, variable, name);
    } else if constexpr (std::is_enum_v<T>) {
      sc_core::sc_trace(file_, reinterpret_cast<const unsigned char&>(variable), name, width);
    } else if constexpr (std::is_same_v<T, signed char>) {
      // Without an overload of its own it would be promoted, and the tracer keep the address of a temporary.
      sc_core::sc_trace(file_, reinterpret_cast<const char&>(variable), name, width);
    } else {
      sc_core::sc_trace(file_, variable, name, width);
    }
  }
  const packet_widths& widths() const { return widths_; }

  /// Starts the file with the values of the coming cycle.
  void open(clock_domain& domain);
  /// Shows the coming cycle, as it begins.
  void show(clock_domain& domain);
  /// Ends the recording and puts the file in place. Without an open recording there is no file.
  /// Errors: input_error when the file could not be written to its end.
  void close();
  bool recorded() const { return recorded_; }

 private:
  void fall() { clock_ = false; }

  std::filesystem::path path_;
  packet_widths widths_;
  config::output_file output_;
  std::filesystem::path traced_;  // where SystemC's tracer writes
  sc_core::sc_trace_file* file_ = nullptr;
  sc_core::sc_event half_period_;
  bool recorded_ = false;
  bool clock_ = false;
  std::uint64_t cycle_ = 0;
};

/// The fields of the packets that run between the units, as a waveform shows them.
void trace_fields(waveform& w, const std::string& name, const job_packet& p);
void trace_fields(waveform& w, const std::string& name, const traversal_job& j);
void trace_fields(waveform& w, const std::string& name, const triangle_job& j);
void trace_fields(waveform& w, const std::string& name, const traversal_result& r);
void trace_fields(waveform& w, const std::string& name, const std::uint32_t& word);
void trace_fields(waveform& w, const std::string& name, const std::int64_t& word);

}  // namespace rtusim
