// SPDX-License-Identifier: Apache-2.0
//
// Distances from voxel centres to the nearest of many faces, within a radius.
#pragma once

#include "tetvdb/core/GroupItems.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/LeafDistance.h"
#include "tetvdb/voxelize/BoundaryFaces.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace tetvdb {

/// Bound on the error of a distance, voxels: 2^-21 along each axis for the snapping of corners, and
/// the error of single precision. It holds for radii up to kMaxHalfWidth.
constexpr double kDistanceError = 1e-5;

/// Faces assigned to the 128^3 nodes within reach. Refers to mesh and faces. Voxels are treated as
/// cubes; faces without area as segments or points.
class DistanceBand {
public:
  /// `radius` > 0, voxels. Parallel, 16 bytes per pair of a face and a node.
  DistanceBand(const SnappedMesh& mesh, const Boundary& faces, double radius, Progress& progress);

  /// Nodes with voxels that may be within the radius: ascending, distinct.
  const std::vector<NodeIndex>& nodes() const { return nodes_; }

  /// The faces within reach of nodes()[i]: nodeFaces()[starts()[i]] to nodeFaces()[starts()[i + 1]
  /// - 1].
  const LargeVector<NodeFace>& nodeFaces() const { return pairs_.items; }
  const std::vector<std::size_t>& starts() const { return pairs_.starts; }
  const SnappedMesh& mesh() const { return mesh_; }
  const Boundary& faces() const { return faces_; }
  double radius() const { return radius_; }

  /// Receives a leaf: its position in the node, (x * 16 + y) * 16 + z in leaves, and the squared
  /// distance of every voxel, voxels, [(x * 8 + y) * 8 + z]; numbers above the square of the radius
  /// represent all larger distances.
  using LeafSink = std::function<void(int leaf, const float* squared)>;

  /// Passes each leaf of nodes()[node] that may contain voxels within the radius to `sink` once,
  /// from several threads. A distance depends on the faces as a set: it is the minimum over faces
  /// of numbers that depend on each face only, with its corners in order of position. Thread-safe.
  /// Cost: about 10 ns per face and block of 2^3 voxels that it may be nearest to.
  void rasterize(std::size_t node, const LeafSink& sink) const;

private:
  const SnappedMesh& mesh_;
  const Boundary& faces_;
  double radius_;
  GroupedItems<NodeFace> pairs_;
  std::vector<NodeIndex> nodes_;
};

/// Expected number of leaves of a level set of these faces in each node of the band.
std::vector<float> estimateNodeLeaves(const DistanceBand& band);

/// Expected number of leaves of a level set of these faces.
double estimateBandLeaves(const SnappedMesh& mesh, const Boundary& faces, double radius);

} // namespace tetvdb
