#pragma once

#include "modules/bih_core/bih_kind.h"
#include "testbench/units/lone_unit.h"

namespace rtusim {

/// Sees that a triangle unit can be run without a mesh. Errors: input_error.
void check_alone(const bih_kind& kind);

/// One core of the hierarchy alone on raw words; its memory is a folder as `read_bih` takes it.
///
/// Columns ray, pos_x .. pos_z, dir_x .. dir_z, idir_x .. idir_z; outputs clocks, the visits of each state (aabb, node, inner, push, pop,
/// leaf), max_stack (the largest stack_pos), ntris, tris (the triangle numbers in their order, between semicolons). Rays follow back to
/// back.
/// Errors: input_error for the files and for a hierarchy in which a ray might not end, simulation_error for a stack that overflows.
void bench_bih_core(const design& d, const unit_files& files);

}  // namespace rtusim
