#include "modules/numeric/divide.h"

namespace rtusim::numeric {

std::uint64_t divider::bit_by_bit(std::uint64_t n, std::uint64_t d) const {
  std::uint64_t remainder = (n - d) & mask_;
  std::uint64_t quotient = (remainder & half_) == 0;
  for (unsigned step = 2; step < width_; ++step) {
    remainder = (2 * remainder + ((remainder & half_) == 0 ? -d : d)) & mask_;
    quotient = quotient << 1 | ((remainder & half_) == 0);
  }
  return quotient;
}

}  // namespace rtusim::numeric
