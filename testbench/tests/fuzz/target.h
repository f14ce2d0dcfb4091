#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// Readers of the user's files, given what no writer would write. A reader accepts or throws input_error: a crash, another error, more than
/// 10 s or 1 GB is a fault.
namespace rtusim::fuzz {

struct target {
  std::string name;
  std::string file;                                 ///< what the input is called, below a folder of its own
  std::function<std::vector<std::string>()> seeds;  ///< files to begin with, the first one sound
  std::function<void(const std::filesystem::path&)> read;
};

/// All targets of this program.
std::vector<target>& targets();

/// A target's source has one of these.
struct registered {
  explicit registered(target t) { targets().push_back(std::move(t)); }
};

/// The source tree's folder.
std::filesystem::path tree();
/// The bytes of a file of the tree.
std::string tree_file(const std::string& name);
/// `first`, and those of the tree's test cases that end so, by name.
std::vector<std::string> with_cases(std::vector<std::string> first, const std::string& ending);

/// Puts the input where the target reads it.
std::filesystem::path place(const std::filesystem::path& folder, const target& t, const std::string& bytes);

/// Reads a mesh and does with it what `info` and `convert` do.
void read_as_mesh(const std::filesystem::path& file);
/// The same beside the buffer that some of the test cases name.
void read_as_gltf(const std::filesystem::path& file);

}  // namespace rtusim::fuzz
