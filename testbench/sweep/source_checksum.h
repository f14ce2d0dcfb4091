#pragma once

#include <string_view>

namespace rtusim {

/// SHA-256 of this program's sources, of their names and contents: the same in every build of them, another as soon as one is changed.
std::string_view source_checksum();

}  // namespace rtusim
