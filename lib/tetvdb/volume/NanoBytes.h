// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

namespace tetvdb {

/// A NanoVDB grid in memory that this program built, aligned to 64 bytes.
struct NanoBytes {
  std::unique_ptr<unsigned char[], void (*)(unsigned char*)> data;
  std::size_t size = 0;
};

} // namespace tetvdb
