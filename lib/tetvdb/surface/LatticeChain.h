// SPDX-License-Identifier: Apache-2.0
//
// The faces of a mesh on a lattice, as removeCrossings() cuts them.
#pragma once

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/TrimChain.h"
#include "tetvdb/surface/WeldedFaces.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The faces on a lattice, and their numbers in the mesh.
struct LatticeChain {
  WeldedFaces welded;
  std::vector<std::uint32_t> pointOf; ///< by point of `welded`: point of the mesh
  std::vector<std::uint32_t> source;  ///< by face of `welded`: face of the mesh
  Vec3d origin{0, 0, 0};
  double scale = 1; ///< lattice units per world unit: a power of two

  Vec3d toWorld(const Vec3d& p) const { return plus(origin, times(p, 1 / scale)); }
  Vec3d toLattice(const Vec3d& p) const {
    const Vec3d at = times(minus(p, origin), scale);
    return {std::round(at[0]), std::round(at[1]), std::round(at[2])};
  }
};

/// The lattice has between 2^39 and 2^40 units along the longest side of the mesh's box. Faces with
/// the same points are merged, faces without area are left out. Independent of the order of faces
/// and points, except for `pointOf` and `source`.
LatticeChain latticeChain(const TriangleMesh& mesh);

/// A face that remains whole, and the corners and edges of other remaining faces that lie in it.
struct MetFace {
  std::uint32_t face;                    ///< of the chain
  std::vector<std::uint32_t> corners;    ///< lattice points on the face's edges or inside it
  std::vector<std::vector<Vec3d>> parts; ///< convex, divided by edges; empty: not divided
};

/// Of the faces that meet others (TrimmedChain::isMet), returns those that remain whole, with the
/// corners and edges of other remaining faces that lie in them. Exact.
std::vector<MetFace> findMetFaces(const LatticeChain& chain, const TrimmedChain& trimmed);

/// The points at which an edge of a face that remains, whole or in part, crosses an edge of another
/// one, within both: where solids touch at one point, no other corner marks it. Found exactly,
/// rounded to within 2^-6 lattice units.
std::vector<Vec3d> crossingsOfEdges(const LatticeChain& chain, const TrimmedChain& trimmed);

} // namespace tetvdb
