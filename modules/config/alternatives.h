#pragma once

#include <cstddef>
#include <string>

namespace rtusim::config {

/// The words of a container as a choice: `a, b or c`.
template <class Words>
std::string alternatives(const Words& words) {
  std::string text;
  std::size_t left = words.size();
  for (const auto& word : words) {
    text += word;
    if (--left > 0) text += left == 1 ? " or " : ", ";
  }
  return text;
}

}  // namespace rtusim::config
