// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/arrays/ArrayWriters.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

constexpr std::size_t kSlabBytes = std::size_t(32) << 20; ///< unless one plane is larger
constexpr std::uint64_t kLeaf = 8;

} // namespace

Vec3d ArrayContent::voxelSize() const {
  Vec3d size;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // An axis-aligned size is exact.
    const double x = transform[axis], y = transform[4 + axis], z = transform[8 + axis];
    const int terms = (x != 0) + (y != 0) + (z != 0);
    size[axis] = terms == 1 ? std::abs(x + y + z) : std::sqrt(x * x + y * y + z * z);
  }
  return size;
}

Vec3d ArrayContent::worldOf(const Vec3d& index) const {
  Vec3d world;
  for (std::size_t row = 0; row < 3; ++row)
    world[row] = transform[4 * row + 3] + transform[4 * row] * index[0] +
                 transform[4 * row + 1] * index[1] + transform[4 * row + 2] * index[2];
  return world;
}

bool ArrayContent::isAxisAligned() const {
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      if (row == column ? !(transform[4 * row + column] > 0) : transform[4 * row + column] != 0)
        return false;
  return true;
}

void ArrayContent::requireAxisAligned(const char* format) const {
  if (!isAxisAligned())
    throw Error(Status::Usage, path,
                std::string(format) + " has no place for a transform that turns or mirrors axes",
                "write .npz, .nrrd, .h5 or .raw");
}

void ArrayContent::requireOneGrid(const char* format) const {
  if (grids.size() != 1)
    throw Error(Status::Usage, path,
                std::string(format) + " holds one grid, and there are " +
                    std::to_string(grids.size()),
                "choose one with `grid`, or write .npz, .vti, .h5 or .raw");
}

ArrayStream::ArrayStream(const ArrayContent& content, Progress& progress, int passes)
    : progress_(progress) {
  for (const auto& grid : content.grids)
    total_ += grid->bytes() * passes;
}

void ArrayStream::update(double bytes) {
  done_ += bytes;
  progress_.update(total_ > 0 ? std::min(done_ / total_, 1.0) : 1.0);
}

void ArrayStream::send(const DenseGrid& grid, const AxisOrder& order, const Sink& sink) {
  const std::size_t plane = grid.planeBytes(order);
  const std::uint64_t planes = grid.box().size(order[0]);
  std::uint64_t atOnce = std::max<std::uint64_t>(kSlabBytes / std::max<std::size_t>(plane, 1), 1);
  if (atOnce > kLeaf)
    atOnce -= atOnce % kLeaf;
  std::vector<char> bytes(static_cast<std::size_t>(std::min(atOnce, planes)) * plane);
  // A slab ends where leaf nodes do.
  const std::int64_t low = grid.box().low[order[0]];
  const auto offset = static_cast<std::uint64_t>(low & static_cast<std::int64_t>(kLeaf - 1));
  for (std::uint64_t first = 0; first < planes;) {
    std::uint64_t count = std::min(atOnce, planes - first);
    if (atOnce >= kLeaf && first == 0 && offset != 0)
      count = std::min(count, atOnce - offset);
    grid.fill(order, first, count, bytes.data());
    sink(bytes.data(), static_cast<std::size_t>(count) * plane);
    first += count;
    update(static_cast<double>(count) * static_cast<double>(plane));
  }
}

void ArrayStream::sendVoxels(const DenseGrid& grid, const Sink& sink) {
  std::vector<std::int32_t> voxels;
  for (std::uint64_t x = 0; x < grid.box().size(0); ++x) {
    voxels.clear();
    grid.activeOf(x, &voxels, nullptr);
    sink(reinterpret_cast<const char*>(voxels.data()), voxels.size() * sizeof(std::int32_t));
    update(static_cast<double>(grid.planeBytes(kXSlowest)));
  }
}

void ArrayStream::sendValues(const DenseGrid& grid, const Sink& sink) {
  std::vector<char> values;
  for (std::uint64_t x = 0; x < grid.box().size(0); ++x) {
    values.clear();
    grid.activeOf(x, nullptr, &values);
    sink(values.data(), values.size());
    update(static_cast<double>(grid.planeBytes(kXSlowest)));
  }
}

} // namespace tetvdb
