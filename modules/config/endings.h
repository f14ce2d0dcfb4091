#pragma once

#include <algorithm>
#include <filesystem>
#include <string>

namespace rtusim::config {

/// The ending of a file's name in lower case, its point included: `.svo` of `A.SVO`; empty without one.
inline std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending;
}

/// The same of a file that may be zipped: that before `.gz`.
inline std::string unzipped_ending_of(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  return ending == ".gz" ? ending_of(file.stem()) : ending;
}

}  // namespace rtusim::config
