#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "testbench/units/lone_unit.h"

namespace CLI {
class App;
}

namespace rtusim {

/// What `rtusim unit` was asked for.
struct unit_request {
  std::string name;
  unit_files files;
  std::filesystem::path architecture;
  std::vector<std::string> assignments;
};

/// The names of the units that can be run alone: `a, b or c`.
std::string lone_unit_words();

/// Reads the design and benches the named unit. Errors: input_error for an unknown name or files that don't fit it.
void bench_unit(const unit_request& asked);

/// Adds the command to the program.
void add_unit(CLI::App& program);

}  // namespace rtusim
