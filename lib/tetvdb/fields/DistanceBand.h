// SPDX-License-Identifier: Apache-2.0
//
// Distances from voxel centres to the nearest of many faces, where that is within a radius.
#pragma once

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
/// what single precision adds. It holds for radii up to kMaxHalfWidth.
constexpr double kDistanceError = 1e-5;

/// Faces placed among the 128^3 nodes that they come near to. Refers to mesh and faces. Voxels are
/// taken for cubes; faces of no area count as the segments or points that they are.
class DistanceBand {
public:
  /// `radius` > 0, voxels. Parallel, 16 bytes for every face and node.
  DistanceBand(const SnappedMesh& mesh, const Boundary& faces, double radius, Progress& progress);

  /// Nodes with voxels that may be within the radius: ascending, none twice.
  const std::vector<NodeIndex>& nodes() const { return nodes_; }

  /// The faces that come near to nodes()[i]: nodeFaces()[starts()[i]] to
  /// nodeFaces()[starts()[i + 1]], that not included.
  const std::vector<NodeFace>& nodeFaces() const { return pairs_; }
  const std::vector<std::uint64_t>& starts() const { return starts_; }
  const SnappedMesh& mesh() const { return mesh_; }
  const Boundary& faces() const { return faces_; }
  double radius() const { return radius_; }

  /// Receives a leaf: its position in the node, (x * 16 + y) * 16 + z in leaves, and the squared
  /// distance of every voxel, voxels, [(x * 8 + y) * 8 + z]; a number above the square of the
  /// radius represents all that are farther.
  using LeafSink = std::function<void(int leaf, const float* squared)>;

  /// Hands the leaves of nodes()[node] that may hold voxels within the radius to `sink`, each once,
  /// from several threads. A distance depends on the faces as a set: it is the minimum over faces
  /// of numbers that each face gives alone, from its corners in order of position. Thread-safe.
  /// Cost: about 5 ns for each row of eight voxels that comes near to a face.
  void rasterize(std::size_t node, const LeafSink& sink) const;

private:
  const SnappedMesh& mesh_;
  const Boundary& faces_;
  double radius_;
  std::vector<NodeFace> pairs_;
  std::vector<NodeIndex> nodes_;
  std::vector<std::uint64_t> starts_;
};

/// Leaves that a level set of these faces is expected to have.
double estimateBandLeaves(const SnappedMesh& mesh, const Boundary& faces, double radius);

} // namespace tetvdb
