#pragma once

#include "modules/scheduler/policies/cyclic_first_available.h"
#include "modules/scheduler/policies/first_available.h"
#include "modules/scheduler/policies/least_recently_used.h"
#include "modules/scheduler/policies/policy_list.h"
#include "modules/scheduler/policies/round_robin.h"

namespace rtusim {

/// THE list of the scheduler's policies: the words of `scheduler.policy`, what the scheduler can do and what replay can follow. To add one,
/// write its class in a file of this folder, give it a line here, and say in scheduler_policies_test.cpp which core it points at.
///
/// A policy is a plain class without virtual functions. Its word is `name`; `meaning` goes on from "how a job finds its core:". It is
/// constructed with the number of cores, of which none is ready. For the scheduler it has
/// - `set_ready(core, ready)`: the core is ready for a job from the next cycle on, or no longer;
/// - `selected(c)`: the core that a job offered in cycle c is shown to; the number of cores if it is shown to none;
/// - `ready()`: in which cycles an offered job is taken, if nothing changes before. It may point into the policy;
/// - `takes(c, is_ready)`: whether one is taken in cycle c, told from the select and from `is_ready(core)`, which the offer is checked by;
/// - `offered(from, to)`: a job was offered in the cycles [from, to), and taken in none before the last, whatever cores were ready;
/// - `take(core)`: the core takes a job, and is not ready until it says so;
/// - `valid_cycles(core)`: in how many cycles a job was shown to the core.
///
/// Without a clock, its `schedule` tells from the cycles in which cores are free what becomes of each job. It is constructed with the
/// number of cores, too, and sees them as `cores`: `free_from(core)` is the first cycle in which the core takes a job, `never` while that
/// is not known; `know(c)` makes it known of those that are free in cycle c, and is not asked beyond the cycle in which the job is taken;
/// where the constant `known_ahead` holds, it is always known. It has
/// - `dispatch(c, cores)`: the cycle in which the next job, offered from cycle c on, is taken; `core()` is the one that takes it;
/// - `valid_cycles(core)`: as above;
/// - `ready_cycles(end, cores)`: in how many cycles before `end` an offered job would have been taken, once all of `free_from` is known.
using scheduler_policies = policy_list<cyclic_first_available, round_robin, first_available, least_recently_used>;

/// A policy's place in the list: the value of `scheduler_params::select`.
template <class Policy>
inline constexpr unsigned policy_index = scheduler_policies::index<Policy>();

}  // namespace rtusim
