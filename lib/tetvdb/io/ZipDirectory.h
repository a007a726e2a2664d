// SPDX-License-Identifier: Apache-2.0
//
// What a ZIP archive says of its files, read before anything is unpacked.
#pragma once

#include "tetvdb/io/Source.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

struct ZipEntry {
  std::string name;
  std::uint64_t packed = 0;   ///< bytes in the archive
  std::uint64_t unpacked = 0; ///< bytes declared
};

/// The entries of the central directory (ZIP64 too). Throws Error(Invalid) where there is none or
/// it is not whole.
std::vector<ZipEntry> readZipDirectory(const Source& source);

/// The bytes that all entries declare. Throws Error(Invalid) where entries overlap (they say to be
/// larger than the archive), Error(Limit) where they declare more than 64 MiB and 200 times the
/// archive's size: meshes pack to about an eighth, bombs to a thousandth.
std::uint64_t checkUnpackedSize(const std::vector<ZipEntry>& entries, const Source& source);

} // namespace tetvdb
