#include "modules/job_manager/job_manager.h"

#include <catch2/catch.hpp>

#include <vector>

#include "modules/config/csv.h"
#include "modules/timing/clock_domain.h"
#include "testbench/bench/stream.h"

namespace rtusim {

TEST_CASE("job_manager: 4,000 clocks with a random source and a random sink, signal for signal", "[job_manager]") {
  const std::string golden = RTUSIM_SOURCE_DIR "/testbench/golden/svo/";
  const csv_table jobs(golden + "job_manager_jobs.csv.gz");
  const csv_table trace(golden + "job_manager_trace.csv.gz");
  constexpr std::int64_t any_word = 0xffffffff;
  std::vector<job_packet> packets(jobs.rows());
  for (std::size_t row = 0; row < jobs.rows(); ++row) {
    const auto word = [&](const char* name) { return static_cast<std::uint32_t>(jobs.number(row, jobs.column(name), 0, any_word)); };
    packets[row].job_word = word("job_id");
    packets[row].t0[0] = word("t0x_bits");
    packets[row].t1[2] = word("t1z_bits");
  }

  clock_domain clock("clock_domain", 100);
  source_params source_p;
  source_p.valid = source_params::regime::lfsr;
  sink_params sink_p;
  sink_p.ready = sink_params::regime::lfsr;
  stream_source<job_packet> source("source", source_p, packets);
  job_manager manager("job_manager", {{}, {true, true, true}});
  stream_sink<traversal_job> sink("sink", sink_p, packets.size());
  channel<job_packet> in("in");
  channel<traversal_job> out("out");
  source.out(in);
  manager.in(in);
  manager.out(out);
  sink.in(out);
  clock.set_pace(pace::checked);

  std::size_t compared = 0;
  clock.set_watcher([&](cycle c) {
    if (c >= trace.rows()) {
      clock.stop();
      return;
    }
    const auto expect = [&](const char* name, std::int64_t value) {
      CAPTURE(c, name);
      REQUIRE(trace.number(c, trace.column(name), -any_word, any_word) == value);
    };
    const bool valid = out.valid_level(c);
    const traversal_job nothing{};
    const traversal_job& job = valid ? out.offered(c) : nothing;
    expect("cycle", static_cast<std::int64_t>(c));
    expect("in_valid", in.valid_level(c));
    expect("in_ready", in.ready_level());
    if (source.sent() < packets.size()) expect("in_job_id", packets[source.sent()].job_word);
    expect("out_ready", out.ready_level());
    expect("out_valid", valid);
    expect("out_job_id", job.job_word);
    expect("out_a", job.direction_bits());
    expect("out_t0x", job.t0[0]);
    expect("out_t1z", job.t1[2]);
    ++compared;
  });
  clock.start();
  CHECK(compared == 4'000);
}

}  // namespace rtusim
