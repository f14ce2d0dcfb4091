#pragma once

#include <string>
#include <string_view>

namespace rtusim {

/// Checks of a mesh file's bytes that come before the importer: what the file claims to hold must be there, so that no claim makes the
/// importer allocate or read what is not. `place` names the file in errors, which tell the line or byte.
///
/// Errors: input_error, for all of them.

/// PLY, text or binary: a header that is understood, and as many values as its elements and lists announce.
void check_ply(std::string_view bytes, const std::string& place);
/// OBJ: vertices of three numbers, faces of three corners, their indices among the vertices of the file.
void check_obj(std::string_view text, const std::string& place);
/// STL: as many bytes as a binary file's number of triangles takes; a text file that is closed.
void check_stl(std::string_view bytes, const std::string& place);

}  // namespace rtusim
