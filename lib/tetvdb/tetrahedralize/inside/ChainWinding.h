// SPDX-License-Identifier: Apache-2.0
//
// The winding number of triangles with multiplicities, closed or not, at many points.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/geometry/BoxTree.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Points in groups of some that are near one another, for which faces are looked for once.
struct PointGroups {
  /// Columns are narrow but as high as the points: what is below a column is below few others. Sums
  /// over boundary edges take less time for cubes.
  enum class Shape { Cubes, Columns };
  PointGroups(const std::vector<LatticePoint>& points, Shape shape);

  std::size_t pointCount() const { return numbers.size(); }
  std::size_t size() const { return begins.size() - 1; }

  std::vector<double> x, y, z;        ///< in order of groups
  std::vector<std::uint32_t> numbers; ///< of these points, in the order in which they were given
  std::vector<std::uint32_t> begins;  ///< the first point of each group, and their number
};

/// N + s of geometry/BoundaryWinding.h: faces below a point, counted exactly, and what the boundary
/// edges add. Immutable once made; thread-safe.
class ChainWinding {
public:
  /// Counts `weight` times. Coordinates are whole numbers below 2^39: the working lattice's, four
  /// times as fine, so that centres of tets have whole coordinates too.
  struct Face {
    LatticePoint a, b, c;
    std::int32_t weight;
  };

  /// `boundary` is the boundary of `faces`; none: they are closed, and the winding number is exact.
  ChainWinding(std::vector<Face> faces, std::vector<BoundaryEdge> boundary);

  std::size_t boundaryEdges() const { return boundary_.edgeCount(); }

  /// Whether the winding number stays farther than `kFromHalf` from 0.5, 1.5 and so on in a whole
  /// ball, apart from the faces in it: rounded, it is then the same in all of the ball that is
  /// connected without crossing a face. Yes is a proof, up to the error of the sums over boundary
  /// edges; the answer is no where boundary edges are near. The cost of a few points.
  bool staysRound(const Vec3d& centre, double reach) const;
  static constexpr double kFromHalf = 0.02;

  /// At points moved by (e, e^2, e^3), e -> 0+; so that no point is on a face. Points near one
  /// another are evaluated together: about 0.5 us a point, and some ns for each
  /// boundary edge nearby. Parallel; the same for any number of threads.
  std::vector<double> at(const std::vector<LatticePoint>& points, Progress& progress) const;
  /// The same, in the order in which the points were given. `groups` serve any number of windings;
  /// cubes are for those with boundary edges.
  std::vector<double> at(const PointGroups& groups, Progress& progress) const;

private:
  void atGroup(const PointGroups& groups, std::size_t group, double* winding) const;
  std::int64_t facesBelow(const LatticePoint& p) const;
  static std::int32_t crossing(const Face& face, const LatticePoint& p);

  std::vector<Face> faces_;
  BoxTree tree_;
  BoundaryWinding boundary_;
};

} // namespace tetvdb
