#pragma once

#include <vector>

#include "modules/timing/channel.h"
#include "modules/timing/clock_domain.h"
#include "testbench/bench/stream.h"

namespace rtusim {

/// Notes in which cycle each transfer came, and what.
template <class T>
struct recorder {
  std::vector<cycle> cycles;
  std::vector<T> payloads;
  void transferred(unsigned, cycle c, const T& payload) {
    cycles.push_back(c);
    payloads.push_back(payload);
  }
};

/// A unit between a source and a sink, both without waits.
template <class In, class Out>
struct bench {
  clock_domain clock{"clock_domain", 100};
  stream_source<In> source;
  stream_sink<Out> sink;
  channel<In> in{"in"};
  channel<Out> out{"out"};
  recorder<In> entered;
  recorder<Out> left;

  explicit bench(const std::vector<In>& items) : source("source", {}, items), sink("sink", {}, items.size()) {
    source.out(in);
    sink.in(out);
    in.observe(entered, 0);
    out.observe(left, 0);
  }
};

}  // namespace rtusim
