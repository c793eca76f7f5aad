// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstdlib>

// GAITER_MULTIVERSION compiles a function for several instruction sets; the best one is picked when the
// program is loaded.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__GLIBC__) && \
    (__GLIBC__ > 2 || (__GLIBC__ == 2 && __GLIBC_MINOR__ >= 35))
#define GAITER_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#define GAITER_HAS_VERSIONS true
#else
#define GAITER_MULTIVERSION
#define GAITER_HAS_VERSIONS false
#endif

namespace gaiter::base {

// Whether there is more than one version.
inline constexpr bool multiversion = GAITER_HAS_VERSIONS;

}  // namespace gaiter::base
