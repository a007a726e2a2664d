// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/volume/NanoBytes.h"

#include <string>
#include <vector>

namespace tetvdb {

/// Writes NanoVDB grids that this program built to a .nvdb file, whole or absent, as writeVolume()
/// writes grids: compressed with Blosc, and with full checksums, which are computed here in
/// parallel. Throws Error(Write).
void writeNanoGrids(const std::string& path, const std::vector<NanoBytes>& grids,
                    Progress& progress);

} // namespace tetvdb
