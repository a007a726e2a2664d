// SPDX-License-Identifier: Apache-2.0
//
// Runs the kernels' source on a CUDA device: memory from a pool, one stream, CUB for sorting and
// scanning. For .cu files.
#pragma once

#include "CudaCheck.h"
#include "Team.h"
#include "tetvdb/core/Progress.h"

#include <atomic>
#include <cstring>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <cuda/functional>
#include <cuda_runtime.h>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace tetvdb::nano {

inline std::string gigabytes(u64 bytes) {
  const u64 tenths = (bytes + 50000000) / 100000000;
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " GB";
}

inline bool isPinned(const void* p) {
  cudaPointerAttributes attributes{};
  if (cudaPointerGetAttributes(&attributes, p) != cudaSuccess) {
    cudaGetLastError();
    return false;
  }
  return attributes.type == cudaMemoryTypeHost;
}

/// Device memory that is handed out from large blocks and taken back all at once; blocks are kept.
class DevicePool {
public:
  DevicePool() = default;
  ~DevicePool() {
    takeBack();
    giveUpUnused();
  }
  DevicePool(const DevicePool&) = delete;
  DevicePool& operator=(const DevicePool&) = delete;

  /// `spare`: gives up blocks, too, before memory is out.
  void* take(u64 bytes, DevicePool* spare) {
    bytes = (bytes + kAlign - 1) / kAlign * kAlign;
    Block* best = nullptr; // the fullest that has room, so that large ones stay whole
    for (Block& block : blocks_)
      if (block.size - block.used >= bytes &&
          (best == nullptr || block.size - block.used < best->size - best->used))
        best = &block;
    if (best != nullptr) {
      void* p = best->base + best->used;
      best->used += bytes;
      return p;
    }
    // A quarter of what there is, so that blocks stay few, but no more than a gigabyte to spare.
    u64 size = bytes > kMin ? bytes : kMin;
    const u64 quarter = held_ / 4 < kSpare ? held_ / 4 : kSpare;
    if (size < quarter)
      size = quarter;
    unsigned char* base = nullptr;
    ++calls_;
    if (cudaMalloc(reinterpret_cast<void**>(&base), size) != cudaSuccess) {
      cudaGetLastError();
      // Blocks that nobody uses, too small or another's; freeing waits for the device.
      giveUpUnused();
      if (spare != nullptr)
        spare->giveUpUnused();
      size = bytes;
      ++calls_;
      const cudaError_t status = cudaMalloc(reinterpret_cast<void**>(&base), size);
      if (status == cudaErrorMemoryAllocation) {
        std::size_t free = 0, total = 0;
        cudaMemGetInfo(&free, &total);
        check(status, ("the GPU's memory is too small: " + gigabytes(size) + " more needed, " +
                       gigabytes(free) + " of " + gigabytes(total) + " free")
                          .c_str());
      }
      check(status, "no memory");
    }
    held_ += size;
    blocks_.push_back({base, size, bytes});
    return base;
  }
  void takeBack() {
    for (Block& block : blocks_)
      block.used = 0;
  }
  void giveUpUnused() {
    std::vector<Block> rest;
    for (const Block& block : blocks_) {
      if (block.used != 0) {
        rest.push_back(block);
        continue;
      }
      cudaFree(block.base);
      held_ -= block.size;
    }
    blocks_.swap(rest);
  }
  u64 calls() const { return calls_; }
  u64 held() const { return held_; }
  u64 unused() const {
    u64 sum = 0;
    for (const Block& block : blocks_)
      sum += block.size - block.used;
    return sum;
  }

private:
  static constexpr u64 kAlign = 256, kMin = u64(128) << 20, kSpare = u64(1) << 30;
  struct Block {
    unsigned char* base;
    u64 size, used;
  };
  std::vector<Block> blocks_;
  u64 calls_ = 0, held_ = 0;
};

template <typename F>
__global__ void __launch_bounds__(256, 3) forEachKernel(u64 n, F f) {
  const u64 i = u64(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < n)
    f(i);
}

// What teams share says how large they get (kThreads) and how many warps a multiprocessor should
// hold at least (kOccupancy): waiting is hidden by other warps, at the price of registers.
//
// Teams of a warp go four to a block, so that blocks do not run out before warps do.
constexpr int kWarpTeams = 4;

template <typename Shared, typename F>
__global__ void __launch_bounds__(32 * kWarpTeams, Shared::kOccupancy / kWarpTeams)
    forWarpsKernel(u64 n, F f) {
  __shared__ Shared shared[kWarpTeams];
  const int team = static_cast<int>(threadIdx.x) / 32;
  for (u64 i = u64(blockIdx.x) * kWarpTeams + team; i < n; i += u64(gridDim.x) * kWarpTeams)
    f(Team(static_cast<int>(threadIdx.x) % 32, 32), i, shared[team]);
}

