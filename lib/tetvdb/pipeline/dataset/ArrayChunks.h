// SPDX-License-Identifier: Apache-2.0
//
// Chunk sizes and attributes of files that hold arrays in chunks.
#pragma once

#include "tetvdb/pipeline/dataset/NamedArray.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

/// Attributes of the model whose arrays a file holds.
struct ArrayAttributes {
  std::vector<std::pair<std::string, std::string>> texts; ///< name and value
  std::vector<double> transform; ///< 4 x 4, from the model's file to the arrays
};

/// The sides of chunks: 128 voxels of arrays with three dimensions, 2^18 numbers or so of others;
/// none larger than the array, none 0.
inline std::vector<std::uint64_t> chunkShape(const std::vector<std::uint64_t>& shape) {
  std::vector<std::uint64_t> chunk = shape;
  if (shape.size() >= 3)
    for (std::uint64_t& side : chunk)
      side = std::min<std::uint64_t>(side, 128);
  else if (!shape.empty())
    chunk[0] = std::min<std::uint64_t>(chunk[0], shape.size() == 1 ? 1 << 18 : 1 << 16);
  for (std::uint64_t& side : chunk)
    side = std::max<std::uint64_t>(side, 1);
  return chunk;
}

/// zlib's, of both kinds of files.
constexpr unsigned kChunkDeflateLevel = 6;

} // namespace tetvdb
