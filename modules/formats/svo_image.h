#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "modules/formats/svo_word.h"

namespace rtusim {

/// A sparse voxel octree as it lies in the unit's memory: 32-bit words, the root's descriptor at 0 (Espe 2019, sec. 4.2).
/// A file holds nothing else, each word little-endian.
struct svo_image {
  std::vector<std::uint32_t> words;
};

/// What a design can address and how deep its stack is.
struct svo_limits {
  unsigned address_bits = 20;  ///< an image has at most 2^address_bits words; 1 to 32
  unsigned stack_depth = 11;   ///< frames a core can push: an image has at most one more level of descriptors; 0 to 20
};

/// Reads and checks an image.
/// Errors: input_error when the file can't be read, is empty or no whole number of words, or fails `check_svo`.
svo_image read_svo(const std::filesystem::path& file, const svo_limits& limits = {});

/// Checks that a traversal of the image stays inside it and within the limits. Subtrees may be shared.
/// `place` names the image in errors.
/// Errors: input_error that names the word: an image that is empty or too large, a child pointer or far word that leads out of it, a
/// loop, more levels than the stack allows, a leaf that is not valid.
void check_svo(const svo_image& image, const std::string& place, const svo_limits& limits = {});

/// Writes the words, little-endian.
/// Errors: input_error when the file can't be written.
void write_svo(const std::filesystem::path& file, const svo_image& image);

/// The first word of the children of the descriptor at `entry`. The descriptor, and the far word if it has one, lie in the image.
inline std::uint64_t child_group(const svo_image& image, std::uint64_t entry) {
  const std::uint32_t word = image.words[entry];
  const std::uint64_t target = entry + child_pointer(word);
  return is_far(word) ? entry + image.words[target] : target;
}

/// The size and contents of an image.
struct svo_summary {
  unsigned levels = 0;  ///< of descriptors: the finest voxels have an edge of 2^-levels of the root cube's
  std::uint64_t bytes = 0;
  std::uint64_t nodes = 0;          ///< descriptor words that the root leads to
  std::uint64_t far_words = 0;      ///< words that hold the offset of a far pointer
  std::uint64_t leaves = 0;         ///< leaf bits of these descriptors; a shared subtree's count once
  std::uint64_t filled_voxels = 0;  ///< finest voxels inside of leaves; a shared subtree's count wherever it appears
  double filled_share = 0;          ///< of the root cube's volume
  std::array<double, 3> lower{};    ///< corners of the least box around all that is filled, x to z, in edges of the root cube: 0 to 1.
  std::array<double, 3> upper{};    ///< Both 0 if nothing is
};

/// Errors: input_error as `check_svo`.
svo_summary describe(const svo_image& image, const std::string& place, const svo_limits& limits = {});

}  // namespace rtusim
