#include "testbench/run/waveform_size.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/files.h"

namespace rtusim {
namespace {

constexpr std::uint64_t most_bytes = 500'000'000;
constexpr std::size_t most_sampled = 4096;

// Measured: bytes for a cycle that a core works, and for one that it waits.
constexpr double bytes_a_worked_cycle = 150;
constexpr double bytes_a_cycle = 40;

}  // namespace

std::uint64_t estimated_bytes(const waveform_window& window, const run_setup& s, const loaded_model& model,
                              const std::vector<job_packet>& jobs) {
  const double cores = s.hardware.rtu.cores;
  const double window_cycles = static_cast<double>(window.to - window.from);
  if (window.job_id || jobs.empty() || window_cycles * (cores * bytes_a_worked_cycle + bytes_a_cycle) < static_cast<double>(most_bytes))
    return 0;
  const std::size_t stride = (jobs.size() + most_sampled - 1) / most_sampled;
  std::vector<job_packet> sample;
  for (std::size_t i = 0; i < jobs.size(); i += stride) sample.push_back(jobs[i]);
  const auto all_jobs = static_cast<double>(jobs.size());
  const double worked = static_cast<double>(model.walk_cycles(s.hardware, sample)) * all_jobs / static_cast<double>(sample.size());
  const double cycles = std::max(worked / cores, all_jobs);
  return static_cast<std::uint64_t>((worked * bytes_a_worked_cycle + cycles * bytes_a_cycle) * std::min(1.0, window_cycles / cycles));
}

void check_size(const waveform_window& window, const run_setup& s, const loaded_model& model, const std::vector<job_packet>& jobs) {
  std::error_code ignored;
  const auto status = std::filesystem::status(window.file, ignored);
  const bool is_stream = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
  if (is_stream || config::descriptor_named(window.file)) return;
  const std::uint64_t bytes = estimated_bytes(window, s, model, jobs);
  if (bytes > most_bytes)
    throw input_error(window.file.string(), fmt::format("a waveform of about {:.1f} GB", static_cast<double>(bytes) / 1e9),
                      "a window (--vcd-from and --vcd-to, or --vcd-job), or --vcd-all");
}

}  // namespace rtusim
