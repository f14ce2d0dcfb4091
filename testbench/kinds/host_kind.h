#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "modules/config/report.h"
#include "modules/config/schema.h"
#include "modules/core_bank/kind_list.h"
#include "modules/rtu/design.h"
#include "scenes/scene.h"
#include "testbench/bench/host_figures.h"
#include "testbench/kinds/loaded_model.h"
#include "testbench/units/lone_unit.h"

namespace rtusim {

/// The host's side of a kind of core: its own parameters, and how a model comes into the memories. The list of them is in `host_kinds.cpp`.
class host_kind {
 public:
  virtual ~host_kind() = default;

  /// The kind of core, in `rtu.core`.
  virtual std::string_view word() const = 0;
  /// Adds the host's parameters for it, which are read while its cores are chosen. The object must then stay where it is.
  virtual void describe(config::schema& s, const std::function<bool()>& is_chosen) = 0;

  /// Whether a scene must have a model.
  virtual bool needs_model() const { return true; }
  /// Loads a scene's model for a design's cores. Errors: input_error for a model that can't be used, or that the design can't hold.
  virtual std::unique_ptr<loaded_model> load(const design& d, const scene& what) const = 0;

  /// Its units that can be run alone.
  virtual std::vector<lone_unit> units() const { return {}; }
  /// Of its parameters, hardware's and host's, the sections and keys that change the time of a run alone: neither rays nor walks depend on
  /// them.
  virtual std::vector<std::string> timing_only() const { return {}; }
  /// What figures of the host there are.
  virtual host_figures blank_figures() const { return {}; }

 protected:
  host_kind() = default;
};

/// One of each kind.
class host_kinds {
 public:
  host_kinds();

  /// Adds the parameters of all, beside those of `d`, which must stay where it is, as must this.
  void describe(config::schema& s, const design& d);
  /// The side of a design's cores.
  const host_kind& of(const design& d) const;
  const std::vector<std::unique_ptr<host_kind>>& all() const { return all_; }

  /// The list of all kinds.
  static kind_list<host_kind>& list();

 private:
  std::vector<std::unique_ptr<host_kind>> all_;
};

/// What figures there are, over all kinds of cores. `core_0` and the channel `job` stand for the others of their kind.
std::vector<config::report::entry> all_figures();

}  // namespace rtusim
