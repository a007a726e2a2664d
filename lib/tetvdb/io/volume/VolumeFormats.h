// SPDX-License-Identifier: Apache-2.0
//
// One function a format; readVolume() and writeVolume() choose. Internal.
#pragma once

#include "tetvdb/io/VolumeFile.h"

namespace tetvdb {

void writeVdb(const std::string& path, const Volume& volume, Progress& progress);
Volume readVdb(const std::string& path, Progress& progress);

void writeNvdb(const std::string& path, const Volume& volume, Progress& progress);
Volume readNvdb(const std::string& path, Progress& progress);

} // namespace tetvdb
