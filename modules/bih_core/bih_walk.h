#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "modules/bih_core/bih_params.h"
#include "modules/formats/bih_memory.h"
#include "modules/numeric/fixed_point.h"
#include "modules/numeric/plane_distance.h"

namespace rtusim {

/// A hierarchy's words, taken apart for walks in words of these widths. All walks of a run share it.
struct bih_tables {
  bih_tables(const quantisation& widths, const bih_memory& memory);

  struct alignas(32) node {
    std::int64_t clip[2];  // narrow: shifted up, so that their difference wraps by itself
    std::uint32_t pointer;
    std::uint32_t sibling;  // left ^ right
    std::uint32_t axis;
    std::uint32_t triangles;
  };

  unsigned address_bits;
  per_axis<std::int64_t> corner;  ///< upper corner of the scene's box
  bool narrow;                    ///< differences and reciprocals fit 64 bits, shifted up
  unsigned plane_shift;           ///< narrow: of planes and positions
  unsigned reciprocal_shift;
  std::vector<node> nodes;
  std::vector<std::uint32_t> lists;                      ///< below the stack
  std::array<bih_stack_entry, bih_stack_words> stack{};  ///< what lies at its addresses before the first ray
};

/// Walks one ray after the other to its end at once: what `bih_machine` reaches cycle by cycle, and when it issues each triangle.
///
/// The words must have passed `check_bih` (`raw` at least, with the core's `empty_leaf_hangs`). Copies share them.
class bih_walk {
 public:
  /// `tables`: of the core's widths.
  bih_walk(const bih_core_params& p, std::shared_ptr<const bih_tables> tables);
  bih_walk(const bih_core_params& p, const bih_memory& memory) : bih_walk(p, std::make_shared<bih_tables>(p.widths, memory)) {}

  /// `visit(triangle, clock)` is called for each triangle number with the cycle in which it is issued; the ray's AABB is cycle 0. It may
  /// return the distance of the hit as a std::int64_t, or no_hit, for `early_out` to know when the result is there.
  ///
  /// A visitor with a member `takes_leaves` has `leaf(first, numbers, count, hit)`, and gets the triangles of a leaf at once where one is
  /// issued a cycle: from list address `first` on. It tells of hits alone, in their order: `hit(i, distance)`.
  template <class Visit>
  bih_outcome operator()(const quantised_ray& ray, Visit&& visit) {
    if constexpr (std::is_same_v<std::invoke_result_t<Visit&, std::uint32_t, std::uint64_t>, std::int64_t>) {
      if (params_.early_out) return tables_->narrow ? walk<true, true>(ray, visit) : walk<false, true>(ray, visit);
    }
    return tables_->narrow ? walk<true, false>(ray, visit) : walk<false, false>(ray, visit);
  }

  /// `n` cycles pass without a ray.
  void rest(std::uint64_t n) {
    if (n != 0) address3x_ = address1x_ = 0;
    divider_clocks_ -= std::min(divider_clocks_, n);
  }

  /// What the rays so far leave behind, for `bih_machine::inherit`.
  bih_kept kept() const;
  bih_kept_registers registers() const { return {tmin_, tmax_, dist0_, dist1_, address3x_, address1x_, divider_clocks_}; }
  void inherit(const bih_kept& kept);

 private:
  using node = bih_tables::node;
  template <class Visit, class = void>
  struct visits_leaves : std::false_type {};
  template <class Visit>
  struct visits_leaves<Visit, std::void_t<decltype(&std::remove_reference_t<Visit>::takes_leaves)>> : std::true_type {};

  template <bool Narrow, bool EarlyOut, class Visit>
  bih_outcome walk(const quantised_ray& ray, Visit& visit);
  std::uint32_t list_word(std::uint32_t address) const;
  void expect(std::uint64_t clock, std::int64_t distance);

