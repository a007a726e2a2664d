// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/TreeEstimate.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/voxelize/BoundaryRaster.h"
#include "tetvdb/voxelize/TreeBuilder.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace tetvdb {

double TreeEstimate::bytes(const std::vector<GridKind>& grids) const {
  double leaf = 0;
  for (GridKind kind : grids)
    leaf += static_cast<double>(leafBytes(kind));
  return leaves * leaf +
         lowerNodes * static_cast<double>(kLowerNodeBytes) * static_cast<double>(grids.size());
}

double TreeEstimate::levelBytes(const LevelRange& levels, std::size_t grids) const {
  return levelShare(levels) * static_cast<double>(grids) * bytes({GridKind::Density});
}

double levelShare(const LevelRange& levels) {
  double share = 0;
  for (int k = std::max(levels.first, 1); k <= levels.last; ++k)
    share += std::ldexp(1.0, -2 * k);
  return share;
}

TreeEstimate estimateByBox(const SnappedMesh& mesh) {
  const auto nodes = [&](int shift) {
    const auto along = [&](double low, double high) {
      return static_cast<double>((floorVoxel(high) >> shift) - (ceilVoxel(low) >> shift) + 1);
    };
    return std::max(along(mesh.boxMin.x, mesh.boxMax.x), 0.0) *
           std::max(along(mesh.boxMin.y, mesh.boxMax.y), 0.0) *
           std::max(along(mesh.boxMin.z, mesh.boxMax.z), 0.0);
  };
  return {nodes(3), nodes(7)};
}

// There is a lower node for about 256 leaves, and small components have a node of their own.
TreeEstimate estimateByBoundary(const SnappedMesh& mesh, const Boundary& boundary) {
  const auto leaves = static_cast<double>(estimateBoundaryLeaves(mesh, boundary));
  const TreeEstimate box = estimateByBox(mesh);
  return {std::min(leaves, box.leaves), std::min(leaves / 128 + 64, box.lowerNodes)};
}

namespace {

// Of all tets, voxels and faces of voxels.
struct Sum {
  double volume = 0, area = 0;
};

Sum sumOfTets(const SnappedMesh& mesh) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.tetCount, 16384), Sum{},
      [&](const tbb::blocked_range<std::size_t>& range, Sum s) {
        for (std::size_t t = range.begin(); t != range.end(); ++t) {
          const std::uint32_t* v = mesh.tets + 4 * t;
          double e[3][3];
          for (int i = 0; i < 3; ++i) {
            const LatticePoint &p = mesh.points[v[i + 1]], &o = mesh.points[v[0]];
            e[i][0] = (p.x - o.x) * kVoxelsPerUnit;
            e[i][1] = (p.y - o.y) * kVoxelsPerUnit;
            e[i][2] = (p.z - o.z) * kVoxelsPerUnit;
          }
          double det = 0, area = 0, rest[3] = {0, 0, 0};
          for (int i = 0; i < 3; ++i) {
            const double* a = e[i];
            const double* b = e[(i + 1) % 3];
            const double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                 a[0] * b[1] - a[1] * b[0]};
            for (int k = 0; k < 3; ++k) {
              area += std::abs(n[k]);
              rest[k] += n[k];
            }
            if (i == 0)
              det = n[0] * e[2][0] + n[1] * e[2][1] + n[2] * e[2][2];
          }
          area += std::abs(rest[0]) + std::abs(rest[1]) + std::abs(rest[2]);
          s.volume += std::abs(det) / 6;
          s.area += area / 2;
        }
        return s;
      },
      [](Sum a, const Sum& b) {
        return Sum{a.volume + b.volume, a.area + b.area};
      });
}

// A leaf at the surface is partly outside: a third more for those of thin or small meshes.
double leavesOf(double volume) {
  return volume / 512 * 1.35;
}

TreeEstimate withinBox(double leaves, const SnappedMesh& mesh) {
  const TreeEstimate box = estimateByBox(mesh);
  return {std::min(leaves, box.leaves), std::min(leaves / 128 + 64, box.lowerNodes)};
}

} // namespace

TreeEstimate estimateByTets(const SnappedMesh& mesh) {
  const Sum sum = sumOfTets(mesh);
  // Interior faces are counted by both their tets.
  return withinBox(std::min(sum.area / 2 / 64, leavesOf(sum.volume)) + 64, mesh);
}

TreeEstimate estimateByVolume(const SnappedMesh& mesh) {
  return withinBox(leavesOf(sumOfTets(mesh).volume) + 64, mesh);
}

void requireMemory(double bytes, const VoxelizeOptions& options) {
  const std::size_t limit = options.maxMemory != 0 ? options.maxMemory : availableBytes();
  if (bytes <= static_cast<double>(limit))
    return;
  throw Error(Status::Limit, "",
              fmt::format("voxelizing needs about {:.2f} GB, the limit is {:.2f} GB", bytes * 1e-9,
                          static_cast<double>(limit) * 1e-9),
              options.maxMemory != 0
                  ? "raise `max_memory`, use larger voxels or fewer grids"
                  : "use larger voxels, fewer grids or a machine with more memory");
}

} // namespace tetvdb
