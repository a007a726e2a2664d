// SPDX-License-Identifier: Apache-2.0
#include "ArrayFlags.h"

#include "Commands.h"
#include "ParseQuantities.h"
#include "tetvdb/core/Error.h"

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

} // namespace tetvdb::cli
