#include "modules/rtu/design.h"

#include <functional>
#include <string>
#include <type_traits>

namespace rtusim {
namespace {

/// A section that is read as a whole or not at all.
template <class Params>
struct read_when {
  Params& params;
  std::function<bool()> condition;
  std::string words;

  void describe(config::section& s) {
    params.describe(s);
    for (config::parameter& p : s.parameters()) p.when(condition, words);
  }
};

}  // namespace

void rtu_params::describe(config::section& s) {
  s.choice("core", core, core_words(), "kind of the traversal cores");
  s.number("cores", cores, {1, 1024}, "cores", "traversal cores");
  s.real("clock_mhz", clock_mhz, {0.001, 1e6}, "MHz", "clock of all units");
}

void driver_params::describe(config::section& s) {
  s.erratum("last_sign_only", last_sign_only, "only the last negative direction component sets its bit of a", "each one does");
  s.choice("norm", norm, norm_words(), "directions are scaled so that their components' magnitudes, or squares, add up to 1");
  s.flag("skip_misses", skip_misses, "rays that miss the box of the scene are not sent");
}

void design::describe(config::schema& s) {
  s.add("rtu", rtu);
  s.entry_form("rtu.core", {{"kind", "rtu.core"}, {"count", "rtu.cores"}});
  s.add("driver", driver);
  s.add("fixed_point", fixed_point);
  s.add("float_to_fixed", float_to_fixed);
  s.add("scheduler", scheduler_);
  s.add("svo_core", svo_core);
  s.add("result_manager", result_manager_);
  s.add("memory", memory_);
  const auto add_for_triangles = [&](const char* name, auto& params) {
    read_when<std::remove_reference_t<decltype(params)>> section{params, [this] { return has_triangle_units; },
                                                                 "a unit works on triangles"};
    s.add(name, section);
  };
  add_for_triangles("quantisation", quantisation_);
  add_for_triangles("t_div", t_div_);
  add_for_triangles("triangle_unit", triangle_unit_);
}

const std::set<std::string>& design::sections() {
  static const std::set<std::string> names{"rtu",    "driver", "fixed_point",  "float_to_fixed", "scheduler", "svo_core", "result_manager",
                                           "memory", "t_div",  "quantisation", "triangle_unit",  "errata"};
  return names;
}

svo_core_params design::svo_core_params_with_format() const {
  svo_core_params p = svo_core;
  p.format = fixed_point;
  return p;
}

triangle_unit_params design::triangle_unit_params_with_words() const {
  triangle_unit_params p = triangle_unit_;
  p.words = quantisation_;
  p.divider = t_div_.kind;
  return p;
}

}  // namespace rtusim
