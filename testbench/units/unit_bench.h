#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "modules/rtu/design.h"

namespace rtusim {

/// One unit alone on raw words: the files of `rtusim unit`.
struct unit_files {
  std::filesystem::path jobs;   ///< input columns, and notes, which are copied
  std::filesystem::path out;    ///< the same with the outputs
  std::filesystem::path model;  ///< svo_core's memory
  std::filesystem::path memory; ///< bih_core's, a folder
};

/// Columns id, a, addr, t0x .. t1z; outputs hit, t_hit, normal_axis, cost, states, raw_t_hit, raw_normal_axis. One core, its result
/// taken at once; `states`: clock edges from the accepting edge to the first at which the result is valid.
/// Errors: input_error for the files, simulation_error for a stack that overflows.
void bench_svo_core(const design& d, const unit_files& files);

/// Columns id, float_bits; output fixed_raw.
void bench_float_to_fixed(const design& d, const unit_files& files);

/// What `rtusim unit` was asked for.
struct unit_request {
  std::string name;
  unit_files files;
  std::filesystem::path architecture;
  std::vector<std::string> assignments;
};

/// Reads the design and benches the named unit. Errors: input_error for an unknown name or files that don't fit it.
void bench_unit(const unit_request& asked);

}  // namespace rtusim
