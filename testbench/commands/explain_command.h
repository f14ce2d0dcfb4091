#pragma once

#include <string>

namespace CLI {
class App;
}

namespace rtusim {

/// Every parameter and every figure of the statistics file whose key begins with `key` (all when empty); if none does, those whose key
/// holds it anywhere.
/// Errors: input_error that names the nearest key when there are none.
std::string explain_text(const std::string& key);

/// Adds the command to the program.
void add_explain(CLI::App& program);

}  // namespace rtusim
