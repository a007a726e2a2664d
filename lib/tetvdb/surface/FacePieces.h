// SPDX-License-Identifier: Apache-2.0
//
// Cuts a face along all faces that cross it, touch it or lie in its plane, into convex pieces that
// none of these faces intersects.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/LatticePlane.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The planes of a face that is not collinear: its own, and one for each edge, from corner k to
/// corner k + 1, parallel to the face's steepest axis, with the face on its positive side.
struct FacePlanes {
  std::array<Vec3d, 3> corners{};
  LatticePlane plane;
  std::size_t axis = 0;
  std::array<LatticePlane, 3> edges;

  explicit FacePlanes(const std::array<Vec3d, 3>& corners);
};

/// The pieces are the leaves of a tree of cuts. A cut divides only the pieces that the cutting face
/// intersects, so that n faces that do not cross one another make about n log n pieces. Exact:
/// corners are represented by planes. Keeps references to the faces.
class FacePieces {
public:
  explicit FacePieces(const FacePlanes& face);

  /// Cuts along the intersection of `other` with the face. Returns the number of tested pieces.
  std::size_t cut(const FacePlanes& other);

  /// The number of nodes of the tree: 0 is the face, nodes without halves are the pieces.
  std::size_t size() const { return pieces_.size(); }
  bool isLeaf(std::size_t piece) const { return pieces_[piece].halves == 0; }
  /// The number of the first half; the second half follows it.
  std::size_t halves(std::size_t piece) const { return pieces_[piece].halves; }
  /// The corners in order, rounded; within 2^-6 lattice units.
  std::vector<Vec3d> outline(std::size_t piece) const;
  /// Computes a point inside the piece and off its edges, in fine coordinates along the two axes
  /// after face.axis. `attempt` selects one of many. Returns false if there is none: the piece is
  /// thinner than about two fine units.
  bool innerPoint(std::size_t piece, unsigned attempt, std::int64_t& u, std::int64_t& v) const;

private:
  struct Side {
    const LatticePlane* plane;
    int inner; ///< the side of it that the piece is on
  };
  // Sides i - 1 and i meet at corner i.
  struct Piece {
    std::vector<PlaneCorner> corners;
    std::vector<Side> sides;
    std::size_t halves = 0;
  };
  // The lines that bound a face.
  using Limits = std::array<const LatticePlane*, 3>;

  std::size_t cutAlong(const LatticePlane& plane, const Limits& limits);
  void divide(std::size_t piece, const LatticePlane& plane, const std::vector<int>& signs);

  const FacePlanes& face_;
  std::vector<Piece> pieces_;
};

} // namespace tetvdb
