// SPDX-License-Identifier: Apache-2.0
//
// How often a closed chain of faces goes around the places on either side of one of its faces.
#pragma once

#include "tetvdb/geometry/BoxBlocks.h"
#include "tetvdb/geometry/LatticePlane.h"
#include "tetvdb/surface/FacePieces.h"
#include "tetvdb/surface/WeldedFaces.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace tetvdb {

struct SideWindings {
  std::int64_t front, back; ///< where the face's corners turn counter-clockwise, and behind it
  std::uint32_t first;      ///< lowest number of a face in this plane at the point
};

/// Refers to faces and boxes.
class FaceColumns {
public:
  /// `boxes` are the faces'.
  FaceColumns(const WeldedFaces& welded, const BoxBlocks& boxes) : welded_(welded), boxes_(boxes) {}

  /// The winding numbers just off `face` at a point of it, by the signed faces that a line along
  /// its steepest axis crosses, exact. None where the line meets an edge, or at the point a face
  /// that is not in this one's plane: another point will do. `looked` grows by the faces that were
  /// looked at. Thread-safe.
  std::optional<SideWindings> at(const FacePlanes& face, const LiftedPoint& point,
                                 std::size_t& looked) const;

private:
  const WeldedFaces& welded_;
  const BoxBlocks& boxes_;
};

} // namespace tetvdb
