#pragma once

#include <array>
#include <cstdint>

#include "modules/formats/packets.h"
#include "modules/formats/word_view.h"
#include "modules/svo_core/svo_params.h"

namespace rtusim {

/// The traversal state machine, cycle by cycle and register by register (Espe 2019, sec. 4.1, 7.2.4 and app. C.4).
///
/// A plain class without SystemC: each `step` is one clock edge in which no port fires; `accept` is the edge at which IDLE
/// takes a job, `release` the edge at which OUT gives its result away. `svo_walk` comes to the same outcome at once.
class svo_machine {
 public:
  using vector = per_axis<std::int64_t>;

  struct frame {
    std::uint32_t entry = 0;
    std::uint8_t child = 0;
    vector t0{}, tm{}, t1{};
  };
  /// All values as they are just before the coming edge.
  struct registers {
    svo_state state = svo_state::idle;
    std::uint8_t stack_size = 0;
    std::uint32_t cost = 0;
    std::uint32_t address = 0;
    std::uint32_t job_word = 0;
    frame top;
    svo_result_registers result;
    bool hit = false;
  };

  svo_machine(const svo_core_params& p, word_view memory) : params_(p), memory_(memory) {}

  void accept(const traversal_job& job);
  void step();
  void release();

  const registers& now() const { return now_; }
  std::uint32_t memory_data() const { return memory_[now_.address]; }
  const svo_visits& visits() const { return visits_; }
  /// PUSH found the stack full.
  bool overflowed() const { return overflowed_; }
  /// What `child`, the stack and the result carry over from the job before, for a machine that did not step through it.
  void inherit(std::uint8_t child, std::uint8_t stack_size, const svo_result_registers& result);

 private:
  std::int64_t middle(std::int64_t a, std::int64_t b) const;
  vector middles(const vector& t0, const vector& t1) const;
  vector child_entry() const;
  vector child_exit() const;
  unsigned slot() const { return now_.top.child ^ (now_.job_word >> job_id_bits & 7); }
  void evaluate();
  void go_next();
  void push();
  void finish(bool hit, std::int64_t t_hit, std::int8_t axis);

  svo_core_params params_;
  word_view memory_;
  registers now_;
  bool root_missed_ = false;
  std::uint32_t group_ = 0;  // register of the child group's address, far: of the far word
  bool far_pending_ = false;
  std::uint32_t descriptor_ = 0;  // kept where the popcount is right behind a far word
  bool overflowed_ = false;
  std::array<frame, most_stack_frames> stack_{};
  svo_visits visits_;
};

}  // namespace rtusim
