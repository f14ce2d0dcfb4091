#pragma once

#include <string>
#include <vector>

#include "modules/formats/packets.h"
#include "modules/rtu/design.h"
#include "testbench/bench/run_figures.h"
#include "testbench/bench/scoreboard.h"
#include "testbench/bench/surroundings.h"
#include "testbench/replay/walks.h"

namespace rtusim {

/// Why a design can't be replayed, as the words of an error; empty if it can.
std::string replay_obstacle(const design& d, const surroundings& s);

/// Sees that a design can be replayed. Errors: input_error.
void check_replayable(const design& d, const surroundings& s);

/// The schedule of the walked rays from their costs alone: the cycles, figures and results that a simulation comes to.
///
/// It needs a memory that answers at once. Then a job's cycles follow from those of the jobs before it: it is accepted when the source
/// offers it and the job manager's stages move; it is at their output when they have moved six times; it is dispatched when the
/// policy finds a core; its core is done cost + 1 cycles later; and a buffer drains where the turning select meets it and the sink is
/// ready. Where an offered result stays (without the erratum valid_withdrawn) and the sink is not always ready, the buffers depend
/// on each other through the select; their drains are then followed in the order of time, as far as the next dispatch needs.
///
/// Errors: simulation_error for a stack that overflows, as the simulation's; input_error for a design that it does not cover, and where
/// transfers lie further apart than the watchdog allows, which only a simulation can judge.
run_figures replay(const design& d, const surroundings& s, const ray_walker& walk, const walked_rays& walked,
                   const result_handler& handler);

/// Walks and replays at once: one thread follows the schedule as far as rays are walked, and walks when it has to wait; the others walk.
/// `handler` is called on the caller's thread.
run_figures replay(const design& d, const surroundings& s, const ray_walker& walk, const std::vector<job_packet>& jobs, unsigned threads,
                   const result_handler& handler);

}  // namespace rtusim
