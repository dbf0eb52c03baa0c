// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FastExp_h
#define mammoray_FastExp_h

#include <bit>
#include <cstdint>

// Loops over energies take most of the time of a polychromatic image. GCC compiles a function with
// this mark for several instruction sets and selects one at load time, before sanitizers can run.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
  !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define MAMMORAY_VECTOR_CLONES __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define MAMMORAY_VECTOR_CLONES
#endif
// A function that is not inlined into the clones would be called for each value.
#if defined(__GNUC__)
#define MAMMORAY_ALWAYS_INLINE __attribute__((always_inline)) inline
#else
#define MAMMORAY_ALWAYS_INLINE inline
#endif

namespace mammoray
{
/**
 * exp(x) for x <= 0 in a form that compilers vectorise: x = n ln 2 + r, 2^n by its bits and
 * Taylor's series to r^9; relative error 1e-11, since |r| <= 0.35. Below -690 it stays at
 * exp(-690).
 */
MAMMORAY_ALWAYS_INLINE double FastExp(double x)
{
  constexpr double shift = 6755399441055744.0; // 1.5 * 2^52: rounds to a whole number
  x = x < -690 ? -690 : x;
  const double shifted = x * 1.4426950408889634 + shift;
  const double n = shifted - shift;
  const double r = (x - n * 0.693147180369123816490) - n * 1.90821492927058770002e-10;
  double series = 1.0 / 362880;
  series = series * r + 1.0 / 40320;
  series = series * r + 1.0 / 5040;
  series = series * r + 1.0 / 720;
  series = series * r + 1.0 / 120;
  series = series * r + 1.0 / 24;
  series = series * r + 1.0 / 6;
  series = series * r + 0.5;
  series = series * r + 1.0;
  series = series * r + 1.0;
  return series *
    std::bit_cast<double>(
      (std::bit_cast<std::uint64_t>(shifted) << 52) + std::bit_cast<std::uint64_t>(1.0));
}
}

#endif
