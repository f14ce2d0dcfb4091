#pragma once

#include <string>

namespace rtusim {

/// Every parameter and every figure of the statistics file whose key begins with `key` (all when empty).
/// Errors: input_error that names the nearest key when none does.
std::string explain_text(const std::string& key);

}  // namespace rtusim
