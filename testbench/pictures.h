#pragma once

#include <cstdint>
#include <filesystem>

#include "testbench/frame.h"

namespace rtusim {

/// What a picture shows.
enum class picture_kind : std::uint8_t {
  shaded,  ///< NAME.png: by normal axis, x 0.7, y 0.9, z 0.5; a miss is white (Espe 2019, app. F `save_output`)
  cost,    ///< NAME.cost.png: a miss is red 1, green = blue = 0.95^((cost - 2) / 2), hits as in `shaded` (ibid., `highlight_cost`)
  depth,   ///< NAME.depth.png: the frame's least t_hit light grey to its greatest dark grey, linearly; a miss is dark blue
  layers   ///< NAME.exr: everything at once, one float channel each
};

/// The kind that a file name asks for. Call it before the simulation, so that a mistyped name costs no run.
/// Errors: input_error for an ending other than .png and .exr (in either case), and for NAME.WORD.png with an unknown WORD.
picture_kind kind_of(const std::filesystem::path& file);

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
/// PNG: 8 bit, sRGB, values rounded down as the thesis' driver does. A pixel without a result is black.
/// EXR channels (32-bit float, so exact up to 2^24): `R`, `G`, `B` the shaded picture in linear light, so that it looks like the
/// PNG; `hit` 0 or 1; `depth` t_hit in world units; `normal.x`, `.y`, `.z`; `cost` in clocks; `core`, -1 for a pixel without a
/// result; `latency` in cycles. Depth and normal of a miss are 0.
/// Errors: input_error when the file can't be written.
void write_picture(const std::filesystem::path& file, const frame& picture, picture_kind kind);

}  // namespace rtusim
