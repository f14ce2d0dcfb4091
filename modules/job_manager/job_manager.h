#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "modules/config/report.h"
#include "modules/formats/packets.h"
#include "modules/numeric/float_to_fixed.h"
#include "modules/timing/pipeline_unit.h"

namespace rtusim {

/// Takes the host's jobs, converts their traversal parameters to fixed point, and offers them to the scheduler (Espe 2019, sec.
/// 6.2.1 and app. C.2).
///
/// Timing: one parameter register and the converter's stages, which move together (see `pipeline_unit`): a job accepted at edge e
/// is offered from edge e + 6 on.
class job_manager final : public pipeline_unit<job_packet, traversal_job> {
 public:
  /// A parameter register and the converter's stages.
  static constexpr unsigned latency_cycles = 1 + numeric::float_to_fixed_stages;

  struct params {
    numeric::fixed_format format;               ///< of the section `fixed_point`
    numeric::float_to_fixed_errata conversion;  ///< of the section `float_to_fixed`
  };
  struct stats {
    std::uint64_t jobs = 0;
    numeric::float_to_fixed_stats conversion;

    stats& operator+=(const stats& other);
    void describe(config::report& r) const;
    void warn(std::vector<std::string>& all) const { conversion.warn(all); }
  };

  job_manager(const sc_core::sc_module_name& name, const params& p);

  /// Somebody else has converted the jobs, and tells what that counts of the first so many. Then only their other words pass through here.
  using counter = std::function<numeric::float_to_fixed_stats(std::uint64_t jobs)>;
  void leave_conversion_to(counter counted) { elsewhere_ = std::move(counted); }

  stats statistics() const;
  std::unique_ptr<unit_figures> figures() override { return as_figures(statistics()); }

 private:
  void process(const job_packet& packet, traversal_job& job) override;
  void trace(waveform& w) const override;

  numeric::float_to_fixed_converter converter_;
  counter elsewhere_;
  stats stats_;
};

/// What a job becomes in the job manager; its `sequence` is left 0.
inline void convert(const job_packet& packet, const numeric::float_to_fixed_converter& converter, numeric::float_to_fixed_stats& stats,
                    traversal_job& job) {
  job.job_word = packet.job_word;
  job.address = packet.address;
  for (unsigned i = 0; i < 3; ++i) {
    job.t0[i] = converter(packet.t0[i], stats);
    job.t1[i] = converter(packet.t1[i], stats);
  }
  stats.conversions += 6;
}

}  // namespace rtusim
