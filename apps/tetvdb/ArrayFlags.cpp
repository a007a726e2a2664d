// SPDX-License-Identifier: Apache-2.0
#include "ArrayFlags.h"

#include "Commands.h"
#include "ParseQuantities.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/VolumeFile.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace tetvdb::cli {
namespace {

VoxelBox parseVoxelBox(const std::string& text) {
  const std::vector<double> numbers = parseNumbers("--box", text);
  const auto isVoxel = [](double n) { return n == std::floor(n) && std::abs(n) <= 1 << 30; };
  if (numbers.size() != 6 || !std::all_of(numbers.begin(), numbers.end(), isVoxel))
    throw Error(Status::Usage, "--box", "'" + text + "' is not six whole numbers up to 2^30",
                "give the first and the last voxel as x0,y0,z0,x1,y1,z1");
  VoxelBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = static_cast<std::int32_t>(std::min(numbers[axis], numbers[axis + 3]));
    box.high[axis] = static_cast<std::int32_t>(std::max(numbers[axis], numbers[axis + 3]));
  }
  return box;
}

} // namespace

void addArrayFlags(CLI::App& command, ArrayTexts& texts) {
  command
      .add_option("--box", texts.box,
                  "Voxels of an array, the first and the last, in index space (default: the box of "
                  "the active ones)")
      ->type_name("x0,y0,z0,x1,y1,z1")
      ->check(notEmpty());
  command.add_flag("--sparse", texts.sparse,
                   "Write coordinates and values of active voxels, not a dense array (.npz)");
  command.add_flag("--compress", texts.compress, "Compress arrays with deflate");
}

ArrayOptions parseArrays(const ArrayTexts& texts, const std::string& output) {
  ArrayOptions options;
  options.sparse = texts.sparse;
  options.compress = texts.compress;
  if (!texts.box.empty())
    options.box = parseVoxelBox(texts.box);
  if ((options.sparse || options.compress || options.box) && !isArrayFile(output))
    throw Error(Status::Usage,
                options.box        ? "--box"
                : options.compress ? "--compress"
                                   : "--sparse",
                "is for arrays, and the output is none",
                "leave it out, or end the output's name with " + arrayEndings());
  return options;
}

void addArrayInputOptions(CLI::App& command, ArrayInputTexts& texts) {
  command
      .add_option("--voxel-size", texts.voxelSize,
                  "Of arrays that are read: a voxel's side, or one for each axis (default: the "
                  "file's, or 1)")
      ->type_name("H|HX,HY,HZ")
      ->check(notEmpty());
  command
      .add_option("--origin", texts.origin,
                  "Of arrays that are read: the centre of voxel (0, 0, 0) (default: the file's, or "
                  "0,0,0)")
      ->type_name("X,Y,Z")
      ->check(notEmpty());
  command
      .add_option("--axes", texts.axes,
                  "Of .npy and .npz files without a transform: whether arrays are [x][y][z] "
                  "(default) or [z][y][x]")
      ->check(CLI::IsMember({"xyz", "zyx"}))
      ->type_name("xyz|zyx");
  command
      .add_option("--background", texts.background,
                  "Of arrays that are read: the value of voxels that are left out (default 0; of a "
                  "level set its largest)")
      ->type_name("V")
      ->check(notEmpty());
}

ArrayInput parseArrayInput(const ArrayInputTexts& texts, const std::string& input) {
  ArrayInput options;
  if (!texts.voxelSize.empty())
    options.voxelSize = parseVoxelSize("--voxel-size", texts.voxelSize);
  if (!texts.origin.empty())
    options.origin = parsePoint("--origin", texts.origin);
  options.zSlowest = texts.axes == "zyx";
  if (!texts.background.empty()) {
    const std::vector<double> numbers = parseNumbers("--background", texts.background);
    if (numbers.size() != 1 || !std::isfinite(numbers.front()))
      refuse("--background", texts.background, "give one number");
    options.background = numbers.front();
  }
  if ((options.voxelSize || options.origin || !texts.axes.empty() || options.background) &&
      !can(formatOf(volumeFormatOf(input)), FormatUse::ReadArrays))
    throw Error(Status::Usage,
                options.voxelSize    ? "--voxel-size"
                : options.origin     ? "--origin"
                : options.background ? "--background"
                                     : "--axes",
                "is for arrays, and the input is none", "leave it out");
  return options;
}

} // namespace tetvdb::cli
