// SPDX-License-Identifier: Apache-2.0
//
// Winding numbers of a closed chain of faces on both sides of one of its faces.
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
  std::int64_t front, back; ///< on the side that sees the corners counter-clockwise; on the other
                            ///< side
  std::uint32_t first;      ///< lowest number of a face in this plane at the point
};

/// Keeps references to the faces and boxes.
class FaceColumns {
public:
  /// `boxes` are those of the faces.
  FaceColumns(const WeldedFaces& welded, const BoxBlocks& boxes) : welded_(welded), boxes_(boxes) {}

  /// Returns the winding numbers on both sides of `face` at one of its points, by the signed
  /// crossings of a line along its steepest axis. Exact. Returns none if the line meets an edge, or
  /// a face in another plane at the point itself; another point must then be chosen. Adds the
  /// number of tested faces to `looked`. Thread-safe.
  std::optional<SideWindings> at(const FacePlanes& face, const LiftedPoint& point,
                                 std::size_t& looked) const;

private:
  const WeldedFaces& welded_;
  const BoxBlocks& boxes_;
};

} // namespace tetvdb
