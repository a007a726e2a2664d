// SPDX-License-Identifier: Apache-2.0
//
// The bytes of a NanoVDB grid in a .nvdb file: chunks of 1 GB, each compressed with Blosc. A chunk
// is compressed block by block, in parallel, so that it never is in memory whole.
#pragma once

#include "tetvdb/core/AtomicFile.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The bytes are those of blosc_compress_ctx(9, BLOSC_SHUFFLE, 4, ...) with LZ4 and kAskedBlock,
/// but that a chunk is never stored uncompressed: the tables of blocks make one that cannot be
/// compressed 0.01 % larger.
class BloscChunks {
public:
  static constexpr std::size_t kAskedBlock = std::size_t(1) << 18;

  /// Appends to the file, which must outlive it. `size`: of all that will be written.
  BloscChunks(AtomicFile& file, std::uint64_t size);
  /// Memory: two blocks a thread, at most 32 of 1 MB each, and as many compressed ones. Throws
  /// Error(Write).
  void write(const void* data, std::size_t size);

private:
  void flush();
  void beginChunk();
  void endChunk();

  AtomicFile& file_;
  std::size_t block_, batch_;    ///< bytes that Blosc compresses by themselves, and here at once
  std::uint64_t left_;           ///< of all bytes, those after the chunk under way
  std::uint64_t chunk_ = 0;      ///< bytes of the chunk that are still to be compressed
  std::uint32_t chunkBytes_ = 0; ///< all of them
  std::uint64_t chunkAt_ = 0;
  std::vector<std::uint32_t> blocks_; ///< where each of the chunk begins in it
  std::vector<unsigned char> head_;   ///< of the chunk, but for these
  std::vector<unsigned char> buffer_; ///< at most batch_ bytes
};

} // namespace tetvdb
