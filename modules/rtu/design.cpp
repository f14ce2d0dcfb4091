#include "modules/rtu/design.h"

namespace rtusim {

void rtu_params::describe(config::section& s) {
  s.choice("core", core, core_words(), "kind of the traversal cores");
  s.number("cores", cores, {1, 1024}, "cores", "traversal cores");
  s.real("clock_mhz", clock_mhz, {0.001, 1e6}, "MHz", "clock of all units");
}

void driver_params::describe(config::section& s) {
  s.erratum("last_sign_only", last_sign_only, "only the last negative direction component sets its bit of a", "each one does");
  s.erratum("only_zero_replaced", only_zero_replaced, "only a direction component of 0 is replaced before the division",
            "so is one by which the fixed-point format can't divide");
  s.choice("norm", norm, norm_words(), "directions are scaled so that their components' magnitudes, or squares, add up to 1");
  s.flag("skip_misses", skip_misses, "rays that miss the box of the scene are not sent");
}

void bih_builder_params::describe(config::section& s) {
  s.number("leaf_triangles", leaf_triangles, {1, 4096}, "triangles", "most triangles of a leaf");
}

void design::describe(config::schema& s) {
  s.add("rtu", rtu, home);
  s.entry_form("rtu.core", {{"kind", "rtu.core"}, {"count", "rtu.cores"}});
  s.add("driver", driver, home);
  s.add("fixed_point", fixed_point, home);
  s.add("float_to_fixed", float_to_fixed, home);
  s.add("quantisation", quantisation_, home);
  s.add("bih_builder", bih_builder, home);
  s.add("scheduler", scheduler_, home);
  s.add("svo_core", svo_core, home);
  s.add("bih_core", bih_core, home);
  s.add("t_div", t_div_, home);
  s.add("triangle_unit", triangle_unit_, home);
  s.add("result_manager", result_manager_, home);
  s.add("memory", memory_, home);
  s.read_when({"driver.last_sign_only", "driver.only_zero_replaced", "fixed_point", "float_to_fixed", "svo_core", "memory"}, [this] { return !has_triangles(); },
              "rtu.core = svo");
  s.read_when({"driver.norm", "driver.skip_misses", "quantisation", "bih_builder", "bih_core", "t_div", "triangle_unit"},
              [this] { return has_triangles(); }, "rtu.core = bih");
  s.read_when({"t_div.width"}, [this] { return benched == "t_div"; }, "the unit t_div is alone");
}

bool design::has_triangles() const {
  if (benched.empty()) return rtu.core == rtu_params::core_kind::bih;
  return benched == "t_div" || benched == "triangle_unit" || benched == "bih_core";
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

packet_widths design::packets() const {
  if (!has_triangles()) return {fixed_point.width(), 0, 0, 0, 0};
  const quantisation& q = quantisation_;
  return {q.n + 3, q.m, q.n, q.m, q.m + q.reciprocal_bits};
}

bih_core_params design::bih_core_params_with_widths() const {
  bih_core_params p = bih_core;
  p.widths = quantisation_;
  return p;
}

}  // namespace rtusim
