#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "modules/config/input_ledger.h"
#include "testbench/run/run_setup.h"
#include "testbench/sweep/sweep_plan.h"

namespace rtusim {

/// A point of a plan, and all that determines its results.
struct sweep_task {
  std::size_t number = 0;
  const sweep_plan::point* point = nullptr;
  std::vector<config::input_file> inputs;  ///< the files of its model and rays
  std::string identity;                    ///< the design and scene, what these files hold, and the program: a line of JSON
  std::string name;                        ///< a hash of all that but the program: the folder of its results
  std::string walk;                        ///< the part that determines the rays' walks
  bool replayed = false;                   ///< it needs no clock
  std::string failure;                     ///< why it can't be run; then it has no identity
};

/// The points of a plan in its order. Reads each file of a model or of rays; `inputs` keeps what it read as far as it has room.
std::vector<sweep_task> tasks_of(const sweep_plan& plan);

/// The identity of a run with these inputs. It holds no name of a file, so that a sweep may move with its files, nor what can't change the
/// results. Another program has another identity: its sources may tell other results.
std::string identity_of(const run_setup& s, const std::vector<config::input_file>& inputs);

/// The first file that was read with other contents than a task's identity holds; empty if there is none. `whole`: the reading came to its
/// end, so that a file that was not read is one, too.
std::string changed_input(const std::vector<config::input_file>& expected, const std::vector<config::input_file>& read, bool whole);

}  // namespace rtusim
