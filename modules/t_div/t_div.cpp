#include "modules/t_div/t_div.h"

namespace rtusim {

t_div::t_div(const sc_core::sc_module_name& name, const params& p)
    : pipeline_unit(name, p.width, p.kind == numeric::divider_kind::iterative ? p.width : 1), divider_(p.width) {}

void t_div::process(const division& operands, quotient& result) {
  const numeric::quotient_bits q = divider_(operands.n, operands.d);
  result = {q.word(divider_.width()), q.err};
  ++stats_.divisions;
  stats_.errors += q.err;
}

void t_div::trace(waveform& w) const {
  pipeline_unit::trace(w);
  w.add(stats_.divisions, std::string(name()) + ".divisions");
  w.add(stats_.errors, std::string(name()) + ".errors");
}

void t_div::params::describe(config::section& s) {
  s.number("width", width, {numeric::least_divider_width, numeric::most_divider_width}, "bits",
           "operands and quotient of the divider alone; in other units it follows from theirs");
  s.choice("kind", kind, numeric::divider_words(), "one stage a bit, or one division at a time in a stage that goes round");
}

void t_div::stats::describe(config::report& r) const {
  r.number("divisions", divisions, "divisions", "operands accepted");
  r.number("errors", errors, "divisions", "of these, those whose signs differ or whose quotient is 1 or more");
}

void trace_fields(waveform& w, const std::string& name, const division& operands) {
  w.add(operands.n, name + ".n");
  w.add(operands.d, name + ".d");
}

void trace_fields(waveform& w, const std::string& name, const quotient& result) {
  w.add(result.word, name + ".word");
  w.add(result.err, name + ".err");
}

}  // namespace rtusim
