// SPDX-License-Identifier: Apache-2.0
//
// One function a format; readVolume() and writeVolume() choose. Internal.
#pragma once

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/ProgressShare.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/volume/Grids.h"

namespace tetvdb {

void writeVdb(const std::string& path, const Volume& volume, Progress& progress);
Volume readVdb(const std::string& path, Progress& progress);

void writeNvdb(const std::string& path, const Volume& volume, Progress& progress);
/// Appends grids whose trees are in memory: their bytes in a file of writeNvdb(). Throws as that
/// does.
void writeNvdbGrids(AtomicFile& file, const openvdb::GridPtrVec& grids, const ProgressShare& share);
Volume readNvdb(const std::string& path, Progress& progress);

} // namespace tetvdb
