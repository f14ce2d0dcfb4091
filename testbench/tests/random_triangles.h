#pragma once

#include <cstdint>

#include "modules/formats/bih_memory.h"
#include "modules/formats/packets.h"
#include "modules/rtu/design.h"
#include "testbench/tests/random.h"

/// Random designs of triangle cores, meshes and rays from a seed.
namespace rtusim::test {

/// Any widths, errata, divider, policy and depth of the results' ring; 1 to 24 cores.
design random_triangle_design(rng& random);

/// The hierarchy of a mesh: a patch of hills, or triangles without order.
bih_memory random_triangles(rng& random, const design& d);

/// A job packet of a ray through the scene or past it, from within or outside, or of random words.
job_packet random_triangle_packet(rng& random, std::uint32_t id, const design& d, const bih_memory& scene);

}  // namespace rtusim::test
