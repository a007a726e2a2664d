// SPDX-License-Identifier: Apache-2.0
//
// --tiles, --tile-size and --lod, of commands that write volumes.
#pragma once

#include "tetvdb/volume/LevelsOfDetail.h"

#include <CLI/CLI.hpp>
#include <string>

namespace tetvdb::cli {

struct TileTexts {
  std::string folder, levels;
  int size = 4096;
};

void addTileOptions(CLI::App& command, TileTexts& texts);

/// The folder is the job's output. Throws Error(Usage), also where a file is given besides.
void setTiles(const TileTexts& texts, std::string& output, int& tileSize, LevelRange& levels);

} // namespace tetvdb::cli