  bih_core_params params_;
  std::shared_ptr<const bih_tables> tables_;
  std::uint32_t address_mask_;
  // Kept from ray to ray.
  std::int64_t tmin_ = 0, tmax_ = 0, dist0_ = 0, dist1_ = 0;
  std::uint32_t address3x_ = 0, address1x_ = 0;
  std::uint64_t divider_clocks_ = 0;
  std::array<bih_stack_entry, bih_stack_words> stack_;
  // Results on their way, for early_out; those that are no nearer than one before are left out.
  struct result {
    std::uint64_t known;
    std::int64_t distance;
  };
  std::vector<result> results_;
};

template <bool Narrow, bool EarlyOut, class Visit>
bih_outcome bih_walk::walk(const quantised_ray& ray, Visit& visit) {
  const unsigned n = params_.widths.n;
  const unsigned plane_shift = tables_->plane_shift;
  std::int64_t position[3], reciprocal[3];
  std::uint32_t down[3];
  for (unsigned i = 0; i < 3; ++i) {
    const std::uint64_t grid = (std::uint64_t{1} << n) - 1;
    position[i] = static_cast<std::int64_t>((static_cast<std::uint64_t>(ray.position[i]) & grid) << plane_shift);
    reciprocal[i] = static_cast<std::int64_t>(static_cast<std::uint64_t>(ray.reciprocal[i]) << tables_->reciprocal_shift);
    down[i] = ray.reciprocal[i] < 0;
  }
  const auto distance = [&](std::int64_t difference, unsigned axis) {
    if constexpr (Narrow) {
      __extension__ using wide = __int128;
      return static_cast<std::int64_t>(static_cast<wide>(difference) * reciprocal[axis] >> 64);
    } else {
      return numeric::plane_distance(difference, reciprocal[axis], params_.widths.reciprocal_bits);
    }
  };
  const auto distance_to = [&](std::int64_t plane, unsigned axis) {
    const auto difference = static_cast<std::int64_t>(static_cast<std::uint64_t>(plane) - static_cast<std::uint64_t>(position[axis]));
    return distance(Narrow ? difference : numeric::wrap(difference, n + 1), axis);
  };

  bih_outcome o;
  o.visits.aabb = 1;
  const bih_interval inside = box_interval(ray, tables_->corner, params_, [&](std::int64_t difference, unsigned axis) {
    return distance(static_cast<std::int64_t>(static_cast<std::uint64_t>(difference) << plane_shift), axis);
  });
  std::int64_t tmin = tmin_ = inside.tmin, tmax = tmax_ = inside.tmax;
  address3x_ = address1x_ = 0;
  if (inside.missed) {
    divider_clocks_ -= std::min<std::uint64_t>(divider_clocks_, 1);
    return o;
  }

  const node* const nodes = tables_->nodes.data();
  const std::uint32_t* const lists = tables_->lists.data();
  const std::uint32_t mask = address_mask_;
  const std::uint32_t list_end = mask + 1 - bih_stack_words;
  bih_stack_entry* const bottom = stack_.data();
  bih_stack_entry* top = bottom;  // the entry that a push writes
  bih_stack_entry* highest = bottom;
  std::int64_t dist0 = dist0_, dist1 = dist1_;
  std::uint32_t at = 0;
  std::uint64_t clock = 1;
  std::uint64_t pushes = 0, leaves = 0, empty_leaves = 0;
  std::uint64_t divider_free = divider_clocks_, waits = 0;  // in LEAF, for an iterative divider
  std::uint64_t lost = 0;                                   // pushed, and never popped, as a push emptied the stack
  std::uint64_t pushes_to_wrap = 0;                         // how many pushes there were then
  std::int64_t nearest = no_hit;
  std::size_t known = 0;
  if constexpr (EarlyOut) results_.clear();
  // The nearest hit of which the result is there in clock c.
  const auto nearest_at = [&](std::uint64_t c) {
    for (; known < results_.size() && results_[known].known <= c; ++known) nearest = results_[known].distance;
    return nearest;
  };

  for (;;) {
    const node& words = nodes[at];
    const std::uint32_t axis = words.axis;
    if (axis != bih_leaf) {  // NODE and INNER
      clock += 2;
      const std::uint32_t is_down = down[axis];
      dist0 = distance_to(words.clip[is_down], axis);
      dist1 = distance_to(words.clip[is_down ^ 1], axis);
      bool to_near = dist0 >= tmin, to_far = dist1 <= tmax;
      if constexpr (EarlyOut) {
        const std::int64_t limit = nearest_at(clock - 1);
        to_near = to_near && tmin <= limit;
        to_far = to_far && std::max(tmin, dist1) <= limit;
      }
      const std::uint32_t near_child = words.pointer + is_down;
      if (to_near) {
        if (to_far) {
          ++pushes;
          ++clock;
          top->far = near_child ^ words.sibling;
          top->tmin = std::max(tmin, dist1);
          top->tmax = tmax;
          if (top++ == bottom + most_bih_stack_entries) {
            if (!params_.stack_wraps) {
              o.overflow = true;
              return o;
            }
            top = bottom;
            lost += bih_stack_words;
            pushes_to_wrap = pushes;
          }
          highest = std::max(highest, top);
        }
        tmax = std::min(tmax, dist0);
        at = near_child;
        continue;
      }
      if (to_far) {
        tmin = std::max(tmin, dist1);
        at = near_child ^ words.sibling;
        continue;
      }
    } else {  // NODE and LEAF
      ++clock;
      ++leaves;
      const std::uint32_t first = words.pointer, count = words.triangles;
      const unsigned interval = params_.triangle_interval_cycles;
      const auto issue = [&](std::uint32_t triangle, std::uint64_t when) {
        if (interval != 1) {
          const std::uint64_t wait = divider_free > when ? divider_free - when : 0;
          waits += wait;
          clock += wait;
          when += wait;
          divider_free = when + interval;
        }
        if constexpr (EarlyOut)
          expect(when, visit(triangle, when));
        else
          visit(triangle, when);
      };
      if (first < list_end && count <= list_end - first) {
        const std::uint32_t* const list = lists + first;
        if constexpr (visits_leaves<Visit>::value) {
          if (interval == 1) {
            visit.leaf(first, list, count, [&](std::uint32_t i, [[maybe_unused]] std::int64_t hit_distance) {
              if constexpr (EarlyOut) expect(clock + i, hit_distance);
            });
          } else {
            for (std::uint32_t i = 0; i < count; ++i) issue(list[i], clock + i);
          }
        } else {
          for (std::uint32_t i = 0; i < count; ++i) issue(list[i], clock + i);
        }
      } else {
        for (std::uint32_t i = 0; i < count; ++i) issue(list_word((first + i) & mask), clock + i);
      }
      o.triangles += count;
      clock += count;
      if (count == 0) {
        ++clock;
        ++empty_leaves;
      }
    }
    if (top == bottom) {  // the ray's end
      address3x_ = at;
      if (axis == bih_leaf)
        address1x_ = (words.pointer + std::max(words.triangles, 1u) - 1) & mask;
      else
        address1x_ = pushes == 0 ? 0 : list_end + (pushes == pushes_to_wrap ? most_bih_stack_entries : 0);
      break;
    }
    // POP
    bool visited = true;
    do {
      --top;
      ++clock;
      tmin = top->tmin;
      tmax = top->tmax;
      if constexpr (EarlyOut) visited = tmin <= nearest_at(clock - 1);
    } while (!visited && top != bottom);
    if (!visited) {
      address3x_ = address1x_ = list_end;
      break;
    }
    at = top->far & mask;
  }
  tmin_ = tmin;
  tmax_ = tmax;
  dist0_ = dist0;
  dist1_ = dist1;
  o.max_stack = static_cast<std::uint32_t>(highest - bottom);
  o.visits.push = pushes;
  o.visits.pop = pushes - lost;
  o.visits.leaf = o.triangles + empty_leaves + waits;
  divider_clocks_ = divider_free > clock ? divider_free - clock : 0;
  o.visits.inner = (clock - 1 - pushes - o.visits.pop - leaves - o.visits.leaf) / 2;
  o.visits.node = o.visits.inner + leaves;
  return o;
}

}  // namespace rtusim
