// SPDX-License-Identifier: Apache-2.0
//
// Writes files to a ZIP archive, stored or deflated.
//
//   tetvdb::ZipWriter zip(file);
//   zip.begin("3D/3dmodel.model");
//   zip.write(text);
//   zip.end();
//   zip.finish();      // then file.commit()
#pragma once

#include "tetvdb/core/AtomicFile.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>
#include <zlib.h>

namespace tetvdb {

enum class ZipMethod : std::uint8_t { Stored = 0, Deflated = 8 };

/// Bytes depend on the content only: all files have the same date. Sizes beyond plain ZIP's (4 GiB)
/// have the fields of ZIP64. Throws Error(Limit) if the size given to begin() is too small,
/// Error(Write) as AtomicFile does.
class ZipWriter {
public:
  /// Appends to `file`, which must be empty.
  explicit ZipWriter(AtomicFile& file);
  ~ZipWriter();
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  /// `size`: an upper bound of the bytes that will be written.
  void begin(const std::string& name, ZipMethod method = ZipMethod::Deflated,
             std::uint64_t size = 0);
  void write(std::string_view bytes);
  void end();
  /// Writes the directory; must be the last call.
  void finish();

private:
  struct Entry {
    std::string name;
    std::uint64_t offset = 0, packed = 0, unpacked = 0;
    std::uint32_t crc = 0;
    ZipMethod method = ZipMethod::Deflated;
    bool large = false; ///< sizes have 64 bits
  };
  void add(std::string_view bytes, int flush);
  void pack(std::string_view bytes, int flush);
  std::string header(const Entry& entry, const std::string& extra) const;

  AtomicFile& file_;
  std::vector<Entry> entries_;
  z_stream stream_{};
};

} // namespace tetvdb
