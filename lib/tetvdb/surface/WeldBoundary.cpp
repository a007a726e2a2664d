// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/WeldBoundary.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/DuplicateFaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kOfShortestEdge = 0.25;
constexpr double kOfSize = 1e-4, kOfCoordinate = 2e-6, kMaxOfSize = 1e-3;
constexpr double kOfTypicalGap = 4, kTypical = 0.9;

// Points that may be welded, with the limit of the distance for each.
struct Candidates {
  std::vector<std::uint32_t> points;
  std::vector<double> reach;
};

Candidates findCandidates(const TriangleMesh& mesh, const EdgeTable& edges, WeldCandidates wanted) {
  std::vector<double> shortest(mesh.points.size(), std::numeric_limits<double>::infinity());
  std::vector<std::uint8_t> wantedPoint(mesh.points.size(), wanted == WeldCandidates::AllPoints);
  Box box;
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const std::uint32_t a = edges.lowPoint(edge), b = edges.highPoint(edge);
    const double here = length(minus(mesh.points[a], mesh.points[b]));
    shortest[a] = std::min(shortest[a], here);
    shortest[b] = std::min(shortest[b], here);
    box.add(mesh.points[a]);
    box.add(mesh.points[b]);
    if (edges.sides(edge).size() == 1)
      wantedPoint[a] = wantedPoint[b] = 1;
  }
  double size = 0, coordinate = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    size = std::max(size, box.high[axis] - box.low[axis]);
    coordinate = std::max({coordinate, std::abs(box.low[axis]), std::abs(box.high[axis])});
  }
  const double max =
      std::min(std::max(kOfSize * size, kOfCoordinate * coordinate), kMaxOfSize * size);
  Candidates candidates;
  for (std::uint32_t point = 0; point < mesh.points.size(); ++point)
    if (wantedPoint[point] && std::isfinite(shortest[point])) {
      candidates.points.push_back(point);
      candidates.reach.push_back(std::min(kOfShortestEdge * shortest[point], max));
    }
  return candidates;
}

struct Near {
  std::uint32_t a, b; ///< points
  double distance;
};

// All pairs of candidates within each other's limits.
std::vector<Near> nearPairs(const TriangleMesh& mesh, const Candidates& candidates,
                            Progress& progress) {
  std::vector<Box> boxes(candidates.points.size());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    boxes[i].add(mesh.points[candidates.points[i]]);
  const BoxTree tree(std::move(boxes));
  std::vector<std::vector<Near>> found(candidates.points.size());
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, found.size(), 1024),
      [&](const tbb::blocked_range<std::size_t>& range) {
        progress.check();
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const Vec3d& p = mesh.points[candidates.points[i]];
          Box around;
          for (const double way : {-candidates.reach[i], candidates.reach[i]})
            around.add(Vec3d{p[0] + way, p[1] + way, p[2] + way});
          tree.visit([&](const Box& box) { return box.meets(around); },
                     [&](std::uint32_t j) {
                       const double distance = length(minus(p, mesh.points[candidates.points[j]]));
                       if (j > i && distance < std::min(candidates.reach[i], candidates.reach[j]))
                         found[i].push_back({candidates.points[i], candidates.points[j], distance});
                       return false;
                     });
        }
      });
  std::vector<Near> pairs;
  for (const auto& some : found)
    pairs.insert(pairs.end(), some.begin(), some.end());
  return pairs;
}

double typicalGap(const std::vector<Near>& pairs, std::size_t pointCount) {
  std::vector<double> nearest(pointCount, std::numeric_limits<double>::infinity());
  for (const Near& pair : pairs) {
    nearest[pair.a] = std::min(nearest[pair.a], pair.distance);
    nearest[pair.b] = std::min(nearest[pair.b], pair.distance);
  }
  nearest.erase(std::remove_if(nearest.begin(), nearest.end(),
                               [](double distance) { return std::isinf(distance); }),
                nearest.end());
  const auto at = static_cast<std::ptrdiff_t>(kTypical * double(nearest.size() - 1));
  std::nth_element(nearest.begin(), nearest.begin() + at, nearest.end());
  return nearest[static_cast<std::size_t>(at)];
}

