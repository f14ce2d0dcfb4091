#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "scenes/meshes/mesh.h"

namespace rtusim {

/// A bicubic Bezier patch: control point (i, j) is number 4 i + j.
using bezier_patch = std::array<glm::dvec3, 16>;

/// Reads the text of a `.bpt` file: the number of patches; then, for each, its degrees `3 3` and the 16 control points.
/// `place` names the file in errors.
/// Errors: input_error that names the line, when there are fewer or more numbers than claimed, no numbers, or other degrees.
std::vector<bezier_patch> parse_bpt(std::string_view text, const std::string& place);

/// Cuts each patch into `quads` by `quads` quads and each of these into two triangles; y and z change places, so that Newell's
/// models stand upright in a world whose y points up.
///
/// A quad has the corners a = (i, j), b = (i+1, j), c = (i+1, j+1), d = (i, j+1), with i along the slow index of the control
/// points; its triangles are (a, b, d) and (b, c, d). Triangles without area, where an edge of the patch shrinks to a
/// point, are among them. Equal edges of two patches give equal vertices, so there are no gaps between patches.
mesh tessellate(const std::vector<bezier_patch>& patches, unsigned quads);

}  // namespace rtusim
