// SPDX-License-Identifier: Apache-2.0
//
// Hot loops compiled for several instruction sets, chosen when the program starts. The results are
// the same: no fused multiply-add (-ffp-contract=off), no reordering.
#pragma once

// Sanitizers are not set up yet when the choice is made, and clang supports the attribute only
// partly.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(TETVDB_SANITIZED)
#define TETVDB_MULTIVERSION __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define TETVDB_MULTIVERSION
#endif

#define TETVDB_INLINE inline __attribute__((always_inline))
