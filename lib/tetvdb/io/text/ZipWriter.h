// SPDX-License-Identifier: Apache-2.0
//
// Files into a ZIP archive, stored or packed by zlib.
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

/// Bytes depend on the content alone: all files have the same old date. What plain ZIP cannot hold
/// (4 GiB) has the fields of ZIP64. Throws Error(Limit) where begin() was told too small a size,
/// Error(Write) as AtomicFile does.
class ZipWriter {
public:
  /// Appends to `file`, which is empty.
  explicit ZipWriter(AtomicFile& file);
  ~ZipWriter();
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  /// `size`: the bytes that will be written, or more.
  void begin(const std::string& name, ZipMethod method = ZipMethod::Deflated,
             std::uint64_t size = 0);
  void write(std::string_view bytes);
  void end();
  /// Writes the directory; nothing may follow.
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
