// SPDX-License-Identifier: Apache-2.0
//
// Lines that faces leave in a plane, joined to closed ones. Internal.
#pragma once

#include "tetvdb/print/Layer.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// A line between two edges of a mesh, each by its two points' indices in one number.
struct ContourLine {
  std::uint64_t fromEdge = 0, toEdge = 0;
  std::array<double, 2> from{0, 0};
};

/// Follows lines from edge to edge. Where several leave an edge that of the smallest end is taken
/// first. Points that repeat the one before are left out, and with them what has fewer than three.
/// Throws std::logic_error where a line ends at an edge that none leaves. `lines` are sorted.
std::vector<LayerContour> closedContours(std::vector<ContourLine>& lines);

/// The area within a contour: above 0 where it turns counter-clockwise.
double areaOf(const LayerContour& contour);

} // namespace tetvdb
