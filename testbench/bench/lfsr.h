#pragma once

#include <cstdint>
#include <vector>

#include "modules/timing/offer.h"

namespace rtusim {

/// Bit 0 of a 16-bit linear feedback shift register that holds its seed at cycle 0 and steps after every edge:
/// x = (x >> 1) ^ (x & 1 ? 0xB400 : 0), period 65,535.
class lfsr final : public pattern {
 public:
  static constexpr unsigned period = 65'535;

  /// A seed of 0 would stay 0: it must be 1 to 65,535.
  explicit lfsr(std::uint16_t seed);

  static constexpr std::uint16_t step(std::uint16_t x) { return static_cast<std::uint16_t>((x >> 1) ^ ((x & 1) != 0 ? 0xB400 : 0)); }
  /// The register in cycle c.
  std::uint16_t state(cycle c) const { return states_[c % period]; }

  cycle next(cycle c) const override;
  std::uint64_t count(cycle from, cycle to) const override;

 private:
  std::uint64_t count_before(cycle c) const { return c / period * ones_before_[period] + ones_before_[c % period]; }

  std::vector<std::uint16_t> states_;
  std::vector<std::uint32_t> ones_before_;  // ones in the first n cycles of a period
};

}  // namespace rtusim
