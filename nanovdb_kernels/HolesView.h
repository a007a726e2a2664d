// SPDX-License-Identifier: Apache-2.0
//
// What the winding number of an open soup takes beside the crossings of its faces: the triangles
// over its holes, and the leaves in which it may pass a half off the faces
// (voxelize/WindingBand.h). Contains no type of CUDA or NanoVDB.
#pragma once

#include "tetvdb/geometry/LocalExpansion.h"
#include "tetvdb/geometry/TriangleClusters.h"

#include <cstdint>

namespace tetvdb::nano {

/// WindingBand::Cube of a leaf.
struct WindingLeaf {
  std::int32_t first[3];             ///< voxel
  std::uint32_t clusters, triangles; ///< how many are near
  std::uint64_t near; ///< the first of them in HolesView::near, clusters before triangles
};

/// Evaluates on the host what the device leaves: octants in which a solid angle takes more than its
/// formula, or that more is near to than a team can hold.
class OctantEvaluator {
public:
  virtual ~OctantEvaluator() = default;
  /// `octants`: leaf * 8 + octant each. Sets needed[i], and where it is true the 64 values from
  /// values[64 * i] on: those of WindingBand::Octants::evaluate(). Several devices call at once.
  virtual void evaluate(const std::uint32_t* octants, std::uint64_t count, bool* needed,
                        double* values) = 0;
};

/// Arrays in host memory.
struct HolesView {
  const FillTriangle* triangles = nullptr;
  const double* areas = nullptr; ///< of the triangles, by weight
  std::uint64_t triangleCount = 0;
  const TriangleClusters::Cluster* clusters = nullptr;
  std::uint64_t clusterCount = 0;
  const WindingLeaf* leaves = nullptr; ///< at most kMaxWindingLeaves
  const Expansion* far = nullptr;      ///< by leaf
  std::uint64_t leafCount = 0;
  const std::uint32_t* near = nullptr; ///< numbers of clusters and triangles
  std::uint64_t nearCount = 0;
  const Vec3d* points = nullptr;           ///< WindingBand::octantPoints()
  const ExpansionTables* tables = nullptr; ///< expansionTables()
  double tolerance = 0;                    ///< WindingBand::tolerance()
  OctantEvaluator* evaluator = nullptr;
};

constexpr std::uint64_t kMaxWindingLeaves = std::uint64_t(1) << 22;

} // namespace tetvdb::nano
