#pragma once

#include "modules/bih_core/bih_params.h"
#include "modules/formats/bih_memory.h"
#include "testbench/tests/random.h"

/// Random cores, hierarchies and rays from a seed.
namespace rtusim::test {

/// All errata on, and the address bits of the vectors.
bih_core_params bih_as_built();

/// Any errata, any widths, small memories.
bih_core_params random_bih_core(rng& random);

/// A hierarchy that passes `check_bih` with `raw`, of at most 100,000 clocks a ray: a tree, one with shared subtrees and odd lists, or a
/// ladder that takes much of the stack.
bih_memory random_bih(rng& random, const bih_core_params& p);

/// A ray of random words; some of them lie on planes of the box, outside of it, or are parallel to an axis.
quantised_ray random_ray(rng& random, const bih_core_params& p);

}  // namespace rtusim::test
