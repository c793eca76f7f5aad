// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cmath>

#include "gaiter/base/multiversion.hpp"

// Loops over a pack of slices are written plainly and vectorised by the compiler. The C library's vector
// exponentials and logarithms (1 to 2 ulp) are declared here because its own headers offer them only under
// -ffast-math, which would allow the reordering and the loss of infinities that the laws rely on.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__GLIBC__) && \
    (__GLIBC__ > 2 || (__GLIBC__ == 2 && __GLIBC_MINOR__ >= 35))
extern "C" {
__attribute__((simd("notinbranch"), const)) double expm1(double) noexcept;
__attribute__((simd("notinbranch"), const)) double log1p(double) noexcept;
__attribute__((simd("notinbranch"), const)) double log(double) noexcept;
__attribute__((simd("notinbranch"), const)) double exp(double) noexcept;
__attribute__((simd("notinbranch"), const)) float expm1f(float) noexcept;
__attribute__((simd("notinbranch"), const)) float log1pf(float) noexcept;
__attribute__((simd("notinbranch"), const)) float logf(float) noexcept;
__attribute__((simd("notinbranch"), const)) float expf(float) noexcept;
}
#endif

namespace gaiter::physics {

// Slices are worked on in packs of this many, one array of a pack a quantity. Every slice of a pack takes the
// same instructions, so a result does not depend on the place of its slice.
constexpr int pack_width = 64;

// One quantity for each slice of a pack.
template <typename Number>
struct alignas(64) PackOf {
  Number value[pack_width];

  Number& operator[](int i) { return value[i]; }
  Number operator[](int i) const { return value[i]; }
};

using Pack = PackOf<double>;

}  // namespace gaiter::physics
