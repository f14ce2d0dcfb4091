#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace rtusim {

/// What `rtusim sweep` was asked for.
struct sweep_options {
  enum class engine : unsigned char { local, slurm };

  std::filesystem::path file;
  std::filesystem::path out;  ///< folder of the results
  unsigned jobs = 1;          ///< worker processes, or tasks of the array
  engine how = engine::local;
  std::string share;          ///< "I/N": only the points with number modulo N = I, and no table: for one of N machines
  bool retry_failed = false;  ///< points that failed before are run again
  bool units = false;         ///< a second header row in results.csv: the unit of each column
  bool quiet = false;
};

/// Runs each point of a sweep file that has no result yet, and gathers all in two tables.
///
/// In `out`: `points/NAME/` with the statistics file and pictures of each point, named by a hash of its design, its scene and what the
/// model's files hold; `results.csv`, a row a point in the order of the plan: point, scene, architecture, a column for each axis, status,
/// reason, a column for each figure; `results.json`, the same with the columns' units and meanings. A point's folder appears only when it
/// is whole and on the disk, so what is there after an interruption, or a loss of power, counts, and what two sweeps share is run once.
/// Results of another version of this program do not count. A point that fails is a row with its reason, and is not tried again unless that
/// is asked for.
///
/// Each input is read once, before the first point is run; a large one may be read again, and then must be what it was. A second sweep in
/// the same folder waits for the first, but shares work side by side.
///
/// Each point runs in a process of its own. Points with the same rays share their walks, where the schedule follows from these
/// (see `replay`).
/// Errors: input_error for the sweep file, a folder that holds something else, results that can't be written, a Slurm that is not there;
/// simulation_error when it is interrupted, and, at its end, when points failed; then stderr has their reasons.
void sweep(const sweep_options& o);

/// Adds the command to the program.
void add_sweep(CLI::App& program);

}  // namespace rtusim
