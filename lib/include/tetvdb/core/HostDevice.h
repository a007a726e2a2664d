// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks a function that CUDA compiles for the device as well; nothing for other compilers.
#if defined(__CUDACC__)
#define TETVDB_HD __host__ __device__
#else
#define TETVDB_HD
#endif

/// Keeps what is rarely needed, and large, out of its callers' registers.
#if defined(__CUDACC__)
#define TETVDB_APART __noinline__
#else
#define TETVDB_APART __attribute__((noinline))
#endif
