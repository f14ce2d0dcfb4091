#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "scenes/mesh.h"

namespace rtusim {

/// Runs `work` in a child process and takes over the mesh that it gives, so that a crash, an endless loop or a hunger for memory of
/// a library's ends the child alone. The mesh's triangles refer to vertices that are there, whatever became of the child's memory.
///
/// A fork: the process has one thread alone, as another one's locks would stay locked in the child. `place` names the file.
/// Errors: the input_error that `work` threw; one that tells how the child ended if it did not end well.
mesh enclosed(const std::string& place, const std::function<mesh()>& work);

/// What the child may use, in proportion to what it has to read. To be called inside of `enclosed` alone.
class import_allowance {
 public:
  import_allowance();
  /// So many bytes more have been read.
  void admit(std::uint64_t bytes);

 private:
  std::uint64_t address_space_bytes_;  // before the import
  std::uint64_t bytes_ = 0;
};

}  // namespace rtusim
