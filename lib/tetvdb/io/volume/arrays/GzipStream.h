// SPDX-License-Identifier: Apache-2.0
//
// Bytes through gzip into a file. Internal.
#pragma once

#include "tetvdb/core/AtomicFile.h"

#include <cstddef>
#include <zlib.h>

namespace tetvdb {

/// The bytes depend on what is written alone.
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
