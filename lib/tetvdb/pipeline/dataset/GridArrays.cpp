// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/dataset/GridArrays.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/arrays/MakeDenseGrid.h"
#include "tetvdb/pipeline/dataset/PackedBits.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace tetvdb {
namespace {

using Side = std::uint64_t;

const openvdb::GridBase& gridNamed(const Volume& volume, const std::string& name) {
  for (const auto& grid : volume.grids().all)
    if (grid->getName() == name)
      return *grid;
  throw Error(Status::Invalid, "", "the volume has no grid '" + name + "'");
}

// Sets voxels (x, y, z0) to (x, y, z1).
void setRun(PackedBits& bits, Side size, Side x, Side y, Side z0, Side z1) {
  for (Side at = (x * size + y) * size + z0, last = (x * size + y) * size + z1; at <= last; ++at)
    bits.set(at);
}

// Adds the part of a box of voxels that is in the cube.
void setBox(PackedBits& bits, Side size, const openvdb::CoordBBox& box) {
  std::array<Side, 3> low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto last = static_cast<std::int64_t>(size) - 1;
    const std::int64_t from = std::max<std::int64_t>(box.min()[axis], 0),
                       to = std::min<std::int64_t>(box.max()[axis], last);
    if (from > to)
      return;
    low[axis] = static_cast<Side>(from);
    high[axis] = static_cast<Side>(to);
  }
  for (Side x = low[0]; x <= high[0]; ++x)
    for (Side y = low[1]; y <= high[1]; ++y)
      setRun(bits, size, x, y, low[2], high[2]);
}

std::vector<char> packedBits(const openvdb::BoolGrid& grid, Side size) {
  PackedBits bits(size * size * size);
  const bool wholeBytes = size % 8 == 0;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const openvdb::Coord origin = leaf->origin();
    const openvdb::CoordBBox box = openvdb::CoordBBox::createCube(origin, 8);
    const auto last = static_cast<std::int32_t>(size) - 1;
    if (!wholeBytes || !openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(last)).isInside(box)) {
      for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel)
        setBox(bits, size, openvdb::CoordBBox(voxel.getCoord(), voxel.getCoord()));
      continue;
    }
    // Word x of a leaf's mask has bit 8 y + z.
    for (Side x = 0; x < 8; ++x) {
      const std::uint64_t word =
          leaf->valueMask().getWord<std::uint64_t>(static_cast<openvdb::Index>(x));
      for (Side y = 0; y < 8 && word != 0; ++y) {
        const Side at =
            ((Side(origin.x()) + x) * size + Side(origin.y()) + y) * size + Side(origin.z());
        bits.setEight(at, static_cast<std::uint8_t>(word >> 8 * y));
      }
    }
  }
  auto tile = grid.tree().cbeginValueOn();
  tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
  for (; tile; ++tile)
    setBox(bits, size, tile.getBoundingBox());
  return std::move(bits).takeBytes();
}

VoxelBox cubeOf(int size) {
  return {{0, 0, 0}, {size - 1, size - 1, size - 1}};
}

} // namespace

NamedArray activeArray(const Volume& volume, const std::string& grid, int size, std::string name) {
  const auto side = static_cast<Side>(size);
  const auto* mask = dynamic_cast<const openvdb::BoolGrid*>(&gridNamed(volume, grid));
  if (mask == nullptr)
    throw Error(Status::Invalid, "", "'" + grid + "' is no grid of booleans");
  NamedArray array{std::move(name), "|b1", {side, side, side}, packedBits(*mask, side)};
  array.packed = true;
  return array;
}

NamedArray coordinateArray(const Volume& volume, const std::string& grid, int size,
                           std::string name) {
  const auto dense = denseGrid(gridNamed(volume, grid), cubeOf(size));
  std::vector<std::int32_t> voxels;
  for (std::uint64_t x = 0; x < static_cast<std::uint64_t>(size); ++x)
    dense->activeOf(x, &voxels, nullptr);
  return NamedArray::of(std::move(name), "<i4", {voxels.size() / 3, 3}, voxels);
}

NamedArray valueArray(const Volume& volume, const std::string& grid, int size, std::string name) {
  const auto dense = denseGrid(gridNamed(volume, grid), cubeOf(size));
  const auto side = static_cast<Side>(size);
  std::vector<char> bytes(dense->planeBytes(kXSlowest) * side);
  dense->fill(kXSlowest, 0, side, bytes.data());
  return {std::move(name), "<f4", {side, side, side}, std::move(bytes)};
}

} // namespace tetvdb
