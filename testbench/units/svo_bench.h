#pragma once

#include "testbench/units/lone_unit.h"

namespace rtusim {

/// Columns id, a, addr, t0x .. t1z; outputs hit, t_hit, normal_axis, cost, states, raw_t_hit, raw_normal_axis. One core, its result
/// taken at once; `states`: clock edges from the accepting edge to the first at which the result is valid.
/// Errors: input_error for the files, simulation_error for a stack that overflows.
void bench_svo_core(const design& d, const unit_files& files);

/// Columns id, float_bits; output fixed_raw.
void bench_float_to_fixed(const design& d, const unit_files& files);

}  // namespace rtusim
