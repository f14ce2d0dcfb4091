#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/timing/clock_domain.h"
#include "testbench/bench/stream.h"
#include "testbench/tests/in_child.h"

namespace rtusim::test {

/// How the ends of a pipeline behave, and how its clock goes.
struct pipeline_run {
  source_params::regime source = source_params::regime::always;
  sink_params::regime sink = sink_params::regime::always;
  pace how = pace::skipping;
  std::uint32_t shuffle = 0;
};

/// All stalls of source and sink, each in all paces.
inline std::vector<std::vector<pipeline_run>> stalled_runs(std::uint32_t shuffle) {
  std::vector<std::vector<pipeline_run>> runs;
  for (const auto source : {source_params::regime::always, source_params::regime::gap, source_params::regime::lfsr})
    for (const auto sink : {sink_params::regime::always, sink_params::regime::lfsr})
      runs.push_back(
          {{source, sink, pace::checked, shuffle}, {source, sink, pace::skipping, 0}, {source, sink, pace::stepped, shuffle + 1}});
  return runs;
}

/// A line `CYCLE NAME PAYLOAD` for each transfer into and out of a unit; PAYLOAD is empty on the way in.
template <class Unit, class In, class Out, class Params, class Text>
std::string pipeline_log(const Params& params, const std::vector<In>& items, const pipeline_run& run, Text text) {
  struct in_observer {
    std::string* log = nullptr;
    void transferred(unsigned, cycle c, const In&) { *log += fmt::format("{} in \n", c); }
  };
  struct out_observer {
    std::string* log = nullptr;
    Text* text = nullptr;
    void transferred(unsigned, cycle c, const Out& payload) { *log += fmt::format("{} out {}\n", c, (*text)(payload)); }
  };
  return in_child([&] {
    clock_domain clock("clock_domain", 100);
    source_params source_p;
    source_p.valid = run.source;
    sink_params sink_p;
    sink_p.ready = run.sink;
    stream_source<In> source("source", source_p, items);
    stream_sink<Out> sink("sink", sink_p, items.size());
    Unit unit("unit", params);
    channel<In> in("in");
    channel<Out> out("out");
    source.out(in);
    unit.in(in);
    unit.out(out);
    sink.in(out);
    std::string log[2];
    in_observer entered;
    out_observer left;
    entered.log = &log[0];
    left.log = &log[1];
    left.text = &text;
    in.observe(entered, 0);
    out.observe(left, 0);
    clock.set_pace(run.how);
    clock.shuffle_units(run.shuffle);
    clock.start();
    return log[0] + log[1];
  });
}

/// The payloads of such a log, a line each.
inline std::string payloads(const std::string& log) {
  std::string all;
  const std::string mark = " out ";
  for (std::size_t begin = 0; begin < log.size();) {
    const std::size_t end = log.find('\n', begin);
    const std::string line = log.substr(begin, end - begin);
    if (const auto at = line.find(mark); at != std::string::npos) all += line.substr(at + mark.size()) + '\n';
    if (end == std::string::npos) break;
    begin = end + 1;
  }
  return all;
}

}  // namespace rtusim::test
