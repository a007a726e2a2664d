// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/arrays/ArrayVolume.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/arrays/ArrayGrid.h"

#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint64_t kMostGrids = 64; // of one array's components

} // namespace

ArrayVolume::ArrayVolume(std::string where, const ArrayInput& options, Progress& progress)
    : where_(std::move(where)), options_(options), progress_(progress) {
  initializeOpenVDB();
}

ArraySink ArrayVolume::sink() {
  ArraySink sink;
  sink.array = [this](const StoredArray& array) { add(array); };
  sink.leftOut = [this](const std::string& name, const std::string& type) {
    volume_.unread.push_back({name, type});
  };
  sink.metadata = [this](const std::string& key, const std::string& value) {
    volume_.metadata[key] = value;
  };
  return sink;
}

void ArrayVolume::add(StoredArray array) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto size = static_cast<double>(array.size[k]);
    if (array.size[k] == 0) {
      volume_.unread.push_back({array.name, "empty"});
      return;
    }
    if (array.coordinates.empty() &&
        (array.low[k] < -kFarthestVoxel ||
         array.low[k] + size - 1 > static_cast<double>(kFarthestVoxel)))
      throw Error(
          Status::Limit, where_,
          fmt::format("the array ends beyond voxel {}, the farthest that is read", kFarthestVoxel));
  }
  if (array.components == 0 || (array.components > kMostGrids && array.components != 3)) {
    volume_.unread.push_back({array.name, fmt::format("an array of {} components, more than {}",
                                                      array.components, kMostGrids)});
    return;
  }
  if (options_.zSlowest) {
    if (array.placed)
      throw Error(Status::Usage, where_, "says itself which axes are x, y and z",
                  "leave out `axes`");
    std::swap(array.size[0], array.size[2]);
    std::swap(array.step[0], array.step[2]);
  }
  if (array.components == 1 || (array.components == 3 && !array.separate))
    return addGrid(array, array.name);
  for (std::uint64_t k = 0; k < array.components; ++k) {
    StoredArray one = array;
    one.components = 1;
    one.bytes.remove_prefix(
        static_cast<std::size_t>(k * array.componentStep * bytesOf(array.element)));
    addGrid(one, fmt::format("{}_{}", array.name.empty() ? "density" : array.name, k));
  }
}

Volume ArrayVolume::finish() {
  if (volume_.grids().all.empty())
    throw Error(Status::Invalid, where_,
                volume_.unread.empty()
                    ? "holds no array"
                    : fmt::format("holds no array of voxels that is read: '{}' is {}",
                                  volume_.unread.front().name, volume_.unread.front().type));
  return std::move(volume_);
}

void ArrayVolume::addGrid(const StoredArray& array, std::string name) {
  progress_.check();
  ArrayGrid made = gridOf(array, where_, options_.background, progress_);
  if (name.empty())
    name = made.grid->isType<openvdb::BoolGrid>()                 ? "mask"
           : made.grid->isType<openvdb::Vec3SGrid>()              ? "vector"
           : made.grid->getGridClass() == openvdb::GRID_LEVEL_SET ? "surface"
                                                                  : "density";
  while (!names_.insert(name).second)
    name += '_';
  made.grid->setName(name);
  made.grid->setTransform(transformOf(array));
  openFirstTile(*made.grid);
  volume_.notNumbers += made.notNumbers;
  volume_.grids().all.push_back(made.grid);
}

openvdb::math::Transform::Ptr ArrayVolume::transformOf(const StoredArray& array) const try {
  const ArrayTransform& m = array.transform;
  GridTransform plain;
  bool isPlain = true;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t k = 0; k < 3; ++k)
      isPlain = isPlain && (row == k ? m[5 * k] > 0 : m[4 * row + k] == 0);
    plain.voxelSize[row] = m[5 * row];
    plain.origin[row] = m[4 * row + 3];
  }
  if (options_.voxelSize || options_.origin || isPlain) {
    if (options_.voxelSize) // voxel (0, 0, 0) stays where it is
      for (std::size_t k = 0; k < 3; ++k)
        plain.voxelSize[k] = (*options_.voxelSize)[k];
    else if (!isPlain)
      throw Error(Status::Usage, where_, "has axes that are turned, and an origin cannot be set",
                  "give `voxel_size` too, to leave its transform out");
    if (options_.origin)
      plain.origin = *options_.origin;
    return makeTransform(plain);
  }
  openvdb::Mat4d matrix; // OpenVDB multiplies rows from the left
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      matrix(static_cast<int>(column), static_cast<int>(row)) = m[4 * row + column];
  if (!(std::abs(matrix.det()) > 3e-15) || !std::isfinite(matrix.det()))
    throw Error(Status::Invalid, where_,
                "its voxels have no volume, or less than OpenVDB's limit of 3e-15 cubic units",
                "give `voxel_size`");
  return openvdb::math::Transform::createLinearTransform(matrix);
} catch (const Error&) {
  throw;
} catch (const openvdb::Exception& error) {
  throw Error(Status::Invalid, where_, std::string("its transform is none: ") + error.what(),
              "give `voxel_size`");
}

} // namespace tetvdb
