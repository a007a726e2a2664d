// SPDX-License-Identifier: Apache-2.0
//
// Winding numbers at sample points, apart for groups of a mesh's faces: what each group adds to the
// whole, so that turning a group is one subtraction.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/TriangleScene.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Points where winding numbers are asked for: spread over a little more than the mesh's box, and
/// beside faces, on both sides, from near to about as far as their group is large.
struct WindingSamples {
  std::vector<Vec3d> points;
  std::size_t spread = 0; ///< the first of them, all over
  double volume = 0;      ///< of what these are spread over
};

/// About `count` points, of which every group has some of its own. They follow from the mesh, the
/// order of its faces and the groups alone.
WindingSamples windingSamples(const TriangleMesh& mesh, const std::vector<std::uint32_t>& groupOf,
                              std::uint32_t groupCount, std::size_t count);

class GroupWinding {
public:
  /// `groupOf`: by face, below `groupCount`; EdgeTable::kNone: left out. `turned`: by face, 1 where
  /// it counts as reversed. Costs a ray a sample, and 20 ns a sample and edge at which a group
  /// does not close.
  GroupWinding(const TriangleMesh& mesh, const EdgeTable& edges, const TriangleScene& scene,
               const std::vector<std::uint32_t>& groupOf, std::uint32_t groupCount,
               const std::vector<std::uint8_t>& turned, const std::vector<Vec3d>& samples,
               Progress& progress);

  /// Of a group, one a sample.
  const float* of(std::uint32_t group) const { return &values_[std::size_t(group) * samples_]; }
  std::size_t sampleCount() const { return samples_; }

  /// Edges at which groups do not close, all together: what the constructor's cost grows with.
  static std::size_t openEdges(const EdgeTable& edges, const std::vector<std::uint32_t>& groupOf,
                               const std::vector<std::uint8_t>& turned);

private:
  std::size_t samples_;
  std::vector<float> values_;
};

} // namespace tetvdb
