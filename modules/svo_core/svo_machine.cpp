#include "modules/svo_core/svo_machine.h"

#include <algorithm>

#include "modules/config/error.h"
#include "modules/formats/svo_word.h"

namespace rtusim {
namespace {

/// Axis of the largest value; ties go to x, then y.
unsigned largest(const svo_machine::vector& v) { return v[0] >= v[1] && v[0] >= v[2] ? 0 : v[1] >= v[2] ? 1 : 2; }
/// Axis of the smallest value; ties go to x, then y.
unsigned smallest(const svo_machine::vector& v) { return v[0] <= v[1] && v[0] <= v[2] ? 0 : v[1] <= v[2] ? 1 : 2; }

}  // namespace

std::int64_t svo_machine::middle(std::int64_t a, std::int64_t b) const {
  return params_.tm_wrap ? numeric::wrapped_midpoint<std::int64_t, std::uint64_t>(a, b, params_.format.width()) : numeric::midpoint(a, b);
}

svo_machine::vector svo_machine::middles(const vector& t0, const vector& t1) const {
  return {middle(t0[0], t1[0]), middle(t0[1], t1[1]), middle(t0[2], t1[2])};
}

svo_machine::vector svo_machine::child_entry() const {
  vector v;
  for (unsigned i = 0; i < 3; ++i) v[i] = now_.top.child >> i & 1 ? now_.top.tm[i] : now_.top.t0[i];
  return v;
}

svo_machine::vector svo_machine::child_exit() const {
  vector v;
  for (unsigned i = 0; i < 3; ++i) v[i] = now_.top.child >> i & 1 ? now_.top.t1[i] : now_.top.tm[i];
  return v;
}

void svo_machine::inherit(std::uint8_t child, std::uint8_t stack_size, const svo_result_registers& result) {
  now_.state = svo_state::idle;
  now_.top.child = child;
  now_.stack_size = stack_size;
  now_.result = result;
}

void svo_machine::accept(const traversal_job& job) {
  RTU_CHECK(static_cast<int>(now_.state), ==, static_cast<int>(svo_state::idle));
  now_.state = svo_state::init;
  now_.cost = 0;
  now_.address = 0;
  now_.job_word = job.job_word;
  now_.top.entry = job.address;
  now_.top.t0 = job.t0;
  now_.top.t1 = job.t1;
  now_.top.tm = middles(job.t0, job.t1);
  const std::int64_t exit = job.t1[smallest(job.t1)];
  root_missed_ = job.t0[largest(job.t0)] >= exit || (!params_.negative_t && exit <= 0);
  far_pending_ = false;
  overflowed_ = false;
  visits_ = {};
}

void svo_machine::step() {
  if (now_.state == svo_state::idle) now_.cost = 0;
  if (now_.state == svo_state::idle || now_.state == svo_state::out) return;
  ++now_.cost;
  switch (now_.state) {
    case svo_state::init: {
      ++visits_.init;
      const unsigned m = largest(now_.top.t0);
      now_.top.child = 0;
      for (unsigned i = 0; i < 3; ++i)
        if (i != m && now_.top.t0[m] >= now_.top.tm[i]) now_.top.child |= static_cast<std::uint8_t>(1u << i);
      now_.address = now_.top.entry;
      now_.stack_size = visits_.init == 1 ? 0 : now_.stack_size;
      now_.state = svo_state::eval;
      break;
    }
    case svo_state::eval: ++visits_.eval, evaluate(); break;
    case svo_state::next: ++visits_.next, go_next(); break;
    case svo_state::push: ++visits_.push, push(); break;
    case svo_state::pop:
      ++visits_.pop;
      --now_.stack_size;
      now_.address = now_.top.entry;
      now_.state = svo_state::next;
      break;
    case svo_state::idle:
    case svo_state::out: break;
  }
}

void svo_machine::evaluate() {
  const std::uint32_t word = memory_data();
  const vector exit = child_exit();
  if (root_missed_) {
    finish(false, 0, no_axis);
  } else if ((valid_mask(word) >> slot() & 1) == 0 || (!params_.negative_t && exit[smallest(exit)] <= 0)) {
    now_.state = svo_state::next;
  } else if (leaf_mask(word) >> slot() & 1) {
    const vector entry = child_entry();
    const unsigned m = largest(entry);
    finish(true, entry[m], static_cast<std::int8_t>(m));
  } else {
    descriptor_ = word;
    far_pending_ = is_far(word);
    group_ = now_.top.entry + child_pointer(word);
    if (far_pending_) now_.address = group_;
    now_.state = svo_state::push;
  }
}

void svo_machine::go_next() {
  const unsigned m = smallest(child_exit());
  if ((now_.top.child >> m & 1) == 0) {
    now_.top.child |= static_cast<std::uint8_t>(1u << m);
    now_.state = svo_state::eval;
  } else if (now_.stack_size == 0) {
    finish(false, 0, no_axis);
  } else {
    now_.top = stack_[now_.stack_size - 1u];
    now_.state = svo_state::pop;
  }
}

void svo_machine::push() {
  if (now_.stack_size == params_.stack_depth) {
    overflowed_ = true;
    return;
  }
  stack_[now_.stack_size++] = now_.top;
  const std::uint32_t group = far_pending_ ? now_.top.entry + memory_data() : group_;
  const std::uint32_t counted = far_pending_ && params_.far_popcount ? memory_data() : descriptor_;
  const vector t0 = child_entry();
  const vector t1 = child_exit();
  now_.top = {group + child_nodes_before(counted, slot()), 0, t0, middles(t0, t1), t1};
  far_pending_ = false;
  now_.state = svo_state::init;
}

void svo_machine::finish(bool hit, std::int64_t t_hit, std::int8_t axis) {
  svo_outcome o;
  o.hit = hit;
  o.t_hit = params_.negative_t ? t_hit : std::max<std::int64_t>(t_hit, 0);
  o.axis = axis;
  now_.hit = hit;
  now_.result.take(o, now_.job_word >> job_id_bits & 7, params_);
  now_.state = svo_state::out;
}

void svo_machine::release() {
  RTU_CHECK(static_cast<int>(now_.state), ==, static_cast<int>(svo_state::out));
  now_.state = svo_state::idle;
}

void svo_core_params::describe(config::section& s) {
  s.number("stack_depth", stack_depth, {1, most_stack_frames}, "frames",
           "frames of the stack: one level of the octree below the first each");
  s.erratum("far_popcount", far_popcount, "behind a far pointer the child is counted in the far word's bits", "in the descriptor's");
  s.erratum("negative_t", negative_t, "cubes behind the ray's origin are hit",
            "only cubes whose exit lies ahead; inside a solid t_hit is 0");
  s.erratum("positive_normals", positive_normals, "normals are +1 on their axis", "the sign faces the ray");
  s.erratum("tm_wrap", tm_wrap, "t0 + t1 wraps at the word's width", "a sum one bit wider");
  s.erratum("stale_miss", stale_miss, "on a miss t_hit and normal carry the core's last hit", "0 and none");
}

svo_visits& svo_visits::operator+=(const svo_visits& v) {
  init += v.init;
  eval += v.eval;
  next += v.next;
  push += v.push;
  pop += v.pop;
  return *this;
}

svo_visits visits_of(const svo_outcome& o) { return visits_of_sums(1, o.cost, o.pushes, o.depth, !o.hit && o.cost > 2 ? 1 : 0); }

svo_visits visits_of_sums(std::uint64_t rays, std::uint64_t cost, std::uint64_t pushes, std::uint64_t depth, std::uint64_t ends) {
  // Every PUSH leads to an INIT, every INIT to an EVAL; a NEXT leads to an EVAL, to a POP (which leads to a NEXT), or to the end.
  svo_visits v;
  v.push = pushes;
  v.pop = pushes - depth;
  v.init = pushes + rays;
  const std::uint64_t left = cost - v.push - v.pop - v.init;  // EVAL and NEXT
  const std::uint64_t advances = (left - v.init - v.pop - ends) / 2;
  v.eval = v.init + advances;
  v.next = left - v.eval;
  return v;
}

simulation_error svo_stack_overflow(const std::string& core, unsigned stack_depth, std::uint32_t sequence, std::uint32_t job_word,
                                    std::uint64_t cycle) {
  return simulation_error(
      fmt::format("{}: the stack of {} frames overflows on job {} (word {:#x}), accepted in cycle {}: "
                  "set svo_core.stack_depth to the model's depth",
                  core, stack_depth, sequence, job_word, cycle));
}

void svo_result_registers::take(const svo_outcome& o, unsigned direction_bits, const svo_core_params& p) {
  if (o.hit) {
    t_hit = o.t_hit;
    axis = o.axis;
    const bool mirrored = direction_bits >> o.axis & 1;
    sign = static_cast<std::int8_t>(p.positive_normals || mirrored ? 1 : -1);
  } else if (!p.stale_miss) {
    *this = {};
  }
}

}  // namespace rtusim
