#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "testbench/pictures/frame.h"

namespace rtusim {

/// What a picture shows. Misses, pixels to which no ray was sent and pixels without a result have colours of their own.
enum class picture_kind : std::uint8_t {
  shaded,   ///< NAME.png: by normal axis, x 0.7, y 0.9, z 0.5; a miss is white (Espe 2019, app. F `save_output`)
  lit,      ///< NAME.lit.png: by a light from above the eye's left, and by the share of the sky that neighbours leave (see `ambient_shade`)
  depth,    ///< NAME.depth.png: the frame's least t_hit light grey to its greatest dark grey, linearly; a miss is dark blue
  normal,   ///< NAME.normal.png: components from -1 to 1 as red, green, blue from 0 to 1
  cost,     ///< NAME.cost.png: a miss is red 1, green = blue = 0.95^((cost - 2) / 2), hits as in `shaded` (ibid., `highlight_cost`)
  heat,     ///< NAME.heat.png: cost of hits and misses, on the scale `inferno`
  latency,  ///< NAME.latency.png: cycles from a job's acceptance until its result leaves, on the scale `viridis`
  wait,     ///< NAME.wait.png: those of them in which the ray waited, on the scale `viridis`
  core,     ///< NAME.core.png: which core, in the colours of Okabe and Ito and their dark shades; from the 17th core on they repeat
  model,    ///< NAME.model.png: which part of the model: a triangle, or a 32nd of the voxels' cube, each in a colour by its number
  sheet,    ///< NAME.sheet.png: a contact sheet of all maps with titles, legends and scales
  layers    ///< NAME.exr: everything at once, one float channel each
};

/// The kind that a file name asks for. Call it before the simulation, so that a mistyped name costs no run.
/// Upper and lower case are the same. A WORD of NAME.WORD.png that is no kind belongs to the picture's name.
/// Errors: input_error for an ending other than .png and .exr, and for a WORD that is nearly a kind.
picture_kind kind_of(const std::filesystem::path& file);

/// The words of NAME.WORD.png, each a map: `lit, depth or model`.
std::string picture_words();

/// Whether the kind shows more with `frame::places`.
bool shows_places(picture_kind kind);

/// What a contact sheet says of the run.
struct picture_text {
  std::string title;
  std::string details;
};

/// Loads OpenImageIO on a thread of its own, so that it is there when the run ends. Goes only when it is loaded: a program must not
/// end within that.
class picture_preparation {
 public:
  explicit picture_preparation(bool wanted);
  ~picture_preparation();
  picture_preparation(const picture_preparation&) = delete;
  picture_preparation& operator=(const picture_preparation&) = delete;

 private:
  bool wanted_;
};

/// Writes a picture through OpenImageIO. The file appears under its name only when whole; the same frame gives the same bytes.
///
/// PNG: 8 bit, sRGB, values rounded down as the thesis' driver does. A pixel without a result is black. Scales reach from the frame's
/// least value to its greatest, or to the one that 99.5 % of the rays do not exceed if the greatest is much more; the file's
/// `ImageDescription` tells.
///
/// EXR channels (32-bit float, so exact up to 2^24): `R`, `G`, `B` the shaded picture in linear light, so that it looks like the
/// PNG; `lit.R`, `lit.G`, `lit.B` the lit one; `hit` 0 or 1; `depth` t_hit in world units; `normal.x`, `.y`, `.z`; `position.x`, `.y`,
/// `.z` of the hit in world units; `ambient` the sky's share, 0 to 1; `cost` in cycles; `core`, -1 for a pixel without a result;
/// `latency` and `wait` in cycles; `model` 0, -1 on a miss; of triangle cores `triangle`, its number, of others `voxel.x`, `.y`, `.z` in
/// finest voxels, -1 on a miss. Depth, normal and position of a miss are 0. Without places, position is 0, ambient 1, voxel -1.
/// Errors: input_error when the file can't be written, and for a sheet when its font is missing.
void write_picture(const std::filesystem::path& file, const frame& picture, picture_kind kind, const picture_text& text = {});

}  // namespace rtusim
