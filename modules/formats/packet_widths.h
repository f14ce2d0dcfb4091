#pragma once

namespace rtusim {

/// How a waveform shows the packets' words: their bits, 0 for those that a kind of core does not have.
struct packet_widths {
  unsigned t = 32;  ///< t of jobs and results
  unsigned uv = 0;  ///< u and v of results
  unsigned position = 0;
  unsigned direction = 0;
  unsigned reciprocal = 0;
  const char* sent_first = "t0";  ///< what the two triples of words are that the host sends
  const char* sent_second = "t1";
  bool address = true;  ///< whether jobs have one
};

}  // namespace rtusim
