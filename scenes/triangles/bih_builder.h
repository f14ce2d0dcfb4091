#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "modules/formats/bih_memory.h"

namespace rtusim {

/// The smallest box around a triangle, in grid units.
struct triangle_box {
  per_axis<std::int64_t> lower{};
  per_axis<std::int64_t> upper{};
};

/// Builds a hierarchy over triangles, which keep their numbers: a node's box is that of its triangles; it is split in the middle of its
/// longest side (the first of equals), the triangles whose boxes have their centre below going left, or, where that leaves a side empty,
/// into halves by their centres along it; a node of at most `leaf_size` triangles is a leaf. Nodes and lists lie depth first, left before
/// right, the two children of a node side by side; the splits keep the order among triangles that go the same way.
///
/// The corner is that of the box around all; `triangles` stay empty, they are the caller's.
/// Errors: input_error for a leaf size of 0, no triangles, a hierarchy that does not fit 2^address_bits - 32 nodes and list words (it says
/// which `address_bits` would do), or one too deep for the stack; `place` names the model.
bih_memory build_bih(const std::vector<triangle_box>& boxes, unsigned leaf_size, unsigned address_bits, const std::string& place);

}  // namespace rtusim