template <typename Shared, typename F>
__global__ void __launch_bounds__(Shared::kThreads, Shared::kOccupancy * 32 / Shared::kThreads)
    forTeamsKernel(u64 n, F f) {
  __shared__ Shared shared;
  for (u64 i = blockIdx.x; i < n; i += gridDim.x)
    f(Team(static_cast<int>(threadIdx.x), static_cast<int>(blockDim.x)), i, shared);
}

// A few words from the device's memory to the host's, then a number by which the host sees that
// they are there; sooner done than a copy and a wait for the stream.
__global__ void publishKernel(const u32* from, u32 words, u32* to, u32* flag, u32 number) {
  for (u32 w = threadIdx.x; w < words; w += blockDim.x)
    to[w] = from[w];
  __threadfence_system();
  __syncwarp();
  if (threadIdx.x == 0)
    *static_cast<volatile u32*>(flag) = number;
}

class CudaBackend {
public:
  CudaBackend() {
    for (cudaStream_t* stream : {&stream_, &down_})
      check(cudaStreamCreateWithFlags(stream, cudaStreamNonBlocking), "no stream");
    check(
        cudaHostAlloc(reinterpret_cast<void**>(&pinned_), sizeof(Published), cudaHostAllocDefault),
        "no pinned memory");
    pinned_->number = 0;
    for (cudaEvent_t* e : {&pointsHere_, &fieldsHere_, &made_})
      check(cudaEventCreateWithFlags(e, cudaEventDisableTiming), "event");
    for (cudaEvent_t& e : cellsHere_)
      check(cudaEventCreateWithFlags(&e, cudaEventDisableTiming), "event");
  }
  ~CudaBackend() {
    for (const Stage& s : stages_)
      cudaEventDestroy(s.begin);
    cudaEventDestroy(pointsHere_);
    cudaEventDestroy(fieldsHere_);
    cudaEventDestroy(made_);
    for (cudaEvent_t e : cellsHere_)
      cudaEventDestroy(e);
    cudaFreeHost(pinned_);
    cudaFreeHost(staging_);
    for (cudaEvent_t e : halfHere_)
      if (e != nullptr)
        cudaEventDestroy(e);
    for (const Landing& landing : landings_) {
      cudaFreeHost(landing.base);
      if (landing.done != nullptr)
        cudaEventDestroy(landing.done);
    }
    cudaStreamDestroy(stream_);
    cudaStreamDestroy(down_);
  }
  CudaBackend(const CudaBackend&) = delete;
  CudaBackend& operator=(const CudaBackend&) = delete;

  cudaStream_t stream() const { return stream_; }

