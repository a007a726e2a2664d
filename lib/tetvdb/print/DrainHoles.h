// SPDX-License-Identifier: Apache-2.0
//
// Round holes from the outside of a solid into its cavities.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/print/DrainHole.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

/// An upward hole into each cavity, at its lowest point, or at the centre of a bottom that is
/// horizontal up to a tenth of the radius; cavities are in the order of their first faces.
std::vector<DrainHole> holesAtLowestPoints(const TriangleMesh& solid, double radius);

struct DrilledHoles {
  /// The material removed for each hole: closed, manifold, oriented outward.
  std::vector<TriangleMesh> plugs;
  std::size_t cutFaces = 0; ///< of the solid
};

/// Subtracts a cylinder from the wall at each hole. The wall is the interval of the solid along the
/// hole's axis that is closest to its point; it must be between the outside and a cavity, or
/// between two cavities. The cylinder passes through it at the axis, and extends up to four radii
/// farther if the wall is inclined. Cylinders are prisms of 64 sides with a circle's area. Exact
/// (RemoveCrossings.h): faces that no cylinder meets are kept bit for bit. `solid` must be closed,
/// manifold, oriented and free of self-intersections, and remains so. Throws Error(Invalid) if an
/// axis meets no wall of a cavity or cutting fails; the solid is then unchanged.
DrilledHoles drillHoles(TriangleMesh& solid, const std::vector<DrainHole>& holes,
                        Progress& progress);

} // namespace tetvdb
