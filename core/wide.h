// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <climits>  // which C library it is

/// Before a function whose loops the compiler turns into vector instructions: it is built for processors with AVX2 too, and the program
/// takes what its processor can do. Both give the same numbers, as products are not fused with sums (-ffp-contract=off).
/// Not with sanitizers: the choice is made before they are ready.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SWATH_WIDE [[gnu::target_clones("avx2", "default")]]
#else
#define SWATH_WIDE
#endif

/// Defined where a unit may hold a function of its own for processors with AVX2 and choose it at run time.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define SWATH_HAS_WIDE
#endif
