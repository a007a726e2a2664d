// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/DistanceOnDevice.h"

#include <cstdint>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb {

nano::FacesView facesViewOf(const SnappedMesh& mesh, const Boundary& boundary) {
  static_assert(sizeof(BoundaryFace) == 4 * sizeof(std::uint32_t));
  const std::vector<BoundaryFace>& faces = boundary.faces;
  return {mesh.points.data(), mesh.pointCount, faces.empty() ? nullptr : &faces.front().a,
          faces.size()};
}

nano::LevelSetJob levelSetJobFor(const GridTransform& transform, double halfWidth) {
  nano::LevelSetJob job;
  job.voxelSize = transform.voxelSize[0];
  for (std::size_t k = 0; k < 3; ++k)
    job.origin[k] = transform.origin[k];
  job.halfWidth = halfWidth;
  return job;
}

nano::DistanceJob distanceJobFor(const DistanceBand& band) {
  nano::DistanceJob job;
  job.faces = facesViewOf(band.mesh(), band.faces());
  job.nodeFaces = band.nodeFaces().data();
  job.starts = band.starts().data();
  job.nodeCount = band.nodes().size();
  job.radius = band.radius();
  return job;
}

void NodeReceiver::take(const nano::DistanceBatch& batch) {
  const auto takeNode = [&](std::uint64_t node) {
    const auto hand = [&](const DistanceBand::LeafSink& sink) {
      tbb::parallel_for(
          tbb::blocked_range<std::uint64_t>(batch.starts[node], batch.starts[node + 1], 64),
          [&](const auto& range) {
            for (std::uint64_t i = range.begin(); i != range.end(); ++i)
              sink(batch.leaves[i], batch.squared + kVoxelsInLeaf * i);
          });
    };
    take_(batch.firstNode + node, hand);
  };
  arena_.execute([&] { tbb::parallel_for(std::uint64_t(0), batch.nodeCount, takeNode); });
}

void rasterizeBandOn(DeviceSet& devices, const DistanceBand& band, const NodeTaker& take,
                     const Progress& progress) {
  if (band.nodes().empty())
    return;
  NodeReceiver receiver(take);
  devices.distances(distanceJobFor(band), receiver, progress);
}

} // namespace tetvdb
