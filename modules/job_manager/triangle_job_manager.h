#pragma once

#include <memory>
#include <string>
#include <vector>

#include "modules/config/report.h"
#include "modules/formats/triangle_job.h"
#include "modules/job_manager/ray_setup.h"
#include "modules/timing/pipeline_unit.h"

namespace rtusim {

/// Takes the host's rays for triangle cores, makes them ready (see `ray_setup`), and offers them to the scheduler.
///
/// Timing: one parameter register, the float-to-fixed converter's stages, the dividers', side by side, and 2 for the entry point's
/// product and sum, all moving together (see `pipeline_unit`).
class triangle_job_manager final : public pipeline_unit<job_packet, triangle_job> {
 public:
  struct params {
    quantisation words;               ///< of the section `quantisation`
    per_axis<std::int64_t> corner{};  ///< upper corner of the scene's box, in grid units
  };
  struct stats {
    std::uint64_t jobs = 0;
    ray_setup_stats setup;

    stats& operator+=(const stats& other);
    void describe(config::report& r) const;
    void warn(std::vector<std::string>& all) const { setup.conversion.warn(all); }
  };

  triangle_job_manager(const sc_core::sc_module_name& name, const params& p);

  /// Stages that these widths come to.
  static unsigned stages_of(const params& p) {
    return 1 + numeric::float_to_fixed_stages + ray_setup(p.words, p.corner).divider_width() + 2;
  }

  const stats& statistics() const { return stats_; }
  std::unique_ptr<unit_figures> figures() override { return as_figures(stats_); }

 private:
  void process(const job_packet& packet, triangle_job& job) override;
  void trace(waveform& w) const override;

  ray_setup setup_;
  stats stats_;
};

}  // namespace rtusim
