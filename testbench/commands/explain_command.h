#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rtusim {

/// Every parameter and every figure of the statistics file whose key begins with `key` (all when empty); if none does, those whose key
/// holds it anywhere.
/// Errors: input_error that names the nearest key when there are none.
std::string explain_text(const std::string& key);

/// Every parameter and every figure as a page of Markdown: `testbench/commands/REFERENCE.md`.
std::string reference_page();

/// The contract of timing of each unit of a design, a line each: what `unit_timing` says, in cycles. Equal ones in a row share a line.
/// `architecture` may be empty; `assignments` are KEY=VALUE. One a process, as SystemC elaborates the design.
/// Errors: input_error for files and values that can't be used.
std::string timing_text(const std::filesystem::path& architecture, const std::vector<std::string>& assignments);

/// Adds the command to the program.
void add_explain(CLI::App& program);

}  // namespace rtusim
