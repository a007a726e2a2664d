// SPDX-License-Identifier: Apache-2.0
//
// Runs the kernels' source on a CUDA device: memory from a pool, one stream, CUB for sorting and
// scanning. For .cu files.
#pragma once

#include "Team.h"
#include "tetvdb/core/Error.h"

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <cuda/functional>
#include <cuda_runtime.h>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb::nano {

inline void check(cudaError_t status, const char* what) {
  if (status == cudaSuccess)
    return;
  cudaGetLastError(); // so that it does not show up again
  const std::string text = std::string(what) + ": " + cudaGetErrorString(status);
  if (status == cudaErrorMemoryAllocation)
    throw Error(Status::Limit, "device", text, "use larger voxels or --device cpu");
  throw Error(Status::Device, "device", text, "use --device cpu");
}

/// Device memory that is handed out from large blocks and taken back all at once; blocks are kept.
class DevicePool {
public:
  DevicePool() = default;
  ~DevicePool() {
    for (const Block& block : blocks_)
      cudaFree(block.base);
  }
  DevicePool(const DevicePool&) = delete;
  DevicePool& operator=(const DevicePool&) = delete;

  void* take(u64 bytes) {
    bytes = (bytes + kAlign - 1) / kAlign * kAlign;
    for (Block& block : blocks_)
      if (block.size - block.used >= bytes) {
        void* p = block.base + block.used;
        block.used += bytes;
        return p;
      }
    // A quarter more than there is, so that blocks stay few; where that is too much, what is
    // needed.
    u64 size = bytes > kLeast ? bytes : kLeast;
    if (size < held_ / 4)
      size = held_ / 4;
    unsigned char* base = nullptr;
    ++calls_;
    if (cudaMalloc(reinterpret_cast<void**>(&base), size) != cudaSuccess) {
      cudaGetLastError();
      size = bytes;
      ++calls_;
      check(cudaMalloc(reinterpret_cast<void**>(&base), size), "out of memory");
    }
    held_ += size;
    blocks_.push_back({base, size, bytes});
    return base;
  }
  void takeBack() {
    for (Block& block : blocks_)
      block.used = 0;
  }
  u64 calls() const { return calls_; }
  u64 held() const { return held_; }

private:
  static constexpr u64 kAlign = 256, kLeast = u64(64) << 20;
  struct Block {
    unsigned char* base;
    u64 size, used;
  };
  std::vector<Block> blocks_;
  u64 calls_ = 0, held_ = 0;
};

template <typename F>
__global__ void __launch_bounds__(256) forEachKernel(u64 n, F f) {
  const u64 i = u64(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < n)
    f(i);
}

template <typename Shared, typename F>
__global__ void __launch_bounds__(256) forTeamsKernel(u64 n, F f) {
  __shared__ Shared shared;
  for (u64 i = blockIdx.x; i < n; i += gridDim.x)
    f(Team(), i, shared);
}

class CudaBackend {
public:
  CudaBackend() {
    check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "no stream");
    check(cudaHostAlloc(reinterpret_cast<void**>(&pinned_), 256, cudaHostAllocDefault),
          "no pinned memory");
  }
  ~CudaBackend() {
    for (const Stage& s : stages_)
      cudaEventDestroy(s.begin);
    cudaFreeHost(pinned_);
    cudaStreamDestroy(stream_);
  }
  CudaBackend(const CudaBackend&) = delete;
  CudaBackend& operator=(const CudaBackend&) = delete;

  cudaStream_t stream() const { return stream_; }
  DevicePool& pool() { return pool_; }

  /// From here on time counts for `name`; "" ends the last.
  void stage(const char* name) {
    if (used_ == stages_.size()) {
      stages_.push_back({});
      check(cudaEventCreate(&stages_.back().begin), "event");
    }
    stages_[used_].name = name;
    check(cudaEventRecord(stages_[used_].begin, stream_), "event");
    ++used_;
  }
  void clearStages() { used_ = 0; }
  /// Of the stages since they were cleared; the stream must be done.
  std::vector<std::pair<std::string, double>> stageSeconds() const {
    std::vector<std::pair<std::string, double>> result;
    for (std::size_t i = 0; i + 1 < used_; ++i) {
      float ms = 0;
      check(cudaEventElapsedTime(&ms, stages_[i].begin, stages_[i + 1].begin), "event");
      result.emplace_back(stages_[i].name, ms * 1e-3);
    }
    return result;
  }

  template <typename T>
  T* alloc(u64 n) {
    return static_cast<T*>(pool_.take((n == 0 ? 1 : n) * sizeof(T)));
  }
  u8* output(u64 bytes) { return alloc<u8>(bytes); }
  void zero(void* p, u64 bytes) { fill(p, 0, bytes); }
  void fill(void* p, int byte, u64 bytes) {
    if (bytes != 0)
      check(cudaMemsetAsync(p, byte, bytes, stream_), "memset");
  }
  template <typename T>
  T read(const T* p) {
    static_assert(sizeof(T) <= 256, "fits the pinned place");
    check(cudaMemcpyAsync(pinned_, p, sizeof(T), cudaMemcpyDeviceToHost, stream_), "copy");
    check(cudaStreamSynchronize(stream_), "a kernel failed");
    return *static_cast<T*>(pinned_);
  }

  template <typename F>
  void forEach(u64 n, const F& f) {
    if (n == 0)
      return;
    const u64 blocks = (n + 255) / 256;
    if (blocks > 0x7FFFFFFFull)
      throw Error(Status::Limit, "device", "too much work for one launch", "use larger voxels");
    forEachKernel<<<static_cast<unsigned>(blocks), 256, 0, stream_>>>(n, f);
    check(cudaGetLastError(), "launch");
  }
  template <typename Shared, typename F>
  void forTeams(u64 n, int size, const F& f) {
    if (n == 0)
      return;
    const u64 blocks = n < 0x7FFFFFFFull ? n : 0x7FFFFFFFull;
    forTeamsKernel<Shared, F>
        <<<static_cast<unsigned>(blocks), static_cast<unsigned>(size), 0, stream_>>>(n, f);
    check(cudaGetLastError(), "launch");
  }
  void scan(const u32* counts, u64* offsets, u64 n) {
    std::size_t bytes = 0;
    const auto call = [&](void* temporary) {
      check(cub::DeviceScan::ExclusiveScan(temporary, bytes, counts, offsets,
                                           ::cuda::std::plus<u64>(), u64(0), n + 1, stream_),
            "scan");
    };
    call(nullptr);
    call(pool_.take(bytes));
  }
  void sort(u64*& keys, u32*& values, u64 n, int bits) {
    if (n < 2)
      return;
    cub::DoubleBuffer<u64> k(keys, alloc<u64>(n));
    cub::DoubleBuffer<u32> v(values, alloc<u32>(n));
    std::size_t bytes = 0;
    const auto call = [&](void* temporary) {
      check(cub::DeviceRadixSort::SortPairs(temporary, bytes, k, v, n, 0, bits, stream_), "sort");
    };
    call(nullptr);
    call(pool_.take(bytes));
    keys = k.Current();
    values = v.Current();
  }

private:
  struct Stage {
    const char* name = "";
    cudaEvent_t begin = nullptr;
  };
  std::vector<Stage> stages_;
  std::size_t used_ = 0;
  cudaStream_t stream_ = nullptr;
  void* pinned_ = nullptr;
  DevicePool pool_;
};

} // namespace tetvdb::nano
