// SPDX-License-Identifier: Apache-2.0
//
// Lets the same source run as a kernel on the device and on the host. Work that threads share is
// written as phases over a team: every member does its share of a loop, all members meet at sync(),
// and memory that the team shares holds the results of a phase for the next one. On the device a
// team is a thread block; on the host it has one member, who does everything.
#pragma once

#include "tetvdb/core/HostDevice.h"

#include <cstdint>

// A lambda that the backends below can run.
#if defined(__CUDACC__)
#define TETVDB_KERNEL [=] __device__
#else
#define TETVDB_KERNEL [=]
#endif

namespace tetvdb::nano {

using u8 = std::uint8_t;
using u16 = std::uint16_t;
using u32 = std::uint32_t;
using u64 = std::uint64_t;
using i32 = std::int32_t;
using i64 = std::int64_t;

/// A warp, or a block.
struct Team {
#if defined(__CUDA_ARCH__)
  __device__ Team(int rank, int size) : rank_(rank), size_(size) {}
  __device__ void sync() const {
    if (size_ == 32)
      __syncwarp();
    else
      __syncthreads();
  }
#else
  TETVDB_HD Team(int rank, int size) : rank_(rank), size_(size) {}
  TETVDB_HD void sync() const {}
#endif
  TETVDB_HD int rank() const {
    return rank_;
  }
  TETVDB_HD int size() const {
    return size_;
  }

private:
  int rank_, size_;
};

// Atomics whose result does not depend on the order: sums, unions, bounds of integers.

/// The type of the same size that CUDA's atomics are declared for.
template <typename T>
struct CudaWord {
  using Type = T;
};
template <>
struct CudaWord<u64> {
  using Type = unsigned long long;
};
template <>
struct CudaWord<i64> {
  using Type = long long;
};
template <typename T>
using CudaWordOf = typename CudaWord<T>::Type;

/// Returns the previous value.
template <typename T>
TETVDB_HD inline T addTo(T* p, T v) {
#if defined(__CUDA_ARCH__)
  return static_cast<T>(
      atomicAdd(reinterpret_cast<CudaWordOf<T>*>(p), static_cast<CudaWordOf<T>>(v)));
#else
  const T old = *p;
  *p += v;
  return old;
#endif
}

template <typename T>
TETVDB_HD inline void orInto(T* p, T v) {
#if defined(__CUDA_ARCH__)
  atomicOr(reinterpret_cast<CudaWordOf<T>*>(p), static_cast<CudaWordOf<T>>(v));
#else
  *p |= v;
#endif
}

template <typename T>
TETVDB_HD inline void minInto(T* p, T v) {
#if defined(__CUDA_ARCH__)
  atomicMin(reinterpret_cast<CudaWordOf<T>*>(p), static_cast<CudaWordOf<T>>(v));
#else
  *p = v < *p ? v : *p;
#endif
}

template <typename T>
TETVDB_HD inline void maxInto(T* p, T v) {
#if defined(__CUDA_ARCH__)
  atomicMax(reinterpret_cast<CudaWordOf<T>*>(p), static_cast<CudaWordOf<T>>(v));
#else
  *p = v > *p ? v : *p;
#endif
}

/// Replaces `expected` by v; returns the previous value.
TETVDB_HD inline u64 exchangeIf(u64* p, u64 expected, u64 v) {
#if defined(__CUDA_ARCH__)
  return atomicCAS(reinterpret_cast<unsigned long long*>(p),
                   static_cast<unsigned long long>(expected), static_cast<unsigned long long>(v));
#else
  const u64 old = *p;
  if (old == expected)
    *p = v;
  return old;
#endif
}

/// Turns n <= 512 numbers that the team shares into the sums of those before each; returns the sum
/// of all. `spare`: as many again. Called by the whole team, which has met before.
TETVDB_HD inline u32 sumsBefore(const Team& team, u32* values, u32* spare, int n) {
#if defined(__CUDA_ARCH__)
  if (n == 32 && team.size() == 32) {
    const u32 own = values[team.rank()];
    u32 sum = own;
    for (int step = 1; step < 32; step *= 2) {
      const u32 before = __shfl_up_sync(~0u, sum, static_cast<unsigned>(step));
      if (team.rank() >= step)
        sum += before;
    }
    values[team.rank()] = sum - own;
    const u32 total = __shfl_sync(~0u, sum, 31);
    team.sync();
    return total;
  }
#endif
  u32 *from = values, *to = spare;
  for (int step = 1; step < n; step *= 2) {
    for (int i = team.rank(); i < n; i += team.size())
      to[i] = from[i] + (i >= step ? from[i - step] : 0);
    team.sync();
    u32* const t = from;
    from = to;
    to = t;
  }
  const u32 total = from[n - 1];
  // From sums up to each to sums before each.
  for (int i = team.rank(); i < n; i += team.size())
    to[i] = i == 0 ? 0 : from[i - 1];
  team.sync();
  if (to != values) {
    for (int i = team.rank(); i < n; i += team.size())
      values[i] = to[i];
    team.sync();
  }
  return total;
}

/// 1 / v, its error at most four times the one of a division.
TETVDB_HD inline float reciprocal(float v) {
#if defined(__CUDA_ARCH__)
  return __fdividef(1.0f, v);
#else
  return 1.0f / v;
#endif
}

/// a b + c, rounded once or twice: for estimates whose error bound allows for both.
TETVDB_HD inline float multiplyAdd(float a, float b, float c) {
#if defined(__CUDA_ARCH__)
  return __fmaf_rn(a, b, c);
#else
  return a * b + c;
#endif
}

/// A float from its bits, and the bits.
TETVDB_HD inline float floatFrom(u32 bits) {
  union {
    u32 bits;
    float number;
  } u{bits};
  return u.number;
}
TETVDB_HD inline u32 bitsOf(float number) {
  union {
    float number;
    u32 bits;
  } u{number};
  return u.bits;
}

TETVDB_HD inline int bitCount(u64 v) {
#if defined(__CUDA_ARCH__)
  return __popcll(static_cast<long long>(v));
#else
  return __builtin_popcountll(v);
#endif
}

/// Position of the lowest, or the highest, set bit of v != 0.
TETVDB_HD inline int lowestBit(u64 v) {
#if defined(__CUDA_ARCH__)
  return __ffsll(static_cast<long long>(v)) - 1;
#else
  return __builtin_ctzll(v);
#endif
}
TETVDB_HD inline int highestBit(u64 v) {
#if defined(__CUDA_ARCH__)
  return 63 - __clzll(static_cast<long long>(v));
#else
  return 63 - __builtin_clzll(v);
#endif
}

/// The largest i with offsets[i] <= value; offsets ascend from offsets[0] <= value, and value <
/// offsets[n].
TETVDB_HD inline u64 ownerOf(const u64* offsets, u64 n, u64 value) {
  u64 low = 0, high = n;
  while (high - low > 1) {
    const u64 mid = low + (high - low) / 2;
    if (offsets[mid] <= value)
      low = mid;
    else
      high = mid;
  }
  return low;
}

} // namespace tetvdb::nano
