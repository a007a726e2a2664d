// SPDX-License-Identifier: Apache-2.0
//
// Decompression of the strips and tiles of TIFF files. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tetvdb::tiff {

enum Compression : std::uint64_t {
  kNone = 1,
  kLzw = 5,
  kDeflate = 8,
  kPackBits = 32773,
  kOldDeflate = 32946
};

/// How many bytes one of such a strip can become, at most; 0 for compressions that are not read.
std::uint64_t largestRatio(std::uint64_t compression);

/// The `size` bytes of a strip. Throws Error(Invalid) with `path` if it holds fewer, or is damaged.
std::string decompress(std::string_view packed, std::uint64_t compression, std::size_t size,
                       const std::string& path);

} // namespace tetvdb::tiff
