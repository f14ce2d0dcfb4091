#pragma once

/// Code for processors with AVX2 beside code for all: a function marked RTU_AVX2 is built for the former whatever the others are built for,
/// and runs only where `has_avx2()` holds. `RTUSIM_AVX2=OFF` leaves it out.
#if defined(__x86_64__) && !defined(RTUSIM_NO_AVX2)
#define RTU_HAS_AVX2 1
#define RTU_AVX2 __attribute__((target("avx2")))
/// A part of such functions, never called by others: vectors must not cross a call that is built without AVX2.
#define RTU_AVX2_PART RTU_AVX2 __attribute__((always_inline)) inline
#else
#define RTU_HAS_AVX2 0
#endif

namespace rtusim::numeric {

inline bool has_avx2() {
#if RTU_HAS_AVX2
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

}  // namespace rtusim::numeric
