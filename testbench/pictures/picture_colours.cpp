#include "testbench/pictures/picture_colours.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

namespace rtusim {
namespace {

constexpr std::size_t steps = 256;
using ramp = std::array<colour, steps>;

ramp ramp_of(const char* name) {
  OIIO::ImageBuf shares(OIIO::ImageSpec(static_cast<int>(steps), 1, 1, OIIO::TypeDesc::FLOAT));
  for (OIIO::ImageBuf::Iterator<float> at(shares); !at.done(); ++at) at[0] = static_cast<float>(at.x()) / (steps - 1);
  const OIIO::ImageBuf shown = OIIO::ImageBufAlgo::color_map(shares, 0, name, {}, 1);
  ramp r;
  for (OIIO::ImageBuf::ConstIterator<float> light(shown); !light.done(); ++light)
    for (int i = 0; i < 3; ++i) r[static_cast<std::size_t>(light.x())][static_cast<std::size_t>(i)] = srgb_of(light[i]);
  return r;
}

constexpr std::array<colour, told_apart / 2> okabe_ito{of_bytes(230, 159, 0),   of_bytes(86, 180, 233), of_bytes(0, 158, 115),
                                                       of_bytes(240, 228, 66),  of_bytes(0, 114, 178),  of_bytes(213, 94, 0),
                                                       of_bytes(204, 121, 167), of_bytes(136, 136, 136)};

colour mix(const colour& a, const colour& b, double share_of_b) {
  colour c{};
  for (std::size_t i = 0; i < 3; ++i) c[i] = a[i] + (b[i] - a[i]) * share_of_b;
  return c;
}

}  // namespace

double linear_light(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

double srgb_of(double light) {
  const double held = std::clamp(light, 0.0, 1.0);
  return held <= 0.0031308 ? held * 12.92 : 1.055 * std::pow(held, 1 / 2.4) - 0.055;
}

colour on_scale(colour_scale scale, double share) {
  static const ramp viridis = ramp_of("viridis"), inferno = ramp_of("inferno");
  const double place = std::clamp(share, 0.0, 1.0) * (steps - 1);
  return (scale == colour_scale::viridis ? viridis : inferno)[static_cast<std::size_t>(place + 0.5)];
}

colour of_category(std::uint32_t number) {
  const colour& c = okabe_ito[number % okabe_ito.size()];
  return number % told_apart < okabe_ito.size() ? c : mix(c, grey(0), 0.5);
}

colour of_hash(std::uint64_t number) {
  // The finaliser of MurmurHash3.
  number = (number ^ number >> 33) * 0xff51afd7ed558ccdu;
  number = (number ^ number >> 33) * 0xc4ceb9fe1a85ec53u;
  number ^= number >> 33;
  const colour& c = okabe_ito[number % okabe_ito.size()];
  const auto shade = number >> 8 & 3;  // half of all as they are
  if (shade == 0) return mix(c, grey(0), 0.3);
  return shade == 1 ? mix(c, grey(1), 0.45) : c;
}

}  // namespace rtusim
