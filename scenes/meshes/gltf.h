#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "scenes/meshes/polygon.h"

namespace rtusim {

/// Gives the bytes of a file beside a glTF, at most so many; `name` is relative to the glTF's folder, its percent codes decoded.
/// Errors: input_error when there is none that may be read.
using beside_reader = std::function<std::string(const std::string& name, std::uint64_t most_bytes)>;

/// Reads the triangles, strips and fans of a glTF 2.0 (`binary`: of a `.glb`) as its scene shows them: the transforms of its nodes and the
/// weights of its morph targets applied, in binary64; triangles of a node that mirrors are turned, as the standard demands. Positions are
/// of binary32, or of the types of KHR_mesh_quantization if the file requires that. Points and lines are left out.
///
/// The scene is the file's own choice, else its first one; without scenes it is all nodes that have no parent. Each instance of a primitive
/// has vertices of its own, those that its faces use; faces count on from node to node, depth first. Buffers are read when they are needed:
/// the binary chunk, data URIs and files beside; together at most 1 GB.
/// `place` names the file in errors.
/// Errors: input_error for other versions, broken or deeply nested JSON, wrong types, references to what is not there or does not fit, an
/// index beyond the positions, nodes with two parents or in a loop, skins, extensions without which the shapes can't be read, more than
/// `most_faces` faces, and whatever `read_beside` throws.
polygons parse_gltf(std::string_view bytes, bool binary, const std::string& place, std::uint64_t most_faces,
                    const beside_reader& read_beside);

}  // namespace rtusim
