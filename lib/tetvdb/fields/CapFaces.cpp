// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/CapFaces.h"

#include "tetvdb/core/JoinedVectors.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/SolidSamples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tuple>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

Vec3i stepped(Vec3i voxel, int axis, std::int32_t step) {
  voxel[static_cast<std::size_t>(axis)] += step;
  return voxel;
}

// Finds the pairs of a block on different sides without a face between them.
void findPairs(const SolidSamples& solid, const openvdb::FloatGrid& levelSet, double voxel,
               const Vec3i& block, std::vector<CentrePair>& pairs) {
  const openvdb::tree::ValueAccessor<const openvdb::FloatTree, false> distances(
      levelSet.constTree());
  const auto absolute = [&](const Vec3i& v) {
    return std::abs(static_cast<double>(distances.getValue({v[0], v[1], v[2]})));
  };
  BlockSamples samples;
  solid.load(block, samples);
  for (int x = 0; x < kBlock; ++x)
    for (int y = 0; y < kBlock; ++y)
      for (int z = 0; z < kBlock; ++z)
        for (int axis = 0; axis < 3; ++axis) {
          const bool here = samples.isInside(x, y, z);
          if (here == samples.isInside(x + (axis == 0), y + (axis == 1), z + (axis == 2)))
            continue;
          const Vec3i first{block[0] + x, block[1] + y, block[2] + z};
          if (absolute(first) + absolute(stepped(first, axis, 1)) > voxel * (1 + 1e-4))
            pairs.push_back({first, axis});
        }
}

// The block that a voxel is in.
Vec3i blockOf(const Vec3i& voxel) {
  return {voxel[0] & -kBlock, voxel[1] & -kBlock, voxel[2] & -kBlock};
}

LatticePoint centreOf(const Vec3i& voxel) {
  constexpr auto unit = static_cast<double>(kUnitsPerVoxel);
  return {voxel[0] * unit, voxel[1] * unit, voxel[2] * unit};
}

// One of the four cells around a pair, by its lowest corner, and the crossing point of the pair.
struct CellCrossing {
  Vec3i cell;
  std::size_t pair;
  Vec3d at; // voxels
  bool operator<(const CellCrossing& o) const {
    return cell != o.cell ? cell < o.cell : pair < o.pair;
  }
};

constexpr int kAround[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

Vec3i cellAround(const CentrePair& pair, int k) {
  return stepped(stepped(pair.first, (pair.axis + 1) % 3, kAround[k][0] - 1), (pair.axis + 2) % 3,
                 kAround[k][1] - 1);
}

} // namespace

std::vector<CentrePair> findPairsWithoutFace(const openvdb::FloatGrid& levelSet,
                                             const openvdb::BoolGrid::Ptr& inside,
                                             const GridTransform& transform, const NodeBox* box,
                                             Progress& progress) {
  auto grids = std::make_shared<GridSet>();
  grids->all = {inside};
  const Volume volume(grids);
  const std::unique_ptr<SolidSamples> solid = solidSamples(volume, "");
  std::vector<Vec3i> blocks = solid->blocks(progress);
  const auto isElsewhere = [&](const Vec3i& block) {
    for (std::size_t k = 0; k < 3; ++k)
      if (nodeOf(block[k]) < box->low[k] || nodeOf(block[k]) >= box->high[k])
        return true;
    return false;
  };
  if (box != nullptr)
    blocks.erase(std::remove_if(blocks.begin(), blocks.end(), isElsewhere), blocks.end());
  std::vector<std::vector<CentrePair>> found(blocks.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.size(), 64), [&](const auto& range) {
    progress.check();
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      findPairs(*solid, levelSet, transform.voxelSize[0], blocks[i], found[i]);
  });
  return joinedVectors<CentrePair>(found);
}

std::size_t addCapFaces(const openvdb::FloatGrid& levelSet, const openvdb::BoolGrid::Ptr& inside,
                        const GridTransform& transform, const BoundaryWinding& boundary,
                        SnappedMesh& mesh, Boundary& faces, Progress& progress) {
  std::vector<CentrePair> pairs =
      findPairsWithoutFace(levelSet, inside, transform, nullptr, progress);
  const std::size_t count = pairs.size();
  addCapFaces(std::move(pairs), boundary, mesh, faces, progress);
  return count;
}

void addCapFaces(std::vector<CentrePair> pairs, const BoundaryWinding& boundary, SnappedMesh& mesh,
                 Boundary& faces, Progress& progress) {
  if (pairs.empty())
    return;
  tbb::parallel_sort(pairs.begin(), pairs.end(), [](const CentrePair& a, const CentrePair& b) {
    return std::tuple(blockOf(a.first), a.first, a.axis) <
           std::tuple(blockOf(b.first), b.first, b.axis);
  });

  std::vector<CellCrossing> crossings(4 * pairs.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pairs.size(), 256), [&](const auto& range) {
    progress.check();
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      Vec3d at{double(pairs[i].first[0]), double(pairs[i].first[1]), double(pairs[i].first[2])};
      at[static_cast<std::size_t>(pairs[i].axis)] +=
          halfCrossing(boundary.at(centreOf(pairs[i].first)),
                       boundary.at(centreOf(stepped(pairs[i].first, pairs[i].axis, 1))));
      for (int k = 0; k < 4; ++k)
        crossings[4 * i + static_cast<std::size_t>(k)] = {cellAround(pairs[i], k), i, at};
    }
  });
  std::sort(crossings.begin(), crossings.end());

  // A corner for every cell; the corner of each pair's cell.
  std::vector<std::uint32_t> corner(4 * pairs.size());
  mesh.points.resize(mesh.pointCount);
  for (std::size_t i = 0; i < crossings.size();) {
    Vec3d sum{0, 0, 0};
    const std::size_t first = i;
    for (; i < crossings.size() && crossings[i].cell == crossings[first].cell; ++i) {
      sum = plus(sum, crossings[i].at);
      const std::size_t pair = crossings[i].pair;
      for (int k = 0; k < 4; ++k)
        if (cellAround(pairs[pair], k) == crossings[i].cell)
          corner[4 * pair + static_cast<std::size_t>(k)] =
              static_cast<std::uint32_t>(mesh.points.size());
    }
    const double scale = static_cast<double>(kUnitsPerVoxel) / static_cast<double>(i - first);
    mesh.points.push_back(
        {std::round(sum[0] * scale), std::round(sum[1] * scale), std::round(sum[2] * scale)});
  }
  mesh.pointCount = mesh.points.size();
  mesh.points.push_back({0, 0, 0});
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::uint32_t* c = corner.data() + 4 * i;
    faces.faces.push_back({c[0], c[1], c[2], 1});
    faces.faces.push_back({c[0], c[2], c[3], 1});
  }
}

} // namespace tetvdb
