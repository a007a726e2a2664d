// SPDX-License-Identifier: Apache-2.0
//
// Memory of a device that other programs of the process read, as DLPack hands it out. No type of
// CUDA is in here.
#pragma once

#include <cstdint>
#include <vector>

namespace tetvdb::nano {

/// Bytes in a device's memory. Memory is kept when an array is destroyed, up to 1 GiB a device, and
/// given to a later array of the same size once the streams that read it are done. Not for use by
/// several threads at once; different arrays are independent.
class DeviceArray {
public:
  /// Undefined bytes. Throws Error(Device), Error(Limit).
  DeviceArray(int device, std::uint64_t bytes);
  ~DeviceArray();
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;

  void* data() const { return data_; }
  std::uint64_t bytes() const { return bytes_; }
  int device() const { return device_; }

  /// Says that `stream` (a cudaStream_t as a number; 1: the legacy default stream, 2: the thread's)
  /// reads the bytes: they are not given to another array before it is done. The bytes themselves
  /// are there already.
  void readBy(std::uint64_t stream);

  // The following return when the bytes are there. Throw Error(Device).

  /// Bytes from `at` on: 0 or 1, of `count` booleans as numpy.packbits() has them, in host memory.
  void setBits(std::uint64_t at, const char* packed, std::uint64_t count);
  void set(std::uint64_t at, const void* from, std::uint64_t bytes);
  /// `from` may be an array of another device.
  void set(std::uint64_t at, const DeviceArray& from);
  void download(void* to) const;

private:
  void checkRange(std::uint64_t at, std::uint64_t bytes) const;

  int device_;
  std::uint64_t bytes_;
  void* data_ = nullptr;
  std::vector<std::uint64_t> readers_;
};

} // namespace tetvdb::nano
