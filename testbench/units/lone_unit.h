#pragma once

#include <filesystem>

#include "modules/rtu/design.h"

namespace rtusim {

/// One unit alone on raw words: the files of `rtusim unit`.
struct unit_files {
  std::filesystem::path jobs;    ///< input columns, and notes, which are copied
  std::filesystem::path out;     ///< the same with the outputs
  std::filesystem::path model;   ///< the octree of a unit that reads one
  std::filesystem::path memory;  ///< the folder of memories of a unit that reads one
};

/// A unit that can be run alone.
struct lone_unit {
  const char* name;
  void (*bench)(const design&, const unit_files&);
  bool reads_model = false;
  bool reads_memory = false;
};

}  // namespace rtusim
