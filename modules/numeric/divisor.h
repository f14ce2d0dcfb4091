#pragma once

#include <cstdint>

namespace rtusim {

/// Divides by N, small numbers by a multiplication.
class divisor {
 public:
  /// 1 <= n < 65,536.
  explicit divisor(unsigned n) : n_(n), reciprocal_(((std::uint64_t{1} << 32) + n - 1) / n) {}
  std::uint64_t quotient(std::uint64_t x) const { return x < 65'536 ? x * reciprocal_ >> 32 : x / n_; }
  unsigned remainder(std::uint64_t x) const { return static_cast<unsigned>(x - quotient(x) * n_); }

 private:
  std::uint64_t n_;
  std::uint64_t reciprocal_;
};

}  // namespace rtusim
