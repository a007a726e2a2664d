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

/// How a file's binary arrays are written.
struct Encoding {
  Compressor compressor = Compressor::None;
  bool wideHeader = false; ///< header_type UInt64 in place of UInt32
  bool swap = false;       ///< byte order of the headers (and the numbers)
};

/// Bytes of an array: a view of the file where that is possible.
struct Decoded {
  const char* data = nullptr;
  std::uint64_t size = 0;
  std::unique_ptr<char[]> owned;
};

/// Decodes the array that `from` begins with. Throws Error(Invalid) where it has fewer than `min`
/// bytes, is cut off or damaged; `path` is for messages. Compressed blocks and long base64 are
/// decoded in parallel. Allocates no more than the file's bytes can hold after decompression.
Decoded decode(const Excerpt& from, bool base64, const Encoding& encoding, std::uint64_t min,
               const std::string& path, Progress& progress);

} // namespace tetvdb::vtk
