// SPDX-License-Identifier: Apache-2.0
//
// Memory of the host that is kept from run to run. For .cu files.
#pragma once

#include "CudaCheck.h"
#include "Team.h"
#include "tetvdb/core/Error.h"

#include <cstdlib>
#include <cuda_runtime.h>
#include <sys/mman.h>

namespace tetvdb::nano {

/// Pinned host memory that only grows.
class PinnedMemory {
public:
  PinnedMemory() = default;
  ~PinnedMemory() { cudaFreeHost(base_); }
  PinnedMemory(const PinnedMemory&) = delete;
  PinnedMemory& operator=(const PinnedMemory&) = delete;

  unsigned char* atLeast(u64 bytes) {
    if (bytes > size_) {
      cudaFreeHost(base_);
      base_ = nullptr;
      size_ = 0;
      ++calls_;
      // More than asked for, so that models of about one size do not make it grow again and again.
      const u64 size = bytes < (u64(64) << 20) ? 2 * bytes + (u64(1) << 20) : bytes + bytes / 8;
      check(cudaHostAlloc(reinterpret_cast<void**>(&base_), size, cudaHostAllocDefault),
            "out of pinned memory");
      size_ = size;
    }
    return base_;
  }
  u64 calls() const { return calls_; }

private:
  unsigned char* base_ = nullptr;
  u64 size_ = 0, calls_ = 0;
};

/// Place for grids on the host. Pinning a page takes as long as copying it some ten times, so that
/// a large grid gets pinned memory only if it is not the first, and none if it is very large.
class GridMemory {
public:
  GridMemory() = default;
  ~GridMemory() { std::free(base_); }
  GridMemory(const GridMemory&) = delete;
  GridMemory& operator=(const GridMemory&) = delete;

  unsigned char* atLeast(u64 bytes) {
    constexpr u64 kLarge = u64(32) << 20, kMaxPinned = u64(256) << 20, kPage = u64(2) << 20;
    const bool first = bytes > kLarge && !hadLarge_;
    hadLarge_ = hadLarge_ || bytes > kLarge;
    if (bytes <= kMaxPinned && !first)
      return pinned_.atLeast(bytes);
    if (bytes > size_) {
      std::free(base_);
      size_ = 0;
      ++calls_;
      const u64 size = (bytes + kPage - 1) / kPage * kPage;
      base_ = static_cast<unsigned char*>(std::aligned_alloc(kPage, size));
      if (base_ == nullptr)
        throw Error(Status::Limit, "", "the grid does not fit in memory", "use larger voxels");
      madvise(base_, size, MADV_HUGEPAGE); // a wish
      size_ = size;
    }
    return base_;
  }
  u64 calls() const { return pinned_.calls() + calls_; }

private:
  PinnedMemory pinned_;
  unsigned char* base_ = nullptr;
  u64 size_ = 0, calls_ = 0;
  bool hadLarge_ = false;
};

} // namespace tetvdb::nano
