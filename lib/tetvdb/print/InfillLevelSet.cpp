// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/InfillLevelSet.h"

#include "tetvdb/geometry/NodeIndex.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb {
namespace {

using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;

constexpr double kBand = 4; // voxels

// Origins of all leaves, and of those represented by inside tiles.
std::vector<openvdb::Coord> leavesOf(const Tree& tree) {
  std::vector<openvdb::Coord> origins;
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf)
    origins.push_back(leaf->origin());
  auto tile = tree.cbeginValueAll();
  for (tile.setMaxDepth(Tree::ValueAllCIter::LEAF_DEPTH - 1); tile; ++tile) {
    if (!(*tile < 0))
      continue;
    const openvdb::CoordBBox box = tile.getBoundingBox();
    for (std::int32_t x = box.min().x(); x <= box.max().x(); x += kLeafSize)
      for (std::int32_t y = box.min().y(); y <= box.max().y(); y += kLeafSize)
        for (std::int32_t z = box.min().z(); z <= box.max().z(); z += kLeafSize)
          origins.emplace_back(x, y, z);
  }
  return origins;
}

} // namespace

openvdb::FloatGrid::Ptr infillLevelSet(const openvdb::FloatGrid& cavity, const Infill& infill,
                                       const ThicknessAt& thickness, Progress& progress) {
  const openvdb::math::Transform& transform = cavity.transform();
  const double voxel = transform.voxelSize()[0];
  const std::vector<openvdb::Coord> origins = leavesOf(cavity.constTree());
  std::vector<std::unique_ptr<Leaf>> made(origins.size());
  std::vector<char> isFree(origins.size(), 0);
  std::atomic<std::size_t> done{0};
  const auto valueOf = [&](double amount, double distance) {
    return static_cast<float>(std::clamp((amount / 2 - distance) / voxel, -kBand, kBand));
  };
  tbb::parallel_for(std::size_t(0), origins.size(), [&](std::size_t i) {
    // Includes one voxel around the leaf: a surface between it and the next leaf is on both sides.
    constexpr std::int32_t kAlong = kLeafSize + 2;
    std::array<double, std::size_t(kAlong) * kAlong * kAlong> distances;
    const openvdb::Coord first = origins[i].offsetBy(-1);
    const openvdb::Vec3d p = transform.indexToWorld(first);
    infill.distances({p[0], p[1], p[2]}, voxel, kAlong, distances.data());
    auto leaf = std::make_unique<Leaf>(origins[i], 0.0f, true);
    float* values = leaf->buffer().data();
    bool free = false, solid = false;
    std::size_t next = 0;
    for (std::int32_t x = -1; x <= kLeafSize; ++x)
      for (std::int32_t y = -1; y <= kLeafSize; ++y)
        for (std::int32_t z = -1; z <= kLeafSize; ++z) {
          const float value = valueOf(thickness(origins[i].offsetBy(x, y, z)), distances[next++]);
          (value < 0 ? free : solid) = true;
          if (std::min({x, y, z}) >= 0 && std::max({x, y, z}) < kLeafSize)
            values[(x * kLeafSize + y) * kLeafSize + z] = value;
        }
    if (free && solid)
      made[i] = std::move(leaf);
    isFree[i] = free;
    if (const std::size_t now = ++done; now % 64 == 0)
      progress.update(static_cast<double>(now) / static_cast<double>(origins.size()));
  });
  auto grid = openvdb::FloatGrid::create(static_cast<float>(kBand));
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (made[i])
      grid->tree().addLeaf(made[i].release());
    else if (isFree[i])
      grid->tree().addTile(1, origins[i], static_cast<float>(-kBand), false);
  }
  grid->setName("shape");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(cavity.transform().copy());
  return grid;
}

} // namespace tetvdb
