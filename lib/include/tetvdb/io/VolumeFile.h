// SPDX-License-Identifier: Apache-2.0
//
// Reads and writes volumes.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/source/FileFormat.h"
#include "tetvdb/volume/Volume.h"

#include <string>

namespace tetvdb {

/// Writes .vdb or .nvdb by the path's extension, whole or absent. .vdb: Blosc with active mask,
/// file version 224, statistics metadata, node buffers compressed in parallel; the payload is that
/// of openvdb::io::File. .nvdb: every grid with full checksums, Blosc. Throws Error(Usage) for
/// another extension, Error(Write) on a full disk or an unwritable path.
void writeVolume(const std::string& path, const Volume& volume, Progress& progress);

/// Reads .vdb, .nvdb or, as readArrays() without options, arrays (by content). Throws
/// Error(Invalid) for a file that is incomplete or contains no grid.
Volume readVolume(const std::string& path, Progress& progress);

/// The format of a file that readVolume() reads, by content; Unknown for others, and for those that
/// cannot be opened.
FileFormat volumeFormatOf(const std::string& path);
inline bool isVolumeFile(const std::string& path) {
  return volumeFormatOf(path) != FileFormat::Unknown;
}

} // namespace tetvdb
