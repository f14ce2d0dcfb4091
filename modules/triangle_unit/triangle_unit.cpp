#include "modules/triangle_unit/triangle_unit.h"

#include <utility>

namespace rtusim {

triangle_unit::triangle_unit(const sc_core::sc_module_name& name, const params& p)
    : pipeline_unit(name, stages_of(p), p.divider == numeric::divider_kind::iterative ? stages_of(p) - stages_around_divider : 1),
      intersector_(p.words, p.errata) {}

void triangle_unit::process(const triangle_request& request, triangle_result& result) {
  const triangle_outcome o = intersector_(request.position, request.direction, request.triangle);
  result = {o.u, o.v, o.t, request.enable, o.hit};
  if (!request.enable) return;
  ++stats_.pairs;
  stats_.hits += o.hit;
  stats_.errors += o.err;
  stats_.wrapped += o.wrapped;
}

void triangle_unit::trace(waveform& w) const {
  pipeline_unit::trace(w);
  w.add(stats_.pairs, std::string(name()) + ".pairs");
  w.add(stats_.hits, std::string(name()) + ".hits");
}

triangle_unit::stats& triangle_unit::stats::operator+=(const stats& s) {
  pairs += s.pairs;
  hits += s.hits;
  errors += s.errors;
  wrapped += s.wrapped;
  return *this;
}

void triangle_unit::stats::describe(config::report& r) const {
  r.number("pairs", pairs, "pairs", "rays and triangles intersected, enabled ones");
  r.number("hits", hits, "pairs", "of these, hits");
  r.number("errors", errors, "pairs", "plane behind the ray, or 2^(n+1) grid units away or more");
  r.number("wrapped", wrapped, "pairs", "numerator or denominator wider than its register as built");
}

void trace_fields(waveform& w, const std::string& name, const triangle_request& request) {
  const char* const axes[] = {"x", "y", "z"};
  for (unsigned i = 0; i < 3; ++i) {
    w.add(request.position[i], name + ".position_" + axes[i]);
    w.add(request.direction[i], name + ".direction_" + axes[i]);
  }
  const accelerated_triangle& a = request.triangle;
  const std::pair<const char*, const std::int64_t*> words[] = {{"pp", &a.pp},   {"pq", &a.pq},   {"d", &a.d},
                                                               {"e1p", &a.e1p}, {"e1q", &a.e1q}, {"e2p", &a.e2p},
                                                               {"e2q", &a.e2q}, {"np", &a.np},   {"nq", &a.nq}};
  for (const auto& [field, word] : words) w.add(*word, name + '.' + field);
  w.add(a.r, name + ".r", 2);
  w.add(request.enable, name + ".en");
}

void trace_fields(waveform& w, const std::string& name, const triangle_result& result) {
  w.add(result.u, name + ".u");
  w.add(result.v, name + ".v");
  w.add(result.t, name + ".t");
  w.add(result.rdy, name + ".rdy");
  w.add(result.hit, name + ".hit");
}

}  // namespace rtusim
