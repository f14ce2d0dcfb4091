#pragma once

#include <functional>
#include <string>

namespace rtusim {

/// Runs `work` in a process of its own, as SystemC elaborates once in each, and gives back what it returns. What it throws
/// comes back as the text behind "error: ".
std::string in_child(const std::function<std::string()>& work);

}  // namespace rtusim
