#pragma once

#include <cstdint>

#include "scenes/meshes/mesh.h"

namespace rtusim {

/// Turns triangles so that the two at each edge run along it in opposite ways, as far as one can; returns how many were turned.
///
/// Of each part that hangs together by edges of two triangles the fewer triangles are turned, so that a part keeps the side that most of
/// its triangles call outside: a hollow within another body stays one. If they are as many either way, the part comes to bound a volume
/// above 0. Some edges stay as they were: those of more than two triangles, and some of a part with one side alone, as a Moebius strip.
std::uint64_t turn_alike(mesh& m);

}  // namespace rtusim
