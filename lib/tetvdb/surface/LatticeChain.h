// SPDX-License-Identifier: Apache-2.0
//
// A mesh's faces on a lattice, as removeCrossings() cuts them.
#pragma once

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/TrimChain.h"
#include "tetvdb/surface/WeldedFaces.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The faces on a lattice, and which of the mesh they are.
struct LatticeChain {
  WeldedFaces welded;
  std::vector<std::uint32_t> pointOf; ///< of the mesh, by point of `welded`
  std::vector<std::uint32_t> source;  ///< face of the mesh, by face of `welded`
  Vec3d origin{0, 0, 0};
  double scale = 1; ///< lattice units in a world unit: a power of two

  Vec3d toWorld(const Vec3d& p) const { return plus(origin, times(p, 1 / scale)); }
};

/// The lattice has between 2^39 and 2^40 units along the longest side of the mesh's box. Faces over
/// the same points are one, faces without area are left out. The same but for `pointOf` and
/// `source` for any order of faces and points.
LatticeChain latticeChain(const TriangleMesh& mesh);

/// A face that stays whole, and what of others that stay lies in it.
struct TouchedFace {
  std::uint32_t face;                    ///< of the chain
  std::vector<std::uint32_t> corners;    ///< of the lattice, on the face's edges or within it
  std::vector<std::vector<Vec3d>> parts; ///< convex ones that edges divide it into; empty: none do
};

/// Of faces that others meet (TrimmedChain::isMet) those that stay as they are, with the corners
/// and edges of such faces that lie in them, exactly.
std::vector<TouchedFace> findTouchedFaces(const LatticeChain& chain, const TrimmedChain& trimmed);

} // namespace tetvdb