  /// The mesh arrives by another stream: its points first, then its cells in parts.
  static constexpr int kParts = 8;
  int parts() const { return arriving_ == 0 ? 1 : arriving_; }
  void awaitPoints() {
    if (arriving_ != 0)
      check(cudaStreamWaitEvent(stream_, pointsHere_, 0), "upload");
  }
  void awaitCells(int part) {
    if (arriving_ != 0)
      check(cudaStreamWaitEvent(stream_, cellsHere_[part], 0), "upload");
  }
  /// What comes after the mesh.
  void awaitFields() { check(cudaStreamWaitEvent(stream_, fieldsHere_, 0), "upload"); }
  void recordFields(cudaStream_t upload) { check(cudaEventRecord(fieldsHere_, upload), "upload"); }
  void recordPoints(cudaStream_t upload) { check(cudaEventRecord(pointsHere_, upload), "upload"); }
  void recordCells(int part, cudaStream_t upload) {
    check(cudaEventRecord(cellsHere_[part], upload), "upload");
  }
  /// 0: the mesh is there.
  void setArriving(int parts) { arriving_ = parts; }

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
    return static_cast<T*>(pool_.take((n == 0 ? 1 : n) * sizeof(T), &temporaries_));
  }
  /// Memory until dropTemporaries(): the stream's order keeps earlier kernels out of later ones'.
  template <typename T>
  T* temp(u64 n) {
    return static_cast<T*>(temporaries_.take((n == 0 ? 1 : n) * sizeof(T), &pool_));
  }
  void dropTemporaries() { temporaries_.takeBack(); }
  /// Throws Error(Limit) where so much more memory is surely not there, before work is done for it.
  void require(u64 bytes) {
    constexpr u64 kMuch = u64(1) << 30; // asking for what is free takes time
    if (bytes < kMuch)
      return;
    std::size_t free = 0, total = 0;
    check(cudaMemGetInfo(&free, &total), "no memory");
    const u64 have = free + pool_.unused() + temporaries_.unused();
    if (bytes > have)
      throw Error(Status::Limit, "device",
                  "the GPU's memory is too small: at least " + gigabytes(bytes) + " more needed, " +
                      gigabytes(have) + " of " + gigabytes(total) + " free",
                  "use larger voxels or `device=cpu`");
  }
  void release() {
    pool_.takeBack();
    temporaries_.takeBack();
  }
  u64 allocations() const { return pool_.calls() + temporaries_.calls(); }
  u64 held() const { return pool_.held() + temporaries_.held(); }
  u8* output(u64 bytes) { return alloc<u8>(bytes); }
  void zero(void* p, u64 bytes) { fill(p, 0, bytes); }
  void fill(void* p, int byte, u64 bytes) {
    if (bytes != 0)
      check(cudaMemsetAsync(p, byte, bytes, stream_), "memset");
  }
  /// Waits for the value.
  template <typename T>
  T read(const T* p) {
    static_assert(sizeof(T) <= sizeof pinned_->words && sizeof(T) % 4 == 0,
                  "fits the pinned place");
    publishKernel<<<1, 32, 0, stream_>>>(reinterpret_cast<const u32*>(p), sizeof(T) / 4,
                                         pinned_->words, &pinned_->number, ++number_);
    check(cudaGetLastError(), "launch");
    const volatile u32& number = pinned_->number;
    for (u32 looks = 1; number != number_; ++looks)
      if (looks % 1024 == 0)
        lookAfter();
    std::atomic_thread_fence(std::memory_order_acquire);
    T value;
    std::memcpy(&value, pinned_->words, sizeof(T));
    return value;
  }
  template <typename T>
  void download(T* to, const T* from, u64 n) {
    fetch(to, from, n * sizeof(T));
    await();
  }
  /// To the host. Done when the stream is, or sooner: much, to memory that is not pinned, goes by
  /// way of pinned halves, for pinning takes as long as the rest and cannot be stopped.
  void fetch(void* to, const void* from, u64 bytes) {
    constexpr u64 kHalf = u64(16) << 20;
    if (bytes <= 2 * kHalf || isPinned(to)) {
      check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, stream_), "download");
      return;
    }
    if (staging_ == nullptr) {
      check(cudaHostAlloc(reinterpret_cast<void**>(&staging_), 2 * kHalf, cudaHostAllocDefault),
            "out of pinned memory");
      for (cudaEvent_t& e : halfHere_)
        check(cudaEventCreateWithFlags(&e, cudaEventDisableTiming), "event");
    }
    const auto* source = static_cast<const unsigned char*>(from);
    auto* target = static_cast<unsigned char*>(to);
    const u64 chunks = (bytes + kHalf - 1) / kHalf;
    const auto sizeOf = [&](u64 c) { return c + 1 < chunks ? kHalf : bytes - c * kHalf; };
    // Chunk c arrives while the one before is taken from the other half.
    for (u64 c = 0; c <= chunks; ++c) {
      if (c < chunks) {
        check(cudaMemcpyAsync(staging_ + c % 2 * kHalf, source + c * kHalf, sizeOf(c),
                              cudaMemcpyDeviceToHost, stream_),
              "download");
        check(cudaEventRecord(halfHere_[c % 2], stream_), "download");
      }
      if (c == 0)
        continue;
      awaitEvent(halfHere_[(c - 1) % 2]);
      copyByThreads(target + (c - 1) * kHalf, staging_ + (c - 1) % 2 * kHalf, sizeOf(c - 1));
    }
  }
  void upload(void* to, const void* from, u64 bytes) {
    if (bytes != 0)
      check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream_), "upload");
  }
  /// Sends bytes to the host, by one of two ways; landed() waits for the last of that way. What is
  /// launched next does not wait for the copy, and must leave `from` as it is until that has
  /// landed.
  void land(int way, const u8* from, u64 bytes) {
    Landing& landing = landings_[way];
    if (landing.done == nullptr)
      check(cudaEventCreateWithFlags(&landing.done, cudaEventDisableTiming), "event");
    if (bytes > landing.size) {
      cudaFreeHost(landing.base);
      landing.base = nullptr;
      landing.size = 0;
      u64 size = u64(1) << 20;
      while (size < bytes) // so that batches of about a size do not make it grow again and again
        size *= 2;
      check(cudaHostAlloc(reinterpret_cast<void**>(&landing.base), size, cudaHostAllocDefault),
            "out of pinned memory");
      landing.size = size;
    }
    check(cudaEventRecord(made_, stream_), "download");
    check(cudaStreamWaitEvent(down_, made_, 0), "download");
    check(cudaMemcpyAsync(landing.base, from, bytes, cudaMemcpyDeviceToHost, down_), "download");
    check(cudaEventRecord(landing.done, down_), "download");
  }
  const u8* landed(int way) {
    awaitEvent(landings_[way].done);
    return landings_[way].base;
  }
  /// Waits for all that was launched.
  void await() {
    while (true) {
      const cudaError_t status = cudaStreamQuery(stream_);
      if (status == cudaSuccess)
        return;
      if (status != cudaErrorNotReady)
        check(status, "a kernel failed");
      if (progress_ != nullptr)
        progress_->check();
    }
  }
  /// Waits for everything, failed or not.
  void settle() {
    cudaStreamSynchronize(stream_);
    cudaStreamSynchronize(down_);
  }
  /// Waiting ends with Error(Cancelled) where this says so; null: never.
  void setProgress(const Progress* progress) { progress_ = progress; }

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
    constexpr u64 kMax = 0x7FFFFFFF;
    // What is too large for four of them shares nothing between warps.
    if constexpr (kWarpTeams * sizeof(Shared) <= 48 * 1024)
      if (size == 32) {
        const u64 blocks = (n + kWarpTeams - 1) / kWarpTeams;
        forWarpsKernel<Shared, F>
            <<<static_cast<unsigned>(blocks < kMax ? blocks : kMax), 32 * kWarpTeams, 0, stream_>>>(
                n, f);
        check(cudaGetLastError(), "launch");
        return;
      }
    forTeamsKernel<Shared, F>
        <<<static_cast<unsigned>(n < kMax ? n : kMax), static_cast<unsigned>(size), 0, stream_>>>(
            n, f);
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
    call(temporaries_.take(bytes, &pool_));
  }
  void sort(u64* keys, u32* values, u64 n, int bits) {
    if (n < 2)
      return;
    cub::DoubleBuffer<u64> k(keys, temp<u64>(n));
    cub::DoubleBuffer<u32> v(values, temp<u32>(n));
    std::size_t bytes = 0;
    const auto call = [&](void* temporary) {
      check(cub::DeviceRadixSort::SortPairs(temporary, bytes, k, v, n, 0, bits, stream_), "sort");
    };
    call(nullptr);
    call(temporaries_.take(bytes, &pool_));
    if (k.Current() != keys)
      check(cudaMemcpyAsync(keys, k.Current(), n * sizeof(u64), cudaMemcpyDeviceToDevice, stream_),
            "sort");
    if (v.Current() != values)
      check(
          cudaMemcpyAsync(values, v.Current(), n * sizeof(u32), cudaMemcpyDeviceToDevice, stream_),
          "sort");
  }

