#pragma once

#include <array>
#include <cstdint>

namespace rtusim {

/// sRGB, 0 to 1.
using colour = std::array<double, 3>;

/// A colour that 8 bits hold exactly.
constexpr colour of_bytes(unsigned red, unsigned green, unsigned blue) {
  return {(red + 0.5) / 255.5, (green + 0.5) / 255.5, (blue + 0.5) / 255.5};
}
constexpr colour grey(double value) { return {value, value, value}; }

inline constexpr colour no_result = grey(0);
inline constexpr colour nothing_met = of_bytes(236, 237, 240);  ///< a miss, or a pixel to which no ray was sent

double linear_light(double srgb);
double srgb_of(double linear_light);

/// Scales on which equal steps look equal, also to people with colour blindness, and whose lightness grows all the way (van der Walt
/// and Smith 2015).
enum class colour_scale : std::uint8_t { viridis, inferno };

/// `share`: 0 to 1 of the scale's length.
colour on_scale(colour_scale scale, double share);

/// Colours that people with colour blindness tell apart: those of Okabe and Ito 2008 with grey for black, then the same at half
/// their brightness; then they repeat.
inline constexpr unsigned told_apart = 16;
colour of_category(std::uint32_t number);

/// For more things than there are colours: neighbours in number seldom look alike.
colour of_hash(std::uint64_t number);

}  // namespace rtusim
