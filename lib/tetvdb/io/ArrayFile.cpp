// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/ArrayFile.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/volume/arrays/ArrayWriters.h"
#include "tetvdb/io/volume/arrays/MakeDenseGrid.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <set>
#include <sstream>
#include <sys/stat.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

const Format* rowOf(const std::string& path) {
  return formatForEnding(path, FormatUse::WriteArrays);
}

const Format& requireRow(const std::string& path) {
  if (const Format* format = rowOf(path))
    return *format;
  throw Error(Status::Usage, path, "is no array format", "end the name with " + arrayEndings());
}

bool isOne(const Format& format, unsigned thing) {
  return (format.arrays & thing) != 0;
}

// ".npz, .vti or .raw": formats with this capability.
std::string endingsWith(unsigned thing) {
  std::vector<std::string> endings;
  for (const Format& format : formats())
    if (isOne(format, thing))
      endings.push_back(endingsOf(format).front());
  std::string text;
  for (std::size_t i = 0; i < endings.size(); ++i)
    text += (i == 0 ? "" : i + 1 == endings.size() ? " or " : ", ") + endings[i];
  return text;
}

std::string bytesText(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.0f} MB", std::ceil(bytes / 1e6))
                     : fmt::format("{:.1f} GB", bytes / 1e9);
}

std::array<double, 16> matrixOf(const std::string& path, const openvdb::GridBase& grid) {
  if (!grid.transform().isLinear())
    throw Error(Status::Usage, path,
                fmt::format("'{}' has a transform that is not linear: no array can have it",
                            grid.getName()),
                "choose others with `grid`");
  // OpenVDB multiplies rows from the left.
  const openvdb::Mat4d matrix = grid.transform().baseMap()->getAffineMap()->getConstMat4();
  std::array<double, 16> rows{};
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      rows[4 * row + column] =
          matrix(static_cast<int>(column), static_cast<int>(row)) + 0.0; // -0 becomes 0
  return rows;
}

// The cube of a volume that was made to fit it.
std::optional<VoxelBox> fitBox(const Volume& volume) {
  const auto found = volume.metadata.find("fit");
  if (found == volume.metadata.end())
    return {};
  std::istringstream text(found->second);
  std::int32_t side = 0;
  text >> side;
  if (text.fail() || side < 1 || side > kFarthestVoxel ||
      text.peek() != std::istringstream::traits_type::eof())
    return {};
  return VoxelBox{{0, 0, 0}, {side - 1, side - 1, side - 1}};
}

// Names that files and programs accept, distinct, and not in `taken`.
std::vector<std::string> namesOf(const openvdb::GridPtrVec& grids) {
  std::set<std::string> taken{"transform", "origin", "voxel_size", "box"};
  std::vector<std::string> names;
  for (const auto& grid : grids) {
    std::string name = grid->getName();
    for (char& c : name)
      if (c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
        c = '_';
    if (name.empty() || name == "." || name == "..")
      name = "grid";
    while (!taken.insert(name).second)
      name += '_';
    names.push_back(name);
  }
  return names;
}

ArrayContent contentOf(const std::string& path, const Volume& volume, const ArrayOptions& options) {
  const openvdb::GridPtrVec& grids = volume.grids().all;
  if (grids.empty())
    throw Error(Status::Invalid, path, "there is no grid to write");
  ArrayContent content;
  content.path = path;
  content.transform = matrixOf(path, *grids.front());
  for (const auto& grid : grids)
    if (matrixOf(path, *grid) != content.transform)
      throw Error(Status::Usage, path,
                  fmt::format("'{}' and '{}' have transforms of their own, and arrays of one file "
                              "share theirs",
                              grids.front()->getName(), grid->getName()),
                  "choose one with `grid`");
  content.box = options.box ? *options.box : arrayBoxOf(volume);
  if (content.box.empty())
    throw Error(Status::Invalid, path, "the grids have no active voxel, and so the array no size",
                "give its voxels with `box`");
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (content.box.low[axis] < -kFarthestVoxel || content.box.high[axis] > kFarthestVoxel)
      throw Error(
          Status::Limit, path,
          fmt::format("the box ends beyond voxel {}, the farthest of arrays", kFarthestVoxel),
          "choose a part with `box`");
  for (const auto& grid : grids)
    content.grids.push_back(denseGrid(*grid, content.box));
  content.names = namesOf(grids);
  content.metadata = volume.metadata;
  content.compress = options.compress;
  content.sparse = options.sparse;
  return content;
}

// Without the file's header.
double bytesOf(const ArrayContent& content) {
  double bytes = 0;
  for (const auto& grid : content.grids)
    bytes += content.sparse ? static_cast<double>(grid->countActive()) *
                                  (12 + static_cast<double>(grid->voxelBytes()))
                            : grid->bytes();
  return bytes;
}

} // namespace

