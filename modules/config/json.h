#pragma once

#include <string_view>

namespace rtusim::config {

/// The deepest nesting of arrays and objects that a JSON text of a user may have: what works through one by recursion stays on the stack.
inline constexpr int most_json_levels = 32;

/// How deep a JSON text nests them, whether or not it is sound.
int json_levels(std::string_view text);

}  // namespace rtusim::config
