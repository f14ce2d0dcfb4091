#pragma once

#include <cstdint>
#include <memory>

#include "modules/numeric/float_to_fixed.h"
#include "modules/timing/pipeline_unit.h"

namespace rtusim {

/// The float-to-fixed converter alone (Espe 2019, app. C.2.1): binary32 words in, fixed-point words out.
///
/// Timing: 5 stages that move together (see `pipeline_unit`), one word a cycle. The job manager has six of them after its parameter
/// register, so it does their work as part of its own pipeline.
class float_to_fixed : public pipeline_unit<std::uint32_t, std::int64_t> {
 public:
  struct params {
    numeric::fixed_format format;
    numeric::float_to_fixed_errata conversion;
  };

  float_to_fixed(const sc_core::sc_module_name& name, const params& p)
      : pipeline_unit(name, numeric::float_to_fixed_stages), converter_(p.format, p.conversion) {}

  const numeric::float_to_fixed_stats& statistics() const { return stats_; }
  std::unique_ptr<unit_figures> figures() override { return as_figures(stats_); }

 private:
  void process(const std::uint32_t& float_bits, std::int64_t& fixed) override {
    ++stats_.conversions;
    fixed = converter_(float_bits, stats_);
  }

  numeric::float_to_fixed_converter converter_;
  numeric::float_to_fixed_stats stats_;
};

}  // namespace rtusim
