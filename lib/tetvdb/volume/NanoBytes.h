// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace tetvdb {

/// A NanoVDB grid in memory that this program built, aligned to 64 bytes. It may lie in memory of
/// the device that made it, which `data` then keeps from other jobs.
struct NanoBytes {
  std::shared_ptr<const unsigned char> data;
  std::size_t size = 0;
  std::uint64_t insideVoxels = 0; ///< of a level set
};

} // namespace tetvdb
