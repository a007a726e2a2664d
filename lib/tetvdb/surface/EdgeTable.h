// SPDX-License-Identifier: Apache-2.0
//
// Finds the faces that meet at each edge.
//
//   tetvdb::EdgeTable edges(mesh);
//   for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
//     if (edges.sides(edge).size() == 1)
//       boundary.push_back(edge);
#pragma once

#include "tetvdb/core/LargeVector.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tetvdb {

/// Side s = 3 face + k of a mesh is directed from corner k of the face to corner k + 1. An edge is
/// an unordered pair of points with all sides between them, in either direction. Faces with a
/// repeated point are left out. The corners must outlive the table and must not change.
class EdgeTable {
public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

  /// Parallel, linear in the faces (the sides at each point are sorted), independent of the number
  /// of threads. Throws Error(Limit) for 2^32 / 3 faces or more.
  explicit EdgeTable(const TriangleMesh& mesh) : EdgeTable(mesh.triangles, mesh.points.size()) {}
  /// The same for corners, three point numbers per face.
  EdgeTable(const std::vector<std::uint32_t>& corners, std::size_t pointCount)
      : EdgeTable(corners.data(), corners.size() / 3, pointCount) {}
  EdgeTable(const std::uint32_t* corners, std::size_t faceCount, std::size_t pointCount);

  /// The sides of an edge, ascending.
  struct Sides {
    const std::uint32_t* first;
    const std::uint32_t* last;
    const std::uint32_t* begin() const { return first; }
    const std::uint32_t* end() const { return last; }
    std::size_t size() const { return static_cast<std::size_t>(last - first); }
    std::uint32_t operator[](std::size_t i) const { return first[i]; }
  };

  std::uint32_t edgeCount() const { return static_cast<std::uint32_t>(points_.size()); }
  /// Edges ascend by (low point, high point).
  std::uint32_t lowPoint(std::uint32_t edge) const { return points_[edge][0]; }
  std::uint32_t highPoint(std::uint32_t edge) const { return points_[edge][1]; }
  Sides sides(std::uint32_t edge) const {
    return {sides_.data() + first_[edge], sides_.data() + first_[edge + 1]};
  }
  /// The edge of a side; kNone for faces that were left out.
  std::uint32_t edgeOf(std::uint32_t side) const { return edgeOf_[side]; }
  bool hasFace(std::uint32_t face) const { return edgeOf_[3 * std::size_t(face)] != kNone; }

  static std::uint32_t faceOf(std::uint32_t side) { return side / 3; }
  /// The next and the previous side of the same face.
  static std::uint32_t next(std::uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
  static std::uint32_t previous(std::uint32_t side) { return side % 3 == 0 ? side + 2 : side - 1; }
  /// Whether a side is directed from its edge's low point to the high one.
  bool ascends(std::uint32_t side) const { return corners_[side] < corners_[next(side)]; }
  /// The number of ascending minus that of descending sides: 0 if the faces cancel.
  int imbalance(std::uint32_t edge) const {
    int sum = 0;
    for (const std::uint32_t side : sides(edge))
      sum += ascends(side) ? 1 : -1;
    return sum;
  }
  /// Whether exactly two faces of consistent orientation meet at the edge.
  bool isManifold(std::uint32_t edge) const {
    return sides(edge).size() == 2 && imbalance(edge) == 0;
  }
  /// The corner of the face that is not on the side.
  std::uint32_t opposite(std::uint32_t side) const { return corners_[previous(side)]; }

private:
  const std::uint32_t* corners_;
  LargeVector<std::array<std::uint32_t, 2>> points_;
  LargeVector<std::uint32_t> first_; ///< in sides_; one more than there are edges
  LargeVector<std::uint32_t> sides_;
  LargeVector<std::uint32_t> edgeOf_;
};

} // namespace tetvdb
