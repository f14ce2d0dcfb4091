#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "testbench/pictures/ambient_shade.h"
#include "testbench/pictures/frame.h"
#include "testbench/pictures/picture_colours.h"
#include "testbench/pictures/pictures.h"

namespace rtusim {

/// A pixel's normal, of length 1; 0 without one.
inline std::array<float, 3> normal_of(const frame& f, std::size_t pixel) {
  if (!f.surfaces().empty()) return f.surfaces()[pixel].normal;
  std::array<float, 3> n{};
  const frame::pixel& p = f.pixels()[pixel];
  if (p.normal_axis >= 0) n[static_cast<std::size_t>(p.normal_axis)] = static_cast<float>(p.normal_sign);
  return n;
}

/// The finest voxel that a pixel's ray hit, counted from the cube's corner (-1, -1, -1); none on a miss, or without places.
std::optional<std::array<std::uint32_t, 3>> voxel_of(const frame& f, std::size_t pixel);

/// How colours follow from numbers.
struct map_scale {
  double low = 0, high = 0;  ///< the numbers at its ends
  bool cut = false;          ///< there are greater ones, which look as `high` does
  std::string unit;
  std::function<colour(double share)> shown;  ///< 0 to 1 of its length
  std::string figures;                        ///< more about the numbers; may be empty
};

/// A colour with a meaning of its own.
struct map_swatch {
  colour shown;
  std::string meaning;
};

/// A map of a frame: the colour of each pixel, and what one needs to read it.
struct picture_map {
  /// What becomes of it where there is no room: the mean of colours, some of the pixels, or the picture's middle enlarged, as pixels
  /// side by side differ.
  enum class reduction : std::uint8_t { means, samples, middle };

  std::string title;
  std::string meaning;
  std::function<colour(std::size_t pixel)> at;
  reduction look = reduction::means;
  std::optional<map_scale> scale;
  std::vector<map_swatch> swatches;
};

/// The map that a PNG of this kind shows: any but `sheet` and `layers`. The frame must outlive it.
picture_map map_of(const frame& f, picture_kind kind);

/// The map of kind `lit`, where the frame's shade is known.
picture_map lit_map(const frame& f, std::shared_ptr<const surface_shade> shade);

/// A whole number with its thousands told apart, another one with four digits.
std::string number_text(double value);

/// In one line, where its colours stand for numbers; else empty.
std::string scale_text(const picture_map& map);

}  // namespace rtusim
