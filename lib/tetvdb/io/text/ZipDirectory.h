// SPDX-License-Identifier: Apache-2.0
//
// The directory of a ZIP archive, read before anything is unpacked.
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

/// The entries of the central directory (also ZIP64). Throws Error(Invalid) if there is none or it
/// is incomplete.
std::vector<ZipEntry> readZipDirectory(const Source& source);

/// Throws Error(Invalid) if entries overlap, Error(Limit) if they declare more than 64 MiB and
/// `largestRatio` times the archive's size: meshes are compressed to about an eighth, malicious
/// archives to a thousandth.
void checkZipSizes(const std::vector<ZipEntry>& entries, const Source& source,
                   std::uint64_t largestRatio = 200);

/// The bytes of an entry, stored or deflated. Throws Error(Invalid) if their number differs from
/// the declared one; never unpacks more than that.
std::string unpackZipEntry(const ZipEntry& entry, const Source& source, Progress& progress);

} // namespace tetvdb
