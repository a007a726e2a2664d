// SPDX-License-Identifier: Apache-2.0
//
// Connects the intersection lines of faces and a plane to closed lines. Internal.
#pragma once

#include "tetvdb/print/Layer.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// A line between two edges of a mesh, each given by its two points' indices in one number.
struct ContourLine {
  std::uint64_t fromEdge = 0, toEdge = 0;
  std::array<double, 2> from{0, 0};
};

/// Follows lines from edge to edge. If several leave an edge, the one with the smallest second edge
/// is used first. Repeated points are omitted, and so are contours with fewer than three points.
/// Throws std::logic_error if a line ends at an edge without a leaving line. Sorts `lines`.
std::vector<LayerContour> closedContours(std::vector<ContourLine>& lines);

/// The area within a contour: above 0 if it is counter-clockwise.
double areaOf(const LayerContour& contour);

} // namespace tetvdb
