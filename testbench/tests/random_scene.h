#pragma once

#include <cstdint>
#include <vector>
#include "testbench/tests/random.h"

#include "modules/formats/packets.h"
#include "modules/formats/svo_image.h"
#include "modules/numeric/float_to_fixed.h"
#include "modules/svo_core/svo_params.h"

/// Random cores, octrees and rays from a seed.
namespace rtusim::test {

/// All errata of the core on.
svo_core_params as_built();

/// Any errata, any word width, stacks that are sometimes too short.
svo_core_params random_core(rng& random);

/// An octree of random shape with near and far pointers; sometimes mere noise.
svo_image random_image(rng& random);

/// A ray at the root cube, or raw words; sometimes at another word than the root.
traversal_job random_job(rng& random, const numeric::fixed_format& format, std::uint32_t words);

/// A job packet of a ray through the root cube, or of random words; `id` in its job word.
job_packet random_packet(rng& random, std::uint32_t id);

}  // namespace rtusim::test
