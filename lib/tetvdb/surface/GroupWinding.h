// SPDX-License-Identifier: Apache-2.0
//
// Winding numbers at sample points, separately for groups of faces: the contribution of each group
// to the sum. Reversing a group negates its contribution.
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

/// Sample points for winding numbers: spread over a slightly enlarged box of the mesh, and on both
/// sides of faces, at distances from small to about the size of their group.
struct WindingSamples {
  std::vector<Vec3d> points;
  std::size_t spread = 0; ///< the number of leading points that are spread over the box
  double volume = 0;      ///< of the enlarged box
};

/// About `count` points, some of which belong to each group. They depend only on the mesh, the
/// order of its faces and the groups.
WindingSamples windingSamples(const TriangleMesh& mesh, const std::vector<std::uint32_t>& groupOf,
                              std::uint32_t groupCount, std::size_t count);

class GroupWinding {
public:
  /// `groupOf`: by face, below `groupCount`; EdgeTable::kNone: left out. `turned`: by face, 1 if
  /// reversed. Costs one ray per sample, and 20 ns per sample and edge at which a group is not
  /// closed.
  GroupWinding(const TriangleMesh& mesh, const EdgeTable& edges, const TriangleScene& scene,
               const std::vector<std::uint32_t>& groupOf, std::uint32_t groupCount,
               const std::vector<std::uint8_t>& turned, const std::vector<Vec3d>& samples,
               Progress& progress);

  /// The contributions of a group, by sample.
  const float* of(std::uint32_t group) const {
    return values_.data() + std::size_t(group) * samples_;
  }
  std::size_t sampleCount() const { return samples_; }

  /// The number of edges at which groups are not closed, over all groups: determines the cost.
  static std::size_t openEdges(const EdgeTable& edges, const std::vector<std::uint32_t>& groupOf,
                               const std::vector<std::uint8_t>& turned);

private:
  std::size_t samples_;
  std::vector<float> values_;
};

} // namespace tetvdb
