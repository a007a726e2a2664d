// SPDX-License-Identifier: Apache-2.0
//
// A face cut along all other faces that pass through it, touch it or lie in its plane, into convex
// pieces that none of them reaches into.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/LatticePlane.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The planes of a face that is not collinear: its own, and for each edge, from corner k to corner
/// k + 1, one along the face's steepest axis with the face on its positive side.
struct FacePlanes {
  std::array<Vec3d, 3> corners{};
  LatticePlane plane;
  std::size_t axis = 0;
  std::array<LatticePlane, 3> edges;

  explicit FacePlanes(const std::array<Vec3d, 3>& corners);
};

/// Pieces are what a tree of cuts leaves. A cut divides those pieces alone that the cutting face
/// reaches into, so that n faces make about n log n pieces where they do not cross one another.
/// Exact: corners are known by planes. Refers to the faces.
class FacePieces {
public:
  explicit FacePieces(const FacePlanes& face);

  /// Cuts along what `other` has in common with the face. Returns how many pieces were looked at.
  std::size_t cut(const FacePlanes& other);

  /// All pieces there have ever been; 0 is the face, and those without halves are there now.
  std::size_t size() const { return pieces_.size(); }
  bool isLeaf(std::size_t piece) const { return pieces_[piece].halves == 0; }
  /// One half; the next is the other.
  std::size_t halves(std::size_t piece) const { return pieces_[piece].halves; }
  /// Corners, rounded, in order. Within 2^-6 lattice units.
  std::vector<Vec3d> outline(std::size_t piece) const;
  /// A point within the piece, off its edges, the `attempt`th choice of many: fine coordinates
  /// along the two axes after face.axis. False where there is none: the piece is thinner than a
  /// fine unit or two.
  bool innerPoint(std::size_t piece, unsigned attempt, std::int64_t& u, std::int64_t& v) const;

private:
  struct Side {
    const LatticePlane* plane;
    int inner; ///< the side of it that the piece is on
  };
  // Corner i is where sides i - 1 and i meet.
  struct Piece {
    std::vector<PlaneCorner> corners;
    std::vector<Side> sides;
    std::size_t halves = 0;
  };
  // The lines of a face beyond which it does not reach.
  using Limits = std::array<const LatticePlane*, 3>;

  std::size_t cutAlong(const LatticePlane& plane, const Limits& limits);
  void divide(std::size_t piece, const LatticePlane& plane, const std::vector<int>& signs);

  const FacePlanes& face_;
  std::vector<Piece> pieces_;
};

} // namespace tetvdb
