// SPDX-License-Identifier: Apache-2.0
//
// What a ZIP archive says of its files, read before anything is unpacked.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/source/Source.h"

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

/// Throws Error(Invalid) where entries overlap, Error(Limit) where more than 64 MiB and 200 times
/// the archive's size are declared: meshes pack to about an eighth, bombs to a thousandth.
void checkZipSizes(const std::vector<ZipEntry>& entries, const Source& source);

/// The bytes of an entry, stored or deflated. Throws Error(Invalid) where they are not as many as
/// declared; more than that is never unpacked.
std::string unpackZipEntry(const ZipEntry& entry, const Source& source, Progress& progress);

} // namespace tetvdb
