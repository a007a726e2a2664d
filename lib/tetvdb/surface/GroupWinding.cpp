// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/GroupWinding.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/surface/WindingCurtain.h"

#include <algorithm>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

// The box is enlarged by this fraction on each side.
constexpr double kMargin = 0.05;
// Distances from a face, relative to the square root of its group's area: smallest and
// largest.
constexpr double kNearest = 0.002, kFarthest = 0.5;
// Relative to the box's diagonal: smaller groups have no samples of their own, and no sample is
// closer to its face than kMinDistance, since rays are computed in floats.
constexpr double kSmallestGroup = 1e-3, kMinDistance = 1e-5;
constexpr std::size_t kSamplesPerGroup = 16; ///< at least, half on each side

// Fractional parts of multiples of the powers of 1 / g, g^4 = g + 1: uniform in three dimensions
// (M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018).
Vec3d spread(std::size_t i) {
  constexpr double kStep[3] = {0.8191725133961644, 0.6710436067037892, 0.5497004779019702};
  Vec3d p;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = 0.5 + kStep[axis] * double(i + 1);
    p[axis] = along - std::floor(along);
  }
  return p;
}

// Calls visit(edge, group, weight) for each group that is not closed at an edge.
template <typename Visit>
void eachOpenEdge(const EdgeTable& edges, const std::vector<std::uint32_t>& groupOf,
                  const std::vector<std::uint8_t>& turned, const Visit& visit) {
  std::vector<std::pair<std::uint32_t, int>> around; // group, direction
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    around.clear();
    for (const std::uint32_t side : edges.sides(edge)) {
      const std::uint32_t face = EdgeTable::faceOf(side);
      if (groupOf[face] != EdgeTable::kNone)
        around.emplace_back(groupOf[face], edges.ascends(side) != (turned[face] != 0) ? 1 : -1);
    }
    if (around.size() > 2)
      std::sort(around.begin(), around.end());
    for (std::size_t i = 0, end; i < around.size(); i = end) {
      int weight = 0;
      for (end = i; end < around.size() && around[end].first == around[i].first; ++end)
        weight += around[end].second;
      if (weight != 0)
        visit(edge, around[i].first, weight);
    }
  }
}

} // namespace

WindingSamples windingSamples(const TriangleMesh& mesh, const std::vector<std::uint32_t>& groupOf,
                              std::uint32_t groupCount, std::size_t count) {
  Box box;
  std::vector<double> area(groupCount, 0);
  std::vector<std::vector<std::uint32_t>> facesOf(groupCount);
  std::vector<double> faceArea(mesh.triangleCount(), 0);
  const auto corner = [&](std::size_t face, std::size_t k) -> const Vec3d& {
    return mesh.points[mesh.triangles[3 * face + k]];
  };
  const auto normal = [&](std::size_t face) {
    return cross(minus(corner(face, 1), corner(face, 0)), minus(corner(face, 2), corner(face, 0)));
  };
  double total = 0;
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face) {
    const std::uint32_t group = groupOf[face];
    if (group == EdgeTable::kNone)
      continue;
    for (std::size_t k = 0; k < 3; ++k)
      box.add(corner(face, k));
    faceArea[face] = length(normal(face)) / 2;
    area[group] += faceArea[face];
    total += faceArea[face];
    facesOf[group].push_back(static_cast<std::uint32_t>(face));
  }
  WindingSamples samples;
  if (!(total > 0))
    return samples;
  samples.volume = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    samples.volume *= (box.high[axis] - box.low[axis]) * (1 + 2 * kMargin);
  samples.spread = count / 3;
  for (std::size_t i = 0; i < samples.spread; ++i) {
    Vec3d p = spread(i);
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] = box.low[axis] +
                (box.high[axis] - box.low[axis]) * (p[axis] * (1 + 2 * kMargin) - kMargin);
    samples.points.push_back(p);
  }
  const double diagonal = length(minus(box.high, box.low));
  const std::size_t beside = count - samples.spread;
  const std::size_t min = std::min(kSamplesPerGroup, beside / (2 * std::size_t(groupCount)));
  for (std::uint32_t group = 0; group < groupCount; ++group) {
    if (!(std::sqrt(area[group]) > kSmallestGroup * diagonal))
      continue;
    const auto share = static_cast<std::size_t>(double(beside / 2) * area[group] / total);
    const std::size_t pairs = (min + share) / 2;
    const double size = std::sqrt(area[group]);
    // Faces by area: the next is the one in which the running sum passes (i + 1/2) / pairs.
    std::size_t at = 0;
    double sum = faceArea[facesOf[group][0]];
    for (std::size_t i = 0; i < pairs; ++i) {
      while (at + 1 < facesOf[group].size() &&
             sum < area[group] * (double(i) + 0.5) / double(pairs))
        sum += faceArea[facesOf[group][++at]];
      const std::uint32_t face = facesOf[group][at];
      if (!(faceArea[face] > 0))
        continue;
      Vec3d r = spread(i);
      if (r[0] + r[1] > 1) { // from the unit square into its lower triangle
        r[0] = 1 - r[0];
        r[1] = 1 - r[1];
      }
      const Vec3d p =
          plus(corner(face, 0), plus(times(minus(corner(face, 1), corner(face, 0)), r[0]),
                                     times(minus(corner(face, 2), corner(face, 0)), r[1])));
      const double distance =
          std::max(size * kNearest * std::pow(kFarthest / kNearest, r[2]), kMinDistance * diagonal);
      const Vec3d step = times(normal(face), distance / (2 * faceArea[face]));
      samples.points.push_back(plus(p, step));
      samples.points.push_back(minus(p, step));
    }
  }
  return samples;
}

