// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/SimplifySoup.h"

#include "tetvdb/geometry/SplitAlongAxis.h"
#include "tetvdb/tetrahedralize/soup/SimplifyPart.h"
#include "tetvdb/tetrahedralize/soup/SoupSurface.h"

#include <algorithm>
#include <array>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

using Points = std::vector<std::uint32_t>;

constexpr std::size_t kPartPoints = 3000; ///< at most; most of them away from the part's border
constexpr std::size_t kSmallPart = 750;   ///< the same of a surface that would be one part
constexpr int kMaxRounds = 10;
constexpr double kWorthwhile = 0.02; ///< the share of points that a round has to remove
// Where parts are cut, round by round: borders never lie where the last ones did.
constexpr std::array<double, 4> kCuts{0.5, 0.36, 0.64, 0.43};

// Halves the points, or nearly so, along the longest side of their box until parts have at most
// `most`.
void cut(const std::vector<Vec3d>& points, Points::iterator first, Points::iterator last,
         double share, std::size_t most, std::vector<Points>& parts) {
  const auto count = static_cast<std::size_t>(last - first);
  if (count <= most) {
    parts.emplace_back(first, last);
    return;
  }
  const auto position = [&](std::uint32_t v) -> const Vec3d& { return points[v]; };
  const auto median = first + static_cast<std::ptrdiff_t>(static_cast<double>(count) * share);
  splitAlongAxis(longestAxis(first, last, position), first, median, last, position,
                 [](std::uint32_t v) { return v; });
  cut(points, first, median, share, most, parts);
  cut(points, median, last, share, most, parts);
}

} // namespace

SimplifyCounts simplifySoup(LatticeSoup& soup, const Envelope& envelope, double radius,
                            const std::vector<std::uint8_t>& fixed, Progress& progress) {
  SimplifyCounts counts;
  SoupSurface surface(soup, radius);
  for (std::size_t v = 0; v < fixed.size(); ++v)
    surface.isFixed[v] = surface.isFixed[v] || fixed[v];
  std::size_t most = 0; // points of a part
  for (int round = 0; round < kMaxRounds; ++round) {
    progress.update(double(round) / kMaxRounds);
    Points left;
    for (std::uint32_t v = 0; v < surface.points.size(); ++v)
      if (surface.firstCorner[v] != SoupSurface::kNone)
        left.push_back(v);
    if (round == 0)
      most = left.size() > kPartPoints ? kPartPoints : kSmallPart;
    std::vector<Points> parts;
    const double share = kCuts[static_cast<std::size_t>(round) % kCuts.size()];
    cut(surface.points, left.begin(), left.end(), share, most, parts);
    std::vector<SimplifyCounts> done(parts.size());
    tbb::parallel_for(std::size_t(0), parts.size(), [&](std::size_t i) {
      std::sort(parts[i].begin(), parts[i].end());
      for (const std::uint32_t v : parts[i])
        surface.part[v] = static_cast<std::uint32_t>(i);
    });
    tbb::parallel_for(std::size_t(0), parts.size(), [&](std::size_t i) {
      SimplifyPart part(surface, envelope, radius, progress);
      part.run(parts[i]);
      done[i] = part.counts();
    });
    std::size_t collapses = 0;
    for (const SimplifyCounts& ofPart : done) {
      collapses += ofPart.collapses;
      counts.swaps += ofPart.swaps;
    }
    counts.collapses += collapses;
    if (static_cast<double>(collapses) <= kWorthwhile * static_cast<double>(left.size()))
      break;
  }
  soup = surface.rest();
  tidySoup(soup, progress);
  return counts;
}

} // namespace tetvdb
