// SPDX-License-Identifier: Apache-2.0
//
// The input and the results of DeviceVoxelizer::distances(): distances to faces in a narrow band
// around them, leaf by leaf. Contains no type of CUDA or NanoVDB.
#pragma once

#include "tetvdb/geometry/LeafDistance.h"

#include <cstdint>

namespace tetvdb::nano {

/// Faces in host memory.
struct FacesView {
  const LatticePoint* points = nullptr;
  std::uint64_t pointCount = 0;
  const std::uint32_t* faces = nullptr; ///< three points each, and a number that is ignored
  std::uint64_t faceCount = 0;
};

/// Faces placed among the 128^3 nodes that they come near to, as fields/DistanceBand.h places them;
/// arrays in host memory.
struct DistanceJob {
  FacesView faces;
  const NodeFace* nodeFaces = nullptr;   ///< by node
  const std::uint64_t* starts = nullptr; ///< of each node's in nodeFaces, and their number
  std::uint64_t nodeCount = 0;
  double radius = 0; ///< voxels
};

/// Whole nodes of the job, in its order.
struct DistanceBatch {
  std::uint64_t firstNode = 0, nodeCount = 0;
  const std::uint64_t* starts = nullptr; ///< of each node's leaves in the batch, and their number
  const std::uint16_t* leaves = nullptr; ///< their positions, (x * 16 + y) * 16 + z, ascending
  /// 512 a leaf, [64 x + 8 y + z]: squared distances, voxels; a number above the square of the
  /// radius represents all that are farther.
  const float* squared = nullptr;
};

class DistanceReceiver {
public:
  virtual ~DistanceReceiver() = default;
  /// Receives every node once, including those without leaves. The batch is invalid after the
  /// return. If several devices share a job, their threads call at the same time.
  virtual void take(const DistanceBatch& batch) = 0;
};

} // namespace tetvdb::nano
