#pragma once

#include "testbench/units/lone_unit.h"

namespace rtusim {

/// Columns n, d; outputs q (raw word), err.
/// Errors: input_error for the files.
void bench_t_div(const design& d, const unit_files& files);

/// Columns en, pos_x .. pos_z, dir_x .. dir_z, r, pp, pq, d, np, nq, e1p, e1q, e2p, e2q; outputs rdy, hit, u, v, t (raw words).
/// Errors: input_error for the files.
void bench_triangle_unit(const design& d, const unit_files& files);

}  // namespace rtusim
