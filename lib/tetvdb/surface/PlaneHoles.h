// SPDX-License-Identifier: Apache-2.0
//
// The holes of a mesh that lie in a plane, and triangles over them.
//
//   tetvdb::PlaneHoles holes(mesh, edges);
//   for (const std::vector<std::size_t>& group : holes.groups())
//     if (holes.triangulate(group, corners))
//       ...
#pragma once

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/BoundaryLoops.h"
#include "tetvdb/surface/EdgeTable.h"

#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

namespace tetvdb {

/// Groups the boundary loops of a mesh by hole. The mesh must outlive it; points may be added.
class PlaneHoles {
public:
  PlaneHoles(const TriangleMesh& mesh, const EdgeTable& edges);

  const std::vector<BoundaryLoop>& loops() const { return loops_; }
  /// Every loop is in one group, the outline of a hole first: the others lie within it in its
  /// plane, in the opposite direction (an annular hole). A loop that is not plane is a group alone.
  const std::vector<std::vector<std::size_t>>& groups() const { return groups_; }
  bool isFlat(const std::vector<std::size_t>& group) const { return planes_[group[0]].flat; }
  std::size_t edgesOf(const std::vector<std::size_t>& group) const;

  /// Appends three points per triangle over a hole, and no point; their edges are not taken()
  /// where that is possible. Returns false for a hole that is not plane or intersects itself.
  bool triangulate(const std::vector<std::size_t>& group,
                   std::vector<std::uint32_t>& corners) const;

  /// Whether faces of the mesh, or those that were take()n, have an edge between two points of
  /// loops.
  bool isTaken(std::uint32_t a, std::uint32_t b) const { return taken_.count(key(a, b)) > 0; }
  /// Adds the edges of triangles, from index `first` of their corners on.
  void take(const std::vector<std::uint32_t>& corners, std::size_t first);

private:
  struct Plane {
    Vec3d origin{0, 0, 0}, normal{0, 0, 0}; ///< the loop is counter-clockwise around the normal
    double area = 0, size = 0;              ///< of the loop; diagonal of its box
    Box box;
    bool flat = false;
  };

  static std::uint64_t key(std::uint32_t a, std::uint32_t b);
  static Plane planeOf(const std::vector<Vec3d>& points, const BoundaryLoop& loop);
  void group();
  bool isAround(std::size_t loop, const Vec3d& p) const;

  const TriangleMesh& mesh_;
  const std::vector<BoundaryLoop> loops_;
  std::vector<Plane> planes_; ///< by loop
  std::vector<std::vector<std::size_t>> groups_;
  std::unordered_set<std::uint64_t> taken_;
};

} // namespace tetvdb
