#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "modules/config/report.h"
#include "modules/config/section.h"
#include "modules/formats/packets.h"
#include "modules/formats/quantisation.h"
#include "modules/numeric/divide.h"
#include "modules/timing/pipeline_unit.h"
#include "modules/triangle_unit/triangle_intersector.h"

namespace rtusim {

struct triangle_unit_params {
  triangle_errata errata;
  quantisation words;                                                ///< of the section `quantisation`
  numeric::divider_kind divider = numeric::divider_kind::pipelined;  ///< `t_div.kind`

  void describe(config::section& s) { errata.describe(s); }
};

/// A ray and a triangle it may hit.
struct triangle_request {
  per_axis<std::int64_t> position{};   ///< n+1 bits unsigned
  per_axis<std::int64_t> direction{};  ///< m bits
  accelerated_triangle triangle;
  bool enable = false;  ///< what `rdy` will be
};

/// What the intersector found, whether it was enabled or not; u, v and t as in `triangle_outcome`.
struct triangle_result {
  std::uint64_t u = 0;
  std::uint64_t v = 0;
  std::uint64_t t = 0;
  bool rdy = false;
  bool hit = false;
};

/// The intersection of rays with triangles (Hanika 2007, sec. 3.3): see `triangle_intersector`.
///
/// Timing: 4 stages before the divider (select; products; sums; numerator and denominator), the divider's, one a bit, and 4 after it (t
/// dir; k; products; u and v): n + 11 as built with m = n + 2, 2 more where the denominator does not wrap, as the divider is then 2 bits
/// wider. What is accepted at edge e is offered from edge e + stages on. All stages move together; a triangle that is missed
/// early takes as long. With an iterative divider one pair is accepted in as many cycles as it has bits.
class triangle_unit final : public pipeline_unit<triangle_request, triangle_result> {
 public:
  using params = triangle_unit_params;
  struct stats {
    std::uint64_t pairs = 0;
    std::uint64_t hits = 0;
    std::uint64_t errors = 0;
    std::uint64_t wrapped = 0;

    stats& operator+=(const stats& s);
    void describe(config::report& r) const;
  };

  /// Errors: those of `triangle_intersector`.
  triangle_unit(const sc_core::sc_module_name& name, const params& p);

  /// Stages that these parameters come to.
  static unsigned stages_of(const params& p) { return stages_around_divider + triangle_intersector(p.words, p.errata).divider_width(); }

  const stats& statistics() const { return stats_; }
  std::unique_ptr<unit_figures> figures() override { return as_figures(stats_); }

 private:
  static constexpr unsigned stages_around_divider = 8;

  void process(const triangle_request& request, triangle_result& result) override;
  void trace(waveform& w) const override;

  triangle_intersector intersector_;
  stats stats_;
};

void trace_fields(waveform& w, const std::string& name, const triangle_request& request);
void trace_fields(waveform& w, const std::string& name, const triangle_result& result);

}  // namespace rtusim
