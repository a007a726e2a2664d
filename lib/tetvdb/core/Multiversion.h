// SPDX-License-Identifier: Apache-2.0
//
// Hot loops compiled for several instruction sets, chosen when the program starts. The results are
// the same: no fused multiply-add (-ffp-contract=off), no reordering.
#pragma once

// Sanitizers are not set up yet when the choice is made, and clang supports the attribute only
// partly. Without optimization, functions that return vectors are not inlined: those of other
// instruction sets return them in another way.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(TETVDB_SANITIZED) && defined(__OPTIMIZE__)
#define TETVDB_MULTIVERSION __attribute__((target_clones("default", "avx2", "avx512f")))
// For vectors of 256 bits: a compiler that may use registers of 512 bits moves data with them, and
// processors then have one unit less for all others.
#define TETVDB_MULTIVERSION_256 __attribute__((target_clones("default", "avx2")))
#else
#define TETVDB_MULTIVERSION
#define TETVDB_MULTIVERSION_256
#endif

#define TETVDB_INLINE inline __attribute__((always_inline))
