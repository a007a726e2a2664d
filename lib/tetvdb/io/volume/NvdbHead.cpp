// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/NvdbHead.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <zlib.h>

namespace tetvdb {
namespace {

constexpr std::uint32_t kVersion = 32U << 21 | 4U << 10 | 2U; // 32.4.2
constexpr std::size_t kChecked = 16; // from here on: behind the magic number and the checksum

nanovdb::GridClass classOf(const openvdb::GridBase& grid) {
  switch (grid.getGridClass()) {
  case openvdb::GRID_LEVEL_SET:
    return nanovdb::GridClass::LevelSet;
  case openvdb::GRID_FOG_VOLUME:
    return nanovdb::GridClass::FogVolume;
  case openvdb::GRID_STAGGERED:
    return nanovdb::GridClass::Staggered;
  default:
    return nanovdb::GridClass::Unknown;
  }
}

// The box of the voxels' corners: an index box includes its last voxels.
void setWorldBox(const nanovdb::Map& map, const openvdb::CoordBBox& box, double* world) {
  for (int corner = 0; corner < 8; ++corner) {
    nanovdb::Vec3d at;
    for (unsigned k = 0; k < 3; ++k)
      at[static_cast<int>(k)] = (corner >> k & 1) != 0 ? box.max()[k] + 1 : box.min()[k];
    at = map.applyMap(at);
    for (int k = 0; k < 3; ++k) {
      world[k] = corner == 0 ? at[k] : std::min(world[k], at[k]);
      world[3 + k] = corner == 0 ? at[k] : std::max(world[3 + k], at[k]);
    }
  }
}

} // namespace

void requireNvdbForm(const openvdb::GridBase& grid, const std::string& path) {
  const std::string name = "grid '" + grid.getName() + "'";
  const auto refuse = [&](const std::string& why) {
    throw Error(Status::Usage, path, name + why, "write a .vdb file");
  };
  if (!grid.apply<NvdbGrids>([](const auto&) {}))
    refuse(" of type " + grid.valueType() + " has no NanoVDB form");
  if (!grid.transform().isLinear())
    refuse(" has no NanoVDB form: its transform is not linear");
  if (grid.getGridClass() == openvdb::GRID_LEVEL_SET && !grid.isType<openvdb::FloatGrid>() &&
      !grid.isType<openvdb::DoubleGrid>())
    refuse(" has no NanoVDB form: a level set of type " + grid.valueType());
  if (grid.getName().size() >= sizeof NvdbGrid::name)
    refuse(" has a name that is too long for NanoVDB");
}

NvdbGrid makeNvdbGrid(const openvdb::GridBase& grid, const NvdbCounts& counts) {
  using nanovdb::GridFlags;
  NvdbGrid head{};
  const auto set = [&](GridFlags flag) { head.flags |= static_cast<std::uint32_t>(flag); };
  head.magic = kNvdbMagic;
  head.version = kVersion;
  head.gridCount = 1;
  head.gridSize = counts.size;
  grid.getName().copy(head.name, sizeof head.name - 1);

  const openvdb::math::AffineMap::Ptr affine = grid.transform().baseMap()->getAffineMap();
  const openvdb::Mat4R matrix = affine->getMat4();
  nanovdb::Map map;
  map.set(matrix, matrix.inverse(), 1.0);
  static_assert(sizeof map == sizeof head.mapF + sizeof head.matrix + sizeof head.inverse +
                                  sizeof head.translation + sizeof head.taper,
                "copied as it is");
  std::memcpy(&head.mapF, &map, sizeof map);
  const openvdb::Vec3d size = affine->voxelSize();
  for (int k = 0; k < 3; ++k)
    head.voxelSize[k] = size[grid.hasUniformVoxels() ? 0 : k];

  set(GridFlags::IsBreadthFirst);
  if (counts.box) {
    set(GridFlags::HasBBox);
    setWorldBox(map, *counts.box, head.worldBox);
  } else {
    std::fill_n(head.worldBox, 3, std::numeric_limits<double>::max());
    std::fill_n(head.worldBox + 3, 3, std::numeric_limits<double>::lowest());
  }
  if (counts.hasStatistics) {
    set(GridFlags::HasMinMax);
    set(GridFlags::HasAverage);
    set(GridFlags::HasStdDeviation);
  }
  head.gridClass = static_cast<std::uint32_t>(classOf(grid));
  head.gridType = counts.type;

  head.nodeOffset[3] = sizeof(NvdbGrid) - kNvdbTreeAt;
  for (std::size_t level = 0; level < 3; ++level) {
    if (counts.nodes[level] > 0)
      head.nodeOffset[level] = counts.at[level] - kNvdbTreeAt;
    head.nodeCount[level] = static_cast<std::uint32_t>(counts.nodes[level]);
    head.tileCount[level] = static_cast<std::uint32_t>(counts.tiles[level]);
  }
  head.voxelCount = counts.voxels;
  return head;
}

void setNvdbChecksum(unsigned char* head, std::size_t size, std::uint32_t nodes) {
  const std::uint64_t own = ::crc32_z(0, head + kChecked, size - kChecked);
  const std::uint64_t both = std::uint64_t(nodes) << 32 | own;
  std::memcpy(head + sizeof(std::uint64_t), &both, sizeof both);
}

} // namespace tetvdb
