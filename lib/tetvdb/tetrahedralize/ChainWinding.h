// SPDX-License-Identifier: Apache-2.0
//
// The winding number of triangles with multiplicities, closed or not, at many points.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/RimWinding.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// N + s of geometry/RimWinding.h: faces below a point, counted exactly, and what the rim adds.
/// Immutable once made; thread-safe.
class ChainWinding {
public:
  /// Counts `weight` times. Coordinates are whole numbers below 2^39: the working lattice's, four
  /// times as fine, so that centres of tets have whole coordinates too.
  struct Face {
    LatticePoint a, b, c;
    std::int32_t weight;
  };

  /// `rim` is the boundary of `faces`; none: they are closed, and the winding number is exact.
  ChainWinding(std::vector<Face> faces, std::vector<RimEdge> rim);

  /// Whether the winding number stays farther than `kFromHalf` from 0.5, 1.5 and so on all over a
  /// ball, apart from the faces in it: it is then the same whole number, rounded, wherever one gets
  /// to within the ball without crossing a face. A proof, up to the error of the rim's sums; no
  /// where the rim is in reach. The cost of a few points.
  bool staysRound(const Vec3d& centre, double reach) const;
  static constexpr double kFromHalf = 0.02;

  /// At points moved by (e, e^2, e^3), e -> 0+; on a face that is one of its sides. Points that lie
  /// near one another are worked on together: about 0.5 us a point, and some ns for each edge of a
  /// rim nearby. Parallel; the same for any number of threads.
  std::vector<double> at(const std::vector<LatticePoint>& points, Progress& progress) const;

private:
  struct Group;
  void atGroup(const Group& group, double* winding) const;
  std::int64_t facesBelow(const LatticePoint& p) const;
  static std::int32_t crossing(const Face& face, const LatticePoint& p);

  std::vector<Face> faces_;
  BoxTree tree_;
  RimWinding rim_;
};

} // namespace tetvdb
