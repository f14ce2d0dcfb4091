#pragma once

#include <string>
#include <string_view>

#include "scenes/meshes/polygon.h"

namespace rtusim {

/// Reads an STL, whose facets become faces in the file's order, each with vertices of its own.
///
/// Binary if the file is as long as the number of triangles after its first 80 bytes says, whatever these hold; the two bytes behind a
/// triangle mean nothing. Otherwise text, in any case: one solid or several, each closed. Normals are not looked at.
/// `place` names the file in errors.
/// Errors: input_error for another length, and, with the line, for text that is cut short, a facet of other than three vertices, what is no
/// keyword, and coordinates that are no finite numbers. Binary coordinates may be any.
polygons parse_stl(std::string_view bytes, const std::string& place);

}  // namespace rtusim
