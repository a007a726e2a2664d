// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks a function that CUDA compiles for the device as well; nothing for other compilers.
#if defined(__CUDACC__)
#define TETVDB_HD __host__ __device__
#else
#define TETVDB_HD
#endif
