#pragma once

#include <string>
#include <string_view>

#include "scenes/meshes/polygon.h"

namespace rtusim {

/// Reads the vertices (`v`) and faces (`f`, formerly `fo`) of a Wavefront OBJ.
///
/// A vertex is its first three numbers; up to four more, a weight (which is for curves alone) or colours, mean nothing here. Of a corner
/// `v/t/n` the first index counts, from 1 or back from the last vertex so far; t and n are whole numbers or left out, and need not be
/// there. Blanks before a line, remarks after it, and lines joined by a backslash are understood. Points, lines, normals, texture
/// coordinates, groups and materials are left out, as are keywords that are not known.
/// `place` names the file in errors.
/// Errors: input_error with the line for vertices of other than 3 to 7 numbers, faces of fewer than three corners, malformed corners,
/// vertices that are not in the file, and what would be lost in silence: free-form curves' and surfaces' (`curv`, `surf`), other files
/// (`call`) and other programs' output (`csh`).
polygons parse_obj(std::string_view text, const std::string& place);

}  // namespace rtusim
