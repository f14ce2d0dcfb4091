#pragma once

#include <array>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include <systemc>

#include "modules/timing/calendar.h"
#include "modules/timing/clock_state.h"
#include "modules/timing/offer.h"

namespace rtusim {

class channel_base;
class unit;
class waveform;

/// How a run goes through the edges of its clock. All are the same model and give the same bytes.
enum class pace : std::uint8_t {
  skipping,  ///< only the edges at which something happens
  stepped,   ///< every edge of every unit: what a waveform needs
  checked,   ///< stepped, and every offer is held against the registers in every cycle
};

/// How much work a run was.
struct clock_stats {
  std::uint64_t edges = 0;       ///< edges that were done
  std::uint64_t unit_edges = 0;  ///< calls of a unit at an edge
  std::uint64_t wake_ups = 0;    ///< of the SystemC process
};

/// The one process of a clock. At an edge it lets the channels transfer that are booked for it, in any order, then calls the units that
/// asked for it. Channels find and book their next transfer themselves, as their offers change.
///
/// Cycle c lasts from SystemC time c periods to c + 1 periods, and its edge closes it: what a waveform shows within the cycle
/// is what the edge samples. Several edges are done in one wake-up while nothing else in SystemC is pending.
class clock_domain : public sc_core::sc_module {
 public:
  clock_domain(const sc_core::sc_module_name& name, double clock_mhz);
  ~clock_domain() override;

  /// The domain that units and channels join as they are constructed: the last one constructed.
  static clock_domain& current();

  /// The edge being done.
  cycle now() const { return clock_.now; }
  /// The edge to be done next: all before it are done.
  cycle next_edge() const { return clock_.next; }
  const sc_core::sc_time& period() const { return period_; }
  clock_stats stats() const;

  void set_pace(pace p) { pace_ = p; }
  /// A run in which nothing transfers for so many cycles ends with a simulation_error that tells who waits for whom.
  void set_watchdog(cycle cycles) { clock_.watchdog = cycles; }
  /// Lets channels transfer and calls units in another order at every edge, from a seed: which must change nothing.
  void shuffle_units(std::uint32_t seed) { shuffle_ = seed; }
  /// Runs the simulation to its end. What a unit throws at an edge comes out here as it was thrown.
  void start();
  /// Ends the simulation after the edge being done.
  void stop() { stopping_ = true; }
  /// `w` records the cycles [from, to); outside the run goes on at its own pace.
  void record(waveform& w, cycle from, cycle to);
  /// From within an edge: the recording begins, or has ended, with the cycle after it.
  void start_recording();
  void stop_recording();
  /// Called before each edge of the paces that step, with the cycle that it closes and all registers as they are in it.
  void set_watcher(std::function<void(cycle)> watcher) { watcher_ = std::move(watcher); }
  /// Called about every hundred thousand edges.
  void set_progress(std::function<void()> tick) { tick_ = std::move(tick); }

  const std::vector<unit*>& units() const { return units_; }
  const std::vector<channel_base*>& channels() const { return channels_; }

 private:
  friend class unit;
  friend class channel_base;
  friend class waveform;

  void add(unit& u);
  clock_state& join(channel_base& c);
  void start_of_simulation() override;
  sc_core::sc_time begin_of(cycle c) const;
  void wake_up();
  void begin_cycle();
  void run_edges();
  void edge(cycle c);
  void call_due();
  void settle_units();
  void check_levels();
  void count_checked();
  [[noreturn]] void report_deadlock() const;
  bool recording(cycle c) const { return waveform_ != nullptr && c >= record_from_ && c < record_to_; }

  sc_core::sc_time period_;
  pace pace_ = pace::skipping;
  std::uint32_t shuffle_ = 0;
  clock_state clock_;
  bool stopping_ = false;
  bool alone_ = false;    // whether SystemC has no other process
  bool settled_ = false;  // whether all units' registers stand at the next edge
  cycle checked_ = 0;     // cycles whose levels were checked
  std::uint64_t edges_to_tick_ = 0;
  std::function<void()> tick_;
  std::exception_ptr error_;  // SystemC would wrap what leaves a process
  std::function<void(cycle)> watcher_;

  std::vector<unit*> units_;
  std::vector<channel_base*> channels_;
  std::vector<booking*> due_;  // at the edge being done: units; where the order is shuffled, channels too
  clock_stats stats_;

  waveform* waveform_ = nullptr;
  cycle record_from_ = never;
  cycle record_to_ = 0;
};

}  // namespace rtusim
