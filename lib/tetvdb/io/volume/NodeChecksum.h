// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>
#include <zlib.h>

namespace tetvdb {

/// NanoVDB's checksums, of which the tail's is that of the checksums of all nodes, each a number of
/// 64 bits.
class NodeChecksum {
public:
  static std::uint64_t of(const void* data, std::size_t size) {
    return ::crc32_z(0, static_cast<const Bytef*>(data), size);
  }
  void add(const std::vector<std::uint64_t>& sums) {
    if (sums.empty())
      return; // zlib begins anew where there are no bytes
    const std::size_t bytes = sums.size() * sizeof sums[0];
    sum_ = ::crc32_z(sum_, reinterpret_cast<const Bytef*>(sums.data()), bytes);
    size_ += bytes;
  }
  /// Of nodes behind these.
  void append(const NodeChecksum& o) {
    sum_ = ::crc32_combine(sum_, o.sum_, static_cast<z_off_t>(o.size_));
    size_ += o.size_;
  }
  std::uint64_t value() const { return sum_; }

private:
  uLong sum_ = 0;
  std::uint64_t size_ = 0;
};

} // namespace tetvdb