bool isArrayFile(const std::string& path) {
  return rowOf(path) != nullptr;
}

std::string arrayEndings() {
  return endingList(FormatUse::WriteArrays);
}

bool isMaskFile(const std::string& path) {
  const Format* format = rowOf(path);
  return format != nullptr && isOne(*format, arrays::kMask);
}

std::vector<std::string> arrayFiles(const std::string& path) {
  const Format* format = rowOf(path);
  if (format != nullptr && format->id == FileFormat::Raw)
    return {path, path + ".json"};
  return {path};
}

VoxelBox arrayBoxOf(const Volume& volume) {
  if (const std::optional<VoxelBox> fit = fitBox(volume))
    return *fit;
  openvdb::CoordBBox all;
  for (const auto& grid : volume.grids().all) {
    const openvdb::CoordBBox own = grid->evalActiveVoxelBoundingBox();
    if (!own.empty())
      all.expand(own);
  }
  if (all.empty())
    return {};
  return {{all.min().x(), all.min().y(), all.min().z()},
          {all.max().x(), all.max().y(), all.max().z()}};
}

void checkArrayOptions(const std::string& path, const ArrayOptions& options, std::size_t grids) {
  const Format& format = requireRow(path);
  const std::string name = "a " + endingOf(path) + " file ";
  if (options.sparse && !isOne(format, arrays::kSparse))
    throw Error(Status::Usage, path, name + "has no place for coordinates (`sparse`)",
                "write " + endingsWith(arrays::kSparse));
  if (options.compress && !isOne(format, arrays::kCompressed))
    throw Error(Status::Usage, path, name + "is not compressed",
                "leave `compress` out, or write " + endingsWith(arrays::kCompressed));
  if (grids > 1 && !isOne(format, arrays::kSeveral))
    throw Error(Status::Usage, path, name + fmt::format("holds one grid, and there are {}", grids),
                "choose one with `grid`, or write " + endingsWith(arrays::kSeveral));
}

void requireRoom(const std::string& path, double bytes, bool compress) {
  constexpr double kBestDeflate = 1030; // zlib's documentation: 1032 to 1 is the limit
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode))
    return;
  const double needed = compress ? bytes / kBestDeflate : bytes;
  std::error_code error;
  const fs::path folder = fs::path(path).parent_path();
  const fs::space_info space = fs::space(folder.empty() ? fs::path(".") : folder, error);
  if (error || needed <= static_cast<double>(space.available))
    return;
  throw Error(Status::Limit, path,
              fmt::format("the arrays take {}{}, and {} are free there", bytesText(bytes),
                          compress ? " before they are compressed" : "",
                          bytesText(static_cast<double>(space.available))),
              "choose a part with `box`, a lower resolution, or .vdb, which is sparse");
}

void writeArrays(const std::string& path, const Volume& volume, const ArrayOptions& options,
                 Progress& progress) {
  initializeOpenVDB();
  checkArrayOptions(path, options, volume.grids().all.size());
  const ArrayContent content = contentOf(path, volume, options);
  requireRoom(path, bytesOf(content), options.compress);
  progress.stage("write");
  requireRow(path).writeArrays(content, progress);
}

} // namespace tetvdb
