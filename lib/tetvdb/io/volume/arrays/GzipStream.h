// SPDX-License-Identifier: Apache-2.0
//
// Compresses bytes with gzip into a file. Internal.
#pragma once

#include "tetvdb/core/AtomicFile.h"

#include <cstddef>
#include <zlib.h>

namespace tetvdb {

/// The bytes in the file depend only on the bytes that are written.
class GzipStream {
public:
  explicit GzipStream(AtomicFile& file);
  ~GzipStream();
  GzipStream(const GzipStream&) = delete;
  GzipStream& operator=(const GzipStream&) = delete;

  void write(const char* bytes, std::size_t size);
  /// Ends the stream; nothing may follow.
  void finish();

private:
  void pack(const char* bytes, std::size_t size, int flush);

  AtomicFile& file_;
  z_stream stream_{};
};

} // namespace tetvdb
