// SPDX-License-Identifier: Apache-2.0
//
// Level sets with the distances of the device or its twin, and those of the CPU, which shares the
// arithmetic of a face and a leaf but not how leaves and their faces are found; and distances leaf
// by leaf for judges that share nothing.
#pragma once

#include "Meshes.h"
#include "tetvdb/fields/DistanceOnDevice.h"
#include "tetvdb/fields/LevelSet.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

/// Faces, what is inside, and how a level set of them is asked for.
struct BandCase {
  SnappedMesh mesh;
  Boundary faces;
  openvdb::BoolGrid::Ptr inside = openvdb::BoolGrid::create(false);
  GridTransform transform;
  double halfWidth = 3, shell = 0;
};

/// The solid of a mesh of tets.
inline BandCase bandOf(const TetMesh& mesh, const GridTransform& transform = {},
                       double halfWidth = 3, double shell = 0) {
  Report report;
  Progress progress;
  VoxelizeOptions options;
  options.voxelSize = transform.voxelSize;
  options.origin = transform.origin;
  options.grids = {GridKind::Mask};
  options.allowEmpty = true;
  const Voxelization made = voxelize(mesh, options, report, progress);
  BandCase band;
  band.mesh = snapMesh(mesh, transform, progress);
  band.faces = boundaryFaces(band.mesh, progress);
  band.inside = openvdb::gridPtrCast<openvdb::BoolGrid>(made.volume.grids().all.front());
  band.transform = transform;
  band.halfWidth = halfWidth;
  band.shell = shell;
  return band;
}

/// Faces alone, corners in voxels; nothing is inside.
inline BandCase bandOfFaces(const std::vector<Vec3d>& points,
                            const std::vector<std::uint32_t>& corners, double halfWidth = 3) {
  Progress progress;
  BandCase band;
  band.mesh = snapPoints(points, {}, progress);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    band.faces.faces.push_back({corners[i], corners[i + 1], corners[i + 2], 1});
  band.halfWidth = halfWidth;
  return band;
}

inline std::string levelSetHash(const BandCase& band, const BandRasterizer& rasterize) {
  Progress progress;
  auto grids = std::make_shared<GridSet>();
  grids->all.push_back(levelSet(band.mesh, band.faces, *band.inside, band.transform, band.halfWidth,
                                band.shell, rasterize, progress));
  return hash(Volume(std::move(grids)));
}

/// rasterizeBand() by distances(job, receiver), the device's or its twin's.
template <typename Distances>
BandRasterizer rasterizerBy(const Distances& distances) {
  return [distances](const DistanceBand& band, const NodeTaker& take, Progress&) {
    NodeReceiver receiver(take);
    distances(distanceJobFor(band), receiver);
  };
}

/// All leaves of a band by their first voxels.
struct CollectedBand : nano::DistanceReceiver {
  using Leaf = std::vector<float>;
  std::map<Vec3i, Leaf> leaves;
  std::vector<int> taken; ///< how often each node was
  int batches = 0;

  explicit CollectedBand(const DistanceBand& of) : taken(of.nodes().size(), 0), band_(of) {}

  void take(const nano::DistanceBatch& batch) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++batches;
    for (std::uint64_t n = 0; n < batch.nodeCount; ++n) {
      ++taken.at(batch.firstNode + n);
      const NodeIndex& node = band_.nodes()[batch.firstNode + n];
      for (std::uint64_t i = batch.starts[n]; i < batch.starts[n + 1]; ++i) {
        const int leaf = batch.leaves[i];
        const float* squared = batch.squared + 512 * i;
        leaves[{node[0] * 128 + (leaf >> 8) * 8, node[1] * 128 + (leaf >> 4 & 15) * 8,
                node[2] * 128 + (leaf & 15) * 8}] = Leaf(squared, squared + 512);
      }
    }
  }

private:
  const DistanceBand& band_;
  std::mutex mutex_;
};

} // namespace tetvdb