private:
  void awaitEvent(cudaEvent_t event) {
    while (true) {
      const cudaError_t status = cudaEventQuery(event);
      if (status != cudaErrorNotReady)
        check(status, "a kernel failed");
      if (progress_ != nullptr)
        progress_->check();
      if (status == cudaSuccess)
        return;
    }
  }

  // One thread's page faults would be slower than the bus.
  static void copyByThreads(unsigned char* to, const unsigned char* from, u64 bytes) {
    constexpr u64 kThreads = 4;
    std::vector<std::thread> threads;
    for (u64 k = 0; k < kThreads; ++k) {
      const u64 begin = bytes * k / kThreads, end = bytes * (k + 1) / kThreads;
      threads.emplace_back([=] { std::memcpy(to + begin, from + begin, end - begin); });
    }
    for (std::thread& t : threads)
      t.join();
  }

  // While waiting: whether the device has failed, or the job is cancelled.
  void lookAfter() {
    const cudaError_t status = cudaStreamQuery(stream_);
    if (status != cudaSuccess && status != cudaErrorNotReady)
      check(status, "a kernel failed");
    if (progress_ != nullptr)
      progress_->check();
  }

  struct Published {
    u32 words[64];
    u32 number;
  };
  struct Landing {
    unsigned char* base = nullptr;
    u64 size = 0;
    cudaEvent_t done = nullptr;
  };
  struct Stage {
    const char* name = "";
    cudaEvent_t begin = nullptr;
  };
  int arriving_ = 0;           // parts
  cudaEvent_t made_ = nullptr; // what lands next
  cudaEvent_t pointsHere_ = nullptr, fieldsHere_ = nullptr, cellsHere_[kParts] = {};
  std::vector<Stage> stages_;
  std::size_t used_ = 0;
  cudaStream_t stream_ = nullptr, down_ = nullptr;
  Published* pinned_ = nullptr;
  unsigned char* staging_ = nullptr; // for downloads
  cudaEvent_t halfHere_[2] = {};
  Landing landings_[2];
  u32 number_ = 0;
  const Progress* progress_ = nullptr;
  DevicePool pool_, temporaries_;
};

} // namespace tetvdb::nano
