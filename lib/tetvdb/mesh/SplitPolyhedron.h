// SPDX-License-Identifier: Apache-2.0
//
// The order of vertices that splitCells() cuts by, and the cut of one polyhedron.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/Attribute.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace tetvdb {

/// Whether point a comes before point b: by x, then y, then z, then the index.
inline bool isBefore(const Vec3d* points, std::uint32_t a, std::uint32_t b) {
  const Vec3d& p = points[a];
  const Vec3d& q = points[b];
  if (p[0] != q[0])
    return p[0] < q[0];
  if (p[1] != q[1])
    return p[1] < q[1];
  if (p[2] != q[2])
    return p[2] < q[2];
  return a < b;
}

/// Six times the signed volume of a tet, rounded: for judgement, not for exact signs.
inline double sixfoldVolume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const Vec3d u{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const Vec3d v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const Vec3d w{d[0] - a[0], d[1] - a[1], d[2] - a[2]};
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
         u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/// Faces of a polyhedron: face f has nodes[begin[f]] up to nodes[begin[f + 1]].
struct PolyhedronFaces {
  std::vector<std::uint32_t> nodes;
  std::vector<std::size_t> begin{0};

  std::size_t count() const { return begin.size() - 1; }
};

/// Decodes a Polyhedron cell of a CellMesh: `size` numbers, the face count and then each face's
/// node count and nodes. Without faces where the numbers contradict each other.
PolyhedronFaces polyhedronFaces(const std::uint32_t* numbers, std::size_t size);

enum class PolyhedronCut : std::uint8_t {
  None,         ///< no tets: its faces do not close or fit no orientation, or most is inverted
  FromVertex,   ///< from its smallest vertex
  AroundCentre, ///< around a point that was added
  Concave       ///< likewise, and some of its tets, up to half of the others' volume, are inverted
};

/// Cuts one polyhedron after another: its smallest vertex is joined with the faces that do not hold
/// it, each fanned from its own smallest vertex. Where these are not all seen from that vertex from
/// one side, a point is added at the mean of its vertices, and joined with all faces. A face of
/// five corners or more that is not flat is fanned from a point that is added at the mean of its
/// corners. So neighbours cut a face alike.
class PolyhedronCutter {
public:
  /// Points are added to `points`, which must outlive the cutter.
  explicit PolyhedronCutter(std::vector<Vec3d>& points) : points_(points), first_(points.size()) {}

  /// Appends the cell's tets.
  PolyhedronCut cut(PolyhedronFaces faces, std::vector<std::uint32_t>& tets);

  /// Gives an array of the points values for those that were added: the mean of the vertices', of
  /// whole numbers that of the first vertex. Arrays of another length remain as they are.
  void addValues(Attribute& array) const;

private:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  std::uint32_t addPoint(const Vec3d& p, const std::vector<std::uint32_t>& vertices);
  std::uint32_t centreOf(const std::uint32_t* corners, std::size_t count);
  std::array<double, 2> join(const PolyhedronFaces& faces, std::uint32_t apex,
                             std::vector<std::uint32_t>& tets) const;

  std::vector<Vec3d>& points_;
  std::size_t first_;                   ///< point that was added
  std::vector<std::size_t> begin_{0};   ///< of the vertices of each of them
  std::vector<std::uint32_t> vertices_; ///< ascending
  std::unordered_multimap<std::uint64_t, std::uint32_t> centres_; ///< of faces
  std::vector<std::uint32_t> ofFaces_; ///< of the cell at hand; kNone: flat
};

} // namespace tetvdb
