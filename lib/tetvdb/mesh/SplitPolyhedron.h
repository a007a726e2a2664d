// SPDX-License-Identifier: Apache-2.0
//
// The order of vertices that splitCells() cuts by, and the cut of one polyhedron.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstddef>
#include <cstdint>
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

/// Adds the tets of a polyhedron to `tets`: its smallest vertex joined with the faces that do not
/// hold it, each fanned from its own smallest vertex. False, and nothing added, where the faces do
/// not close, do not fit one orientation, or are not all seen from that vertex from one side.
bool splitPolyhedron(PolyhedronFaces faces, const std::vector<Vec3d>& points,
                     std::vector<std::uint32_t>& tets);

} // namespace tetvdb
