// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tetvdb {

/// The lowest bytes of a number, lowest first.
inline std::string littleEndianBytes(std::uint64_t number, std::size_t bytes) {
  std::string text;
  for (; bytes > 0; --bytes, number >>= 8)
    text += static_cast<char>(number & 0xff);
  return text;
}

} // namespace tetvdb
