// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/WholeBoxLevelSet.h"

#include "tetvdb/voxelize/TreeBuilder.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <tbb/concurrent_vector.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using MaskAccessor = openvdb::tree::ValueAccessor<const openvdb::BoolTree>;

// The bits z of a leaf's row that are in the box.
std::uint64_t bitsInBox(const VoxelBox& box, const Vec3i& first, std::int32_t x) {
  std::uint64_t bits = 0;
  if (first[0] + x < box.low[0] || first[0] + x > box.high[0])
    return bits;
  for (std::int32_t y = 0; y < kLeafSize; ++y)
    for (std::int32_t z = 0; z < kLeafSize; ++z)
      if (first[1] + y >= box.low[1] && first[1] + y <= box.high[1] && first[2] + z >= box.low[2] &&
          first[2] + z <= box.high[2])
        bits |= std::uint64_t(1) << (kLeafSize * y + z);
  return bits;
}

// The words of a leaf's inside voxels.
void insideOf(const openvdb::BoolTree& inside, const openvdb::Coord& first, std::uint64_t* words) {
  if (const auto* leaf = inside.probeConstLeaf(first)) {
    for (openvdb::Index x = 0; x < kLeafSize; ++x)
      words[x] = leaf->getValueMask().getWord<openvdb::Index64>(x);
    return;
  }
  std::fill(words, words + kLeafSize, inside.isValueOn(first) ? ~std::uint64_t(0) : 0);
}

// World units.
float distanceOf(float squared, float shell, float voxel) {
  return std::abs(std::sqrt(squared) - shell) * voxel;
}

std::unique_ptr<FloatLeaf> makeLeaf(const VoxelBox& box, const Vec3i& first, const float* squared,
                                    const std::uint64_t* inside, float shell, float voxel) {
  const openvdb::Coord origin(first.data());
  auto leaf = std::make_unique<FloatLeaf>(openvdb::PartialCreate(), origin, 0.0f, false);
  leaf->allocate();
  float* values = leaf->buffer().data();
  for (std::int32_t x = 0; x < kLeafSize; ++x) {
    leaf->getValueMask().getWord<openvdb::Index64>(static_cast<openvdb::Index>(x)) =
        bitsInBox(box, first, x);
    for (std::int32_t i = 0; i < kLeafSize * kLeafSize; ++i) {
      const std::int32_t at = x * kLeafSize * kLeafSize + i;
      // Zero would be neither inside nor outside.
      const float distance =
          std::max(distanceOf(squared[at], shell, voxel), std::numeric_limits<float>::min());
      values[at] = (inside[x] >> i & 1) != 0 ? -distance : distance;
    }
  }
  return leaf;
}

using Leaves = tbb::concurrent_vector<std::unique_ptr<FloatLeaf>>;

// Those that meet `part` of the box; without a background.
Leaves makeLeaves(const DistanceBlocks& blocks, const VoxelBox& part, const VoxelBox& box,
                  const openvdb::BoolGrid& inside, double shell, double voxel, Progress& progress) {
  Leaves made;
  blocks.rasterize(
      part,
      [&](const Vec3i& first, const float* squared) {
        std::uint64_t words[kLeafSize];
        insideOf(inside.constTree(), openvdb::Coord(first.data()), words);
        made.push_back(makeLeaf(box, first, squared, words, static_cast<float>(shell),
                                static_cast<float>(voxel)));
      },
      progress);
  return made;
}

float largestOf(const Leaves& leaves) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, leaves.size()), 0.0f,
      [&](const auto& range, float largest) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
          for (auto voxel = leaves[i]->cbeginValueOn(); voxel; ++voxel)
            largest = std::max(largest, std::abs(*voxel));
        return largest;
      },
      [](float a, float b) { return std::max(a, b); });
}

openvdb::FloatGrid::Ptr makeGrid(Leaves leaves, float background, const GridTransform& transform) {
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
    for (auto outside = leaves[i]->beginValueOff(); outside; ++outside)
      outside.setValue(background);
  });
  auto tree = std::make_shared<openvdb::FloatTree>(background);
  for (auto& leaf : leaves)
    tree->addLeaf(leaf.release());
  auto grid = openvdb::FloatGrid::create(tree);
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(makeTransform(transform));
  return grid;
}

VoxelBox common(const VoxelBox& box, const NodeBox& nodes) {
  VoxelBox both;
  for (std::size_t k = 0; k < 3; ++k) {
    both.low[k] = std::max(box.low[k], nodes.low[k] * kNodeSize);
    both.high[k] = std::min(box.high[k], nodes.high[k] * kNodeSize - 1);
  }
  return both;
}

} // namespace

VoxelBox wholeBox(const SnappedMesh& mesh, const Boundary& faces, openvdb::CoordBBox inside,
                  double shell) {
  const auto above = [&](double units) {
    return static_cast<std::int32_t>(std::floor(units * kVoxelsPerUnit + shell));
  };
  const auto below = [&](double units) {
    return static_cast<std::int32_t>(std::ceil(units * kVoxelsPerUnit - shell));
  };
  for (const BoundaryFace& face : faces.faces)
    for (const std::uint32_t corner : {face.a, face.b, face.c}) {
      const LatticePoint& p = mesh.points[corner];
      inside.expand(openvdb::Coord(below(p.x), below(p.y), below(p.z)));
      inside.expand(openvdb::Coord(above(p.x), above(p.y), above(p.z)));
    }
  inside.expand(kBeyondMesh);
  VoxelBox voxels;
  for (unsigned axis = 0; axis < 3; ++axis) {
    voxels.low[axis] = inside.min()[axis];
    voxels.high[axis] = inside.max()[axis];
  }
  return voxels;
}

double wholeBoxBytes(const VoxelBox& box, std::size_t faces) {
  double leaves = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    leaves *= static_cast<double>(box.size(axis)) / kLeafSize + 2;
  return leaves * static_cast<double>(leafBytes(GridKind::Density) + 32) +
         100.0 * static_cast<double>(faces);
}

openvdb::FloatGrid::Ptr wholeBoxLevelSet(const SnappedMesh& mesh, const Boundary& faces,
                                         const openvdb::BoolGrid& inside,
                                         const GridTransform& transform, const VoxelBox& box,
                                         double shell, Progress& progress) {
  Leaves leaves = makeLeaves(DistanceBlocks(mesh, faces), box, box, inside, shell,
                             transform.voxelSize[0], progress);
  const float background = largestOf(leaves);
  return makeGrid(std::move(leaves), background, transform);
}

WholeBoxParts::WholeBoxParts(const SnappedMesh& mesh, const Boundary& faces,
                             const GridTransform& transform, const VoxelBox& box,
                             Progress& progress)
    : blocks_(mesh, faces), transform_(transform), box_(box),
      background_(distanceOf(blocks_.largest(box, progress), 0,
                             static_cast<float>(transform.voxelSize[0]))) {}

openvdb::FloatGrid::Ptr WholeBoxParts::grid(const NodeBox& part, const openvdb::BoolGrid& inside,
                                            Progress& progress) const {
  return makeGrid(
      makeLeaves(blocks_, common(box_, part), box_, inside, 0, transform_.voxelSize[0], progress),
      background_, transform_);
}

} // namespace tetvdb