// Decides which of several points stays: one of the component (connected across points) with the
// most faces, then of the component that is first by position, then the point that is first by
// position. A component thus keeps all its points if a smaller one, or a copy, is welded to it.
class Precedence {
public:
  explicit Precedence(const TriangleMesh& mesh)
      : mesh_(mesh), components_(mesh.points.size()), faces_(mesh.points.size(), 0),
        first_(mesh.points.size()) {
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
      components_.join(mesh.triangles[i], mesh.triangles[i + 1]);
      components_.join(mesh.triangles[i], mesh.triangles[i + 2]);
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
      ++faces_[components_.find(mesh.triangles[i])];
    std::iota(first_.begin(), first_.end(), 0u);
    for (std::uint32_t point = 0; point < first_.size(); ++point) {
      std::uint32_t& first = first_[components_.find(point)];
      if (mesh.points[point] < mesh.points[first])
        first = point;
    }
  }

  bool comesBefore(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t inA = components_.find(a), inB = components_.find(b);
    if (faces_[inA] != faces_[inB])
      return faces_[inA] > faces_[inB];
    return inA != inB ? mesh_.points[first_[inA]] < mesh_.points[first_[inB]]
                      : mesh_.points[a] < mesh_.points[b];
  }

private:
  const TriangleMesh& mesh_;
  DisjointSets components_;
  std::vector<std::uint32_t> faces_, first_; ///< of a component
};

std::size_t boundaryEdges(const EdgeTable& edges) {
  return countWhere(edges.edgeCount(), [&](std::size_t edge) {
    return edges.sides(static_cast<std::uint32_t>(edge)).size() == 1;
  });
}

} // namespace

BoundaryWeld weldBoundary(const TriangleMesh& mesh, const EdgeTable& edges, WeldCandidates wanted,
                          Progress& progress) {
  BoundaryWeld weld;
  const std::size_t open = boundaryEdges(edges);
  if (wanted == WeldCandidates::BoundaryPoints && open == 0)
    return weld;
  const Candidates candidates = findCandidates(mesh, edges, wanted);
  if (candidates.points.empty())
    return weld;
  std::vector<Near> pairs = nearPairs(mesh, candidates, progress);
  if (pairs.empty())
    return weld;
  const double max = kOfTypicalGap * typicalGap(pairs, mesh.points.size());
  DisjointSets sets(mesh.points.size());
  for (const Near& pair : pairs)
    if (pair.distance <= max)
      sets.join(pair.a, pair.b);
  // Sets that would merge two corners of a face are not merged.
  std::vector<std::uint8_t> collapses(mesh.points.size(), 0);
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t set = sets.find(mesh.triangles[3 * face + k]);
      if (set == sets.find(mesh.triangles[3 * face + (k + 1) % 3]))
        collapses[set] = 1;
    }
  Precedence precedence(mesh);
  std::vector<std::uint32_t> first(mesh.points.size());
  std::iota(first.begin(), first.end(), 0u);
  std::vector<std::uint32_t> becomes = first;
  for (const std::uint32_t point : candidates.points) {
    std::uint32_t& best = first[sets.find(point)];
    if (precedence.comesBefore(point, best))
      best = point;
  }
  std::size_t gone = 0;
  for (const std::uint32_t point : candidates.points) {
    const std::uint32_t set = sets.find(point);
    if (collapses[set])
      continue;
    becomes[point] = first[set];
    gone += becomes[point] != point;
  }
  if (gone == 0)
    return weld;

  std::vector<std::uint32_t> corners(mesh.triangles.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = becomes[mesh.triangles[i]];
  const EdgeTable after(corners, mesh.points.size());
  const std::size_t left = boundaryEdges(after);
  const bool accepted = wanted == WeldCandidates::AllPoints
                            ? 2 * findDuplicates(after).surplus() >= mesh.triangleCount() / 2
                            : left + gone <= open && 2 * left <= open;
  if (!accepted)
    return weld;
  for (const Near& pair : pairs)
    if (pair.distance <= max && becomes[pair.a] == becomes[pair.b])
      weld.distance = std::max(weld.distance, pair.distance);
  weld.becomes = std::move(becomes);
  return weld;
}

} // namespace tetvdb
