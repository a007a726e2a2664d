// SPDX-License-Identifier: Apache-2.0
//
// What a ZIP archive says of its files, read before anything is unpacked.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/Source.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

struct ZipEntry {
  std::string name;
  std::uint64_t offset = 0;   ///< of its header
  std::uint64_t packed = 0;   ///< bytes in the archive
  std::uint64_t unpacked = 0; ///< bytes declared
  std::uint16_t method = 0;   ///< 0: stored, 8: deflated
};

/// The entries of the central directory (ZIP64 too). Throws Error(Invalid) where there is none or
/// it is not whole.
std::vector<ZipEntry> readZipDirectory(const Source& source);

/// Unpacks all entries without keeping anything, and returns the number of bytes. Throws
/// Error(Invalid) where entries overlap or do not unpack to what the directory declares,
/// Error(Limit), before anything is unpacked, where more than 64 MiB and 200 times the archive's
/// size are declared: meshes pack to about an eighth, bombs to a thousandth.
std::uint64_t checkZipEntries(const std::vector<ZipEntry>& entries, const Source& source,
                              Progress& progress);

} // namespace tetvdb
