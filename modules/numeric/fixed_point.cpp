#include "modules/numeric/fixed_point.h"

#include <cmath>

namespace rtusim::numeric {

double fixed_format::value(std::int64_t raw) const { return std::ldexp(static_cast<double>(raw), -static_cast<int>(fraction_bits)); }

void fixed_format::describe(config::section& s) {
  s.number("integer_bits", integer_bits, {2, 32}, "bits", "bits before the binary point, the sign among them");
  s.number("fraction_bits", fraction_bits, {1, 32}, "bits", "bits after the binary point");
}

}  // namespace rtusim::numeric
