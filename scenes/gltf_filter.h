#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rtusim {

/// A glTF 2.0 file (`binary`: .glb) cut down to the shapes: scenes, nodes, meshes' positions and indices, and the buffers behind
/// them. Nothing else reaches the importer, and what does is of the right type and refers to what is there. Materials,
/// animations, skins and remarks are dropped.
///
/// The nodes must form trees, as the standard demands, so that the importer's work is bounded by the file. `place` names the
/// file in errors.
/// Errors: input_error for other versions, broken or deeply nested JSON, wrong types, references to what is not there, nodes with two
/// parents or in a loop, positions that are no vectors of binary32, extensions without which the shapes can't be read, or more
/// than `most_values` positions and indices.
std::string filter_gltf(std::string_view bytes, bool binary, const std::string& place, std::uint64_t most_values);

}  // namespace rtusim
