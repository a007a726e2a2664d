// SPDX-License-Identifier: Apache-2.0
#include "TileOptions.h"

#include "Commands.h"
#include "tetvdb/core/Error.h"

#include <charconv>
#include <fmt/format.h>
#include <string_view>

namespace tetvdb::cli {
namespace {

int parseLevel(std::string_view text, const std::string& whole) {
  int level = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), level);
  if (error != std::errc() || end != text.data() + text.size())
    throw Error(Status::Usage, "--lod", "'" + whole + "' is no range of levels",
                fmt::format("give levels from 1 to {}, such as 1:6", kMaxLevel));
  return level;
}

} // namespace

void addTileOptions(CLI::App& command, TileTexts& texts) {
  CLI::Option* folder =
      command
          .add_option("--tiles", texts.folder,
                      "Write the volume into this folder, in place of -o: a .vdb file for every "
                      "cube of --tile-size voxels that holds any, and tiles.json")
          ->type_name("DIR")
          ->check(notEmpty());
  command
      .add_option("--tile-size", texts.size,
                  "Voxels along a side of such a cube: 512, 1024, 2048 or 4096 (default)")
      ->type_name("N")
      ->check(CLI::IsMember({512, 1024, 2048, 4096}).description(""))
      ->needs(folder);
  command
      .add_option(
          "--lod", texts.levels,
          "Coarser grids besides: NAME_level_K with voxels 2^K times as long, whose values "
          "are the share of the voxel that is inside, or the mean; with --tiles, in each file")
      ->type_name("FIRST:LAST")
      ->check(notEmpty());
}

void setTiles(const TileTexts& texts, std::string& output, int& tileSize, LevelRange& levels) {
  if (!texts.folder.empty()) {
    if (!output.empty())
      throw Error(Status::Usage, "--tiles", "takes the place of -o", "give one of them");
    output = texts.folder;
    tileSize = texts.size;
  }
  if (texts.levels.empty())
    return;
  const std::size_t colon = texts.levels.find(':');
  const std::string_view text = texts.levels;
  levels.first = parseLevel(text.substr(0, colon), texts.levels);
  levels.last =
      colon == std::string::npos ? levels.first : parseLevel(text.substr(colon + 1), texts.levels);
  checkLevels(levels);
}

} // namespace tetvdb::cli
