// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/ContourLines.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace tetvdb {

std::vector<LayerContour> closedContours(std::vector<ContourLine>& lines) {
  std::sort(lines.begin(), lines.end(), [](const ContourLine& a, const ContourLine& b) {
    return std::tie(a.fromEdge, a.toEdge) < std::tie(b.fromEdge, b.toEdge);
  });
  std::vector<bool> taken(lines.size(), false);
  const auto firstFrom = [&](std::uint64_t edge) {
    auto found = std::lower_bound(
        lines.begin(), lines.end(), edge,
        [](const ContourLine& line, std::uint64_t wanted) { return line.fromEdge < wanted; });
    for (; found != lines.end() && found->fromEdge == edge; ++found)
      if (!taken[static_cast<std::size_t>(found - lines.begin())])
        return static_cast<std::size_t>(found - lines.begin());
    throw std::logic_error("a line of a layer does not close");
  };
  std::vector<LayerContour> contours;
  for (std::size_t start = 0; start < lines.size(); ++start) {
    if (taken[start])
      continue;
    LayerContour contour;
    for (std::size_t at = start;;) {
      taken[at] = true;
      if (contour.empty() || contour.back() != lines[at].from)
        contour.push_back(lines[at].from);
      if (lines[at].toEdge == lines[start].fromEdge)
        break;
      at = firstFrom(lines[at].toEdge);
    }
    while (contour.size() > 1 && contour.back() == contour.front())
      contour.pop_back();
    if (contour.size() > 2)
      contours.push_back(std::move(contour));
  }
  return contours;
}

double areaOf(const LayerContour& contour) {
  double twice = 0;
  const auto& o = contour.front();
  for (std::size_t i = 1; i + 1 < contour.size(); ++i) {
    const auto &p = contour[i], &q = contour[i + 1];
    twice += (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
  }
  return twice / 2;
}

} // namespace tetvdb
