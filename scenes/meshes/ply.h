#pragma once

#include <string>
#include <string_view>

#include "scenes/meshes/polygon.h"

namespace rtusim {

/// Reads the vertices and faces of a PLY (Turk 1994), text or binary of either order, its elements in any order.
///
/// An element `vertex` has the properties x, y and z of any type; `face` and `tristrips` have a list `vertex_indices`, or `vertex_index`,
/// of any whole type. Of a strip, -1 begins another and every triangle is a face, numbered after those before it. Faces of fewer than three
/// corners are lines or points: they keep their number and give no triangle. Other elements and properties are skipped.
/// Text has one element a line; its coordinates are read in binary64, whatever type they are said to have.
/// `place` names the file in errors.
/// Errors: input_error, with the line in text, for a header that is not understood, fewer or more values than it announces, other elements
/// that look like vertices or faces but lack their properties, and indices of vertices that are not there.
polygons parse_ply(std::string_view bytes, const std::string& place);

}  // namespace rtusim
