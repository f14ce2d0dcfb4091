#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "modules/config/schema.h"
#include "modules/core_bank/core_bank.h"
#include "modules/timing/waveform.h"

namespace rtusim {

/// A view of what lies in the memories that cores of a kind read, as the host loaded it; each kind derives its own. What it views must
/// outlive the cores.
class memory_contents {
 public:
  virtual ~memory_contents() = default;
};

/// A kind of core, as the unit sees it: its word, its parameters, and how its cores are built. The list of them is in
/// `modules/rtu/core_kinds.cpp`. One object belongs to one design, whose parameters of the kind it holds.
class core_kind {
 public:
  virtual ~core_kind() = default;

  /// In `rtu.core`; the figures of all its cores are added up as `WORD_core`.
  virtual std::string_view word() const = 0;
  virtual std::unique_ptr<core_kind> copy() const = 0;

  /// When a design reads parameters.
  struct readers {
    std::string_view home;            ///< the kind of file that they stand in
    std::function<bool()> is_chosen;  ///< the design's cores, or the unit that is alone, are of this kind
    const std::string& alone;         ///< the unit that is benched alone; empty: a whole RTU
  };
  /// Add the sections for formats of numbers, for the kind's units and for its memories. The object must then stay where it is.
  virtual void describe_formats(config::schema& s, const readers& r) = 0;
  virtual void describe_units(config::schema& s, const readers& r) = 0;
  virtual void describe_memories(config::schema&, const readers&) {}

  /// The widths of its packets, for a waveform.
  virtual packet_widths packets() const = 0;
  /// Of the t of its results, after the binary point.
  virtual unsigned fraction_bits() const = 0;

  /// Why the cycles of a run don't follow from the costs of its rays alone; empty if they do.
  virtual std::string replay_obstacle() const = 0;
  /// What figures a bank of one core has, with nothing counted.
  virtual std::vector<named_figures> blank_figures() const = 0;
  /// Memories with nothing in them.
  virtual std::unique_ptr<memory_contents> blank_contents() const = 0;

  /// Builds cores within the module that is being constructed. `contents` are of this kind.
  virtual std::unique_ptr<core_bank> build(const bank_params& p, const memory_contents& contents) const = 0;

 protected:
  core_kind() = default;
  core_kind(const core_kind&) = default;
  core_kind& operator=(const core_kind&) = default;
};

}  // namespace rtusim
