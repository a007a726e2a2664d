// SPDX-License-Identifier: Apache-2.0
#include "CudaCheck.h"
#include "DeviceArray.h"
#include "Team.h"

#include <algorithm>
#include <mutex>

namespace tetvdb::nano {
namespace {

// Memory that no array has, each with what must be done before another one has it.
class KeptMemory {
public:
  // Null where there is none of this size.
  void* take(int device, u64 bytes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (auto block = blocks_.begin(); block != blocks_.end(); ++block) {
      if (block->device != device || block->bytes != bytes || !isDone(*block))
        continue;
      void* data = block->data;
      for (cudaEvent_t event : block->readers)
        cudaEventDestroy(event);
      kept_ -= bytes;
      blocks_.erase(block);
      return data;
    }
    return nullptr;
  }

  // Takes the memory over, or frees it.
  void keep(int device, u64 bytes, void* data, const std::vector<u64>& streams) {
    Block block{device, bytes, data, {}};
    bool known = true;
    for (const u64 stream : streams) {
      cudaEvent_t event = nullptr;
      known = known && cudaEventCreateWithFlags(&event, cudaEventDisableTiming) == cudaSuccess;
      if (event != nullptr)
        block.readers.push_back(event);
      known =
          known && cudaEventRecord(event, reinterpret_cast<cudaStream_t>(stream)) == cudaSuccess;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    if (known && kept_ + bytes <= kMax) {
      kept_ += bytes;
      blocks_.push_back(std::move(block));
      return;
    }
    cudaGetLastError();
    cudaFree(data); // waits for the device
    for (cudaEvent_t event : block.readers)
      cudaEventDestroy(event);
  }

private:
  static constexpr u64 kMax = u64(1) << 30;
  struct Block {
    int device;
    u64 bytes;
    void* data;
    std::vector<cudaEvent_t> readers;
  };

  static bool isDone(const Block& block) {
    return std::all_of(block.readers.begin(), block.readers.end(),
                       [](cudaEvent_t event) { return cudaEventQuery(event) == cudaSuccess; });
  }

  std::mutex mutex_;
  std::vector<Block> blocks_;
  u64 kept_ = 0;
};

// Never destroyed: CUDA ends before static objects do.
KeptMemory& keptMemory() {
  static auto& memory = *new KeptMemory;
  return memory;
}

__global__ void unpackKernel(u8* to, const u8* packed, u64 count) {
  const u64 i = u64(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < count)
    to[i] = packed[i / 8] >> (7 - i % 8) & 1;
}

void awaitCopies() {
  check(cudaStreamSynchronize(cudaStreamPerThread), "copy");
}

} // namespace

DeviceArray::DeviceArray(int device, std::uint64_t bytes) : device_(device), bytes_(bytes) {
  check(cudaSetDevice(device), "device");
  data_ = keptMemory().take(device, bytes);
  if (data_ == nullptr)
    check(cudaMalloc(&data_, std::max<u64>(bytes, 1)), "out of memory");
}

DeviceArray::~DeviceArray() {
  cudaSetDevice(device_);
  keptMemory().keep(device_, bytes_, data_, readers_);
}

void DeviceArray::readBy(std::uint64_t stream) {
  if (std::find(readers_.begin(), readers_.end(), stream) == readers_.end())
    readers_.push_back(stream);
}

void DeviceArray::checkRange(std::uint64_t at, std::uint64_t bytes) const {
  if (at > bytes_ || bytes > bytes_ - at)
    throw Error(Status::Usage, "", "beyond the end of an array of the device");
  check(cudaSetDevice(device_), "device");
}

void DeviceArray::setBits(std::uint64_t at, const char* packed, std::uint64_t count) {
  checkRange(at, count);
  if (count == 0)
    return;
  const u64 bytes = (count + 7) / 8;
  DeviceArray bits(device_, bytes);
  bits.set(0, packed, bytes);
  unpackKernel<<<static_cast<unsigned>((count + 255) / 256), 256, 0, cudaStreamPerThread>>>(
      static_cast<u8*>(data_) + at, static_cast<const u8*>(bits.data()), count);
  check(cudaGetLastError(), "launch");
  awaitCopies();
}

void DeviceArray::set(std::uint64_t at, const void* from, std::uint64_t bytes) {
  checkRange(at, bytes);
  check(cudaMemcpyAsync(static_cast<u8*>(data_) + at, from, bytes, cudaMemcpyHostToDevice,
                        cudaStreamPerThread),
        "upload");
  awaitCopies();
}

void DeviceArray::set(std::uint64_t at, const DeviceArray& from) {
  checkRange(at, from.bytes());
  check(cudaMemcpyPeerAsync(static_cast<u8*>(data_) + at, device_, from.data(), from.device(),
                            from.bytes(), cudaStreamPerThread),
        "copy");
  awaitCopies();
}

void DeviceArray::download(void* to) const {
  checkRange(0, bytes_);
  check(cudaMemcpyAsync(to, data_, bytes_, cudaMemcpyDeviceToHost, cudaStreamPerThread),
        "download");
  awaitCopies();
}

} // namespace tetvdb::nano
