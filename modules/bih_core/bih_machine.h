#pragma once

#include <cstdint>
#include <deque>
#include <utility>

#include "modules/bih_core/bih_params.h"
#include "modules/formats/bih_memory.h"

namespace rtusim {

/// The traversal state machine, cycle by cycle and register by register (Hanika 2007, sec. 3.4, table 3.1 and app. A).
///
/// A plain class without SystemC: between two calls of `step` lies one cycle, in which `now` are the registers and `signals` what the
/// machine drives. `start` puts a ray to the inputs, in AABB; its last cycle is the one with `done`, the next is again AABB. Without a ray
/// AABB waits. `bih_walk` comes to the same outcome at once.
///
/// A memory registers its address, and shows what is written in the same cycle. The stack's words are the core's own, the others the
/// memory's, which must outlive the machine.
///
/// A leaf of 0 triangles, where it does not hang, takes one cycle in LEAF without a triangle: as built the count is a register by then,
/// and compared there.
///
/// `early_out`, not in the original: a child in INNER or a stack entry in POP is dropped if its tmin lies beyond the nearest hit of
/// which the result is there in that cycle; POP then goes on to the next entry, and the ray ends when none is left. Distances of hits
/// are in grid units along the ray, as tmin is.
class bih_machine {
 public:
  /// All values as they are just before the coming edge.
  struct registers {
    bih_state state = bih_state::aabb;
    std::uint8_t stack_pos = 0;  // 5 bits
    std::int64_t tmin = 0, tmax = 0, dist0 = 0, dist1 = 0;
    std::uint32_t address3x = 0, address1x = 0;  // of the memories: what the signals were a cycle ago
    std::uint32_t near_child = 0;
    std::uint32_t next_triangle = 0;  // list address
    std::uint32_t triangles_left = 0;
  };
  struct outputs {
    bool done = false;
    bool tri_en = false;
    bool we = false;
    std::uint32_t tri_num = 0;
    std::uint32_t addr3x = 0, addr1x = 0;  // where nothing sets addr1x it is kept; as built a latch leaves other values
  };

  bih_machine(const bih_core_params& p, const bih_memory& memory);

  void start(const quantised_ray& ray);
  void step();
  /// What became of the triangle that is issued in this cycle, known to `early_out` so many cycles later as its result takes.
  /// `distance`: of the hit in grid units along the ray, or no_hit.
  void result(std::int64_t distance);

  const registers& now() const { return now_; }
  const outputs& signals() const { return out_; }
  /// The words on the memories' outputs.
  bih_words words() const;
  /// A ray is under way.
  bool busy() const { return busy_; }
  const bih_outcome& outcome() const { return outcome_; }
  /// What the rays before leave behind, for a machine that did not step through them; between rays.
  void inherit(const bih_kept& kept);
  /// The same where no ray reads words of the stack that it did not write: no node lies there, and no push empties the stack.
  void inherit(const bih_kept_registers& kept);
  bih_kept kept() const;

 private:
  std::uint64_t word(unsigned which, std::uint32_t address) const;
  std::int64_t distance_to(std::uint64_t plane, unsigned axis) const;
  std::uint32_t stack_entry(unsigned stack_pos) const;
  void settle();
  void settle_aabb();
  void settle_node();
  void settle_inner();
  void settle_pop();
  void settle_leaf();
  void go_back();

  bih_core_params params_;
  const bih_memory* memory_;
  std::array<bih_words, bih_stack_words> stack_;
  quantised_ray ray_;
  bool busy_ = false;
  registers now_, next_;
  outputs out_;
  std::uint64_t divider_clocks_ = 0;  // for which the divider is not yet free
  bih_words pushed_{};
  bih_outcome outcome_;
  // For early_out.
  std::uint64_t clock_ = 0;
  std::deque<std::pair<std::uint64_t, std::int64_t>> results_;  // from which cycle on each is known
  std::int64_t nearest_ = no_hit;
};

}  // namespace rtusim