GroupWinding::GroupWinding(const TriangleMesh& mesh, const EdgeTable& edges,
                           const TriangleScene& scene, const std::vector<std::uint32_t>& groupOf,
                           std::uint32_t groupCount, const std::vector<std::uint8_t>& turned,
                           const std::vector<Vec3d>& samples, Progress& progress)
    : samples_(samples.size()), values_(std::size_t(groupCount) * samples.size(), 0) {
  // Several groups may be open at an edge; its angle is computed once.
  struct GroupEdge {
    CurtainEdge edge;
    std::uint32_t group;
    bool isNext; ///< the edge differs from that of the previous entry
  };
  std::vector<GroupEdge> open;
  std::uint32_t last = EdgeTable::kNone;
  eachOpenEdge(edges, groupOf, turned, [&](std::uint32_t edge, std::uint32_t group, int weight) {
    open.push_back(
        {{mesh.points[edges.lowPoint(edge)], mesh.points[edges.highPoint(edge)], double(weight)},
         group,
         edge != last});
    last = edge;
  });
  Box box;
  for (const std::uint32_t v : mesh.triangles)
    box.add(mesh.points[v]);
  const double reach = 4 * length(minus(box.high, box.low));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples_, 16),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      progress.check();
                      std::vector<TriangleScene::Hit> hits;
                      std::vector<double> sums(groupCount);
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        std::fill(sums.begin(), sums.end(), 0);
                        scene.crossings(samples[i], times(kCurtainUp, -1), reach, hits);
                        for (const TriangleScene::Hit& hit : hits)
                          if (groupOf[hit.triangle] != EdgeTable::kNone)
                            sums[groupOf[hit.triangle]] +=
                                hit.leaving != (turned[hit.triangle] != 0) ? 1 : -1;
                        double angle = 0;
                        for (const GroupEdge& one : open) {
                          if (one.isNext)
                            angle = halfCurtainAngle(one.edge, samples[i]);
                          sums[one.group] += curtainWinding(one.edge.weight, angle);
                        }
                        for (std::uint32_t group = 0; group < groupCount; ++group)
                          values_[std::size_t(group) * samples_ + i] =
                              static_cast<float>(sums[group]);
                      }
                    });
}

std::size_t GroupWinding::openEdges(const EdgeTable& edges,
                                    const std::vector<std::uint32_t>& groupOf,
                                    const std::vector<std::uint8_t>& turned) {
  std::size_t count = 0;
  eachOpenEdge(edges, groupOf, turned, [&](std::uint32_t, std::uint32_t, int) { ++count; });
  return count;
}

} // namespace tetvdb
