// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/WholeBoxLevelSet.h"

#include "tetvdb/fields/DistanceBlocks.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <tbb/concurrent_vector.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
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
      const float distance = std::max(std::abs(std::sqrt(squared[at]) - shell) * voxel,
                                      std::numeric_limits<float>::min());
      values[at] = (inside[x] >> i & 1) != 0 ? -distance : distance;
    }
  }
  return leaf;
}

float largestOf(const std::vector<FloatLeaf*>& leaves) {
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

} // namespace

openvdb::FloatGrid::Ptr wholeBoxLevelSet(const SnappedMesh& mesh, const Boundary& faces,
                                         const openvdb::BoolGrid& inside,
                                         const GridTransform& transform, const VoxelBox& box,
                                         double shell, Progress& progress) {
  const DistanceBlocks blocks(mesh, faces);
  const auto voxel = static_cast<float>(transform.voxelSize[0]);
  tbb::concurrent_vector<std::unique_ptr<FloatLeaf>> made;
  blocks.rasterize(
      box,
      [&](const Vec3i& first, const float* squared) {
        std::uint64_t words[kLeafSize];
        insideOf(inside.constTree(), openvdb::Coord(first.data()), words);
        made.push_back(makeLeaf(box, first, squared, words, static_cast<float>(shell), voxel));
      },
      progress);
  std::vector<FloatLeaf*> leaves;
  leaves.reserve(made.size());
  for (const auto& leaf : made)
    leaves.push_back(leaf.get());
  const float background = largestOf(leaves);
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
    for (auto outside = leaves[i]->beginValueOff(); outside; ++outside)
      outside.setValue(background);
  });
  auto tree = std::make_shared<openvdb::FloatTree>(background);
  for (auto& leaf : made)
    tree->addLeaf(leaf.release());
  auto grid = openvdb::FloatGrid::create(tree);
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(makeTransform(transform));
  return grid;
}

} // namespace tetvdb
