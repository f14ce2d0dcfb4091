#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "modules/config/report.h"
#include "modules/config/section.h"
#include "modules/numeric/divide.h"
#include "modules/timing/pipeline_unit.h"

namespace rtusim {

/// Operands of a division, sign-extended.
struct division {
  std::int64_t n = 0;
  std::int64_t d = 0;
};

/// What a division gives: the raw word, whose top bit is `err`.
struct quotient {
  std::uint64_t word = 0;
  bool err = false;
};

/// The divider alone (Hanika 2007, sec. 3.2 and A.1): see `numeric::divider`.
///
/// Timing: a quotient is offered from `width` edges after its operands were accepted on. Pipelined: one division a cycle. Iterative: one
/// stage goes round, so there is one division in `width` cycles.
class t_div final : public pipeline_unit<division, quotient> {
 public:
  struct params {
    unsigned width = 33;
    numeric::divider_kind kind = numeric::divider_kind::pipelined;

    void describe(config::section& s);
  };
  struct stats {
    std::uint64_t divisions = 0;
    std::uint64_t errors = 0;

    void describe(config::report& r) const;
  };

  t_div(const sc_core::sc_module_name& name, const params& p);

  const stats& statistics() const { return stats_; }
  std::unique_ptr<unit_figures> figures() override { return as_figures(stats_); }

 private:
  void process(const division& operands, quotient& result) override;
  void trace(waveform& w) const override;

  numeric::divider divider_;
  stats stats_;
};

void trace_fields(waveform& w, const std::string& name, const division& operands);
void trace_fields(waveform& w, const std::string& name, const quotient& result);

}  // namespace rtusim
