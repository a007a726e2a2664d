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

/// A hole upward into each cavity, at its lowest point, or in the middle of a bottom that is level
/// up to a tenth of the radius; cavities in order of their first faces.
std::vector<DrainHole> holesAtLowestPoints(const TriangleMesh& solid, double radius);

struct DrilledHoles {
  /// What was taken out of each hole's wall: closed, manifold, oriented outward.
  std::vector<TriangleMesh> plugs;
  std::size_t cutFaces = 0; ///< of the solid
};

/// Takes a cylinder out of the wall at each hole. The wall is that interval of the solid along the
/// hole's axis that is nearest to its point; it is between the outside and a cavity, or two
/// cavities, and the cylinder goes through it where it is at the axis, and up to four radii farther
/// where the wall is slanted. Cylinders are prisms of 64 sides with a circle's area. Exact
/// (RemoveCrossings.h): faces that a cylinder does not meet stay bit for bit. `solid` is closed,
/// manifold, oriented and free of self-intersections, and stays so. Throws Error(Invalid) where an
/// axis meets no wall of a cavity or cutting gives up; the solid is as it was then.
DrilledHoles drillHoles(TriangleMesh& solid, const std::vector<DrainHole>& holes,
                        Progress& progress);

} // namespace tetvdb
