#include "modules/svo_core/svo_ahead.h"

#include <algorithm>

#include "modules/config/error.h"
#include "modules/job_manager/job_manager.h"

namespace rtusim {

void svo_ahead::walk_more() {
  RTU_CHECK(end_, <, jobs_.size());
  begin_ = end_;
  before_ = counted_;
  const std::size_t count = std::min(walked_.size(), jobs_.size() - begin_);
  batch_(jobs_.data() + begin_, count, walked_.data(), counted_);
  end_ += count;
}

traversal_job svo_ahead::job(std::uint32_t sequence) const {
  traversal_job job;
  numeric::float_to_fixed_stats not_counted;
  convert(jobs_[sequence], converter_, not_counted, job);
  job.sequence = sequence;
  return job;
}

numeric::float_to_fixed_stats svo_ahead::conversions(std::uint64_t jobs) const {
  // Those in the job manager's pipeline are not walked yet, and of the last batch not all are there.
  numeric::float_to_fixed_stats counted = jobs < end_ ? before_ : counted_;
  traversal_job converted;
  for (std::size_t i = jobs < end_ ? begin_ : end_; i < jobs; ++i) convert(jobs_[i], converter_, counted, converted);
  return counted;
}

}  // namespace rtusim
