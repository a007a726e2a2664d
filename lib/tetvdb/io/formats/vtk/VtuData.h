// SPDX-License-Identifier: Apache-2.0
//
// Binary arrays of VTK's XML files: base64 or raw bytes, plain or in compressed blocks.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/formats/vtk/VtuMarkup.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace tetvdb::vtk {

enum class Compressor : std::uint8_t { None, Zlib, Lz4, Lzma };

/// The encoding of a file's binary arrays.
struct Encoding {
  Compressor compressor = Compressor::None;
  bool wideHeader = false; ///< header_type UInt64 instead of UInt32
  bool swap = false;       ///< byte order of the headers (and the numbers)
};

/// Bytes of an array: a view of the file if possible.
struct Decoded {
  const char* data = nullptr;
  std::uint64_t size = 0;
  std::unique_ptr<char[]> owned;
};

/// Decodes the array at the beginning of `from`. Throws Error(Invalid) if it has fewer than `min`
/// bytes, is truncated or damaged; `path` is for messages. Compressed blocks and long base64 are
/// decoded in parallel. Allocates at most what the file's bytes can hold after decompression.
Decoded decode(const Excerpt& from, bool base64, const Encoding& encoding, std::uint64_t min,
               const std::string& path, Progress& progress);

/// The same bytes one after the other, for arrays that are larger than memory. Memory: one
/// compressed block, and 8 bytes for each of them.
class ArrayStream {
public:
  ArrayStream(const Excerpt& from, bool base64, const Encoding& encoding, const std::string& path);
  ~ArrayStream();
  ArrayStream(const ArrayStream&) = delete;
  ArrayStream& operator=(const ArrayStream&) = delete;

  /// Bytes that are left, as the array says; there may be less in a damaged file.
  std::uint64_t left() const;
  /// The next `n` bytes. Throws Error(Invalid) where they are not there or damaged.
  void read(char* out, std::uint64_t n);

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace tetvdb::vtk
