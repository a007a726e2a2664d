// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/LatticeChain.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/surface/FacePieces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;

/// The faces that meet others and remain, whole or in part, ascending.
std::vector<std::uint32_t> metAndLeft(const TrimmedChain& trimmed) {
  std::vector<std::uint32_t> met;
  for (std::uint32_t i = 0; i < trimmed.fates.size(); ++i)
    if (trimmed.isMet[i] != 0 && (trimmed.isCut(i) || trimmed.stays(i)))
      met.push_back(i);
  return met;
}

/// The point within both segments at which ab crosses cd, if there is one.
std::optional<Vec3d> crossing(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  if (orientation(a, b, c, d) != 0)
    return {};
  for (std::size_t axis = 0; axis < 3; ++axis) { // one of three projections keeps the plane
    const auto flat = [&](const Vec3d& p) { return Vec2d{p[(axis + 1) % 3], p[(axis + 2) % 3]}; };
    const Vec2d a2 = flat(a), b2 = flat(b), c2 = flat(c), d2 = flat(d);
    if (orientation(a2, b2, c2) * orientation(a2, b2, d2) >= 0 ||
        orientation(c2, d2, a2) * orientation(c2, d2, b2) >= 0)
      continue;
    const auto area = [](const Vec2d& from, const Vec2d& to, const Vec2d& p) {
      return (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0]);
    };
    const double atA = area(c2, d2, a2), atB = area(c2, d2, b2);
    return plus(a, times(minus(b, a), atA / (atA - atB)));
  }
  return {};
}

} // namespace

LatticeChain latticeChain(const TriangleMesh& mesh) {
  LatticeChain chain;
  const Box box = boxOf(mesh.points, mesh.triangles);
  chain.origin = box.low;
  double extent = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    extent = std::max(extent, box.high[axis] - box.low[axis]);
  int exponent = 0;
  std::frexp(extent, &exponent); // extent <= 2^exponent
  chain.scale = std::ldexp(1, 40 - exponent);

  // Numbered by position, so that nothing depends on the order of faces.
  std::map<Vec3d, std::uint32_t> corners; // the first corner's point of the mesh
  std::vector<Vec3d> snapped(mesh.points.size());
  std::vector<std::uint32_t> number(mesh.points.size(), kNone);
  for (const std::uint32_t corner : mesh.triangles) {
    if (number[corner] != kNone)
      continue;
    snapped[corner] = chain.toLattice(mesh.points[corner]);
    number[corner] = 0;
    corners.try_emplace(snapped[corner], corner);
  }
  for (auto& [p, point] : corners) {
    chain.pointOf.push_back(point);
    point = static_cast<std::uint32_t>(chain.welded.points.size());
    chain.welded.points.push_back(p);
    for (const double c : p)
      chain.welded.extent = std::max(chain.welded.extent, c);
  }
  for (std::size_t point = 0; point < number.size(); ++point)
    if (number[point] != kNone)
      number[point] = corners.at(snapped[point]);

  struct Weighed {
    WeldedFace face;
    std::uint32_t source;
  };
  std::vector<Weighed> all;
  const std::vector<Vec3d>& points = chain.welded.points;
  for (std::uint32_t face = 0; face < mesh.triangleCount(); ++face) {
    std::array<std::uint32_t, 3> c;
    for (std::size_t k = 0; k < 3; ++k)
      c[k] = number[mesh.triangles[3 * std::size_t(face) + k]];
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0] ||
        areCollinear(points[c[0]], points[c[1]], points[c[2]])) {
      ++chain.welded.flat;
      continue;
    }
    all.push_back({ascendingFace(points, c, 1), face});
  }
  std::sort(all.begin(), all.end(), [](const Weighed& a, const Weighed& b) {
    return a.face.corners != b.face.corners ? a.face.corners < b.face.corners : a.source < b.source;
  });
  for (std::size_t i = 0, end; i < all.size(); i = end) {
    std::int32_t sum = 0;
    for (end = i; end < all.size() && all[end].face.corners == all[i].face.corners; ++end)
      sum += all[end].face.weight;
    if (sum == 0)
      continue;
    std::size_t first = i;
    while (all[first].face.weight * sum < 0)
      ++first;
    chain.welded.faces.push_back({all[i].face.corners, sum});
    chain.source.push_back(all[first].source);
  }
  return chain;
}

std::vector<MetFace> findMetFaces(const LatticeChain& chain, const TrimmedChain& trimmed) {
  const std::vector<std::uint32_t> met = metAndLeft(trimmed);
  std::vector<Box> boxes(met.size());
  for (std::size_t at = 0; at < met.size(); ++at)
    for (const Vec3d& p : chain.welded.cornersOf(met[at]))
      boxes[at].add(p);
  const BoxTree tree(boxes);
  std::vector<MetFace> all;
  for (std::size_t at = 0; at < met.size(); ++at) {
    if (trimmed.isCut(met[at]))
      continue;
    const FacePlanes face(chain.welded.cornersOf(met[at]));
    const auto& own = chain.welded.faces[met[at]].corners;
    std::deque<FacePlanes> cuts; // referenced by the pieces
    FacePieces pieces(face);
    std::set<std::uint32_t> corners;
    std::vector<std::uint32_t> others;
    tree.visit([&](const Box& box) { return box.meets(boxes[at]); },
               [&](std::uint32_t item) {
                 others.push_back(item);
                 return false;
               });
    std::sort(others.begin(), others.end());
    for (const std::uint32_t item : others) {
      if (item == at)
        continue;
      std::size_t inPlane = 0;
      for (const std::uint32_t v : chain.welded.faces[met[item]].corners) {
        const Vec3d& p = chain.welded.points[v];
        if (face.plane.side(p) != 0)
          continue;
        ++inPlane;
        if (std::find(own.begin(), own.end(), v) == own.end() && face.edges[0].side(p) >= 0 &&
            face.edges[1].side(p) >= 0 && face.edges[2].side(p) >= 0)
          corners.insert(v);
      }
      if (inPlane == 2)
        pieces.cut(cuts.emplace_back(chain.welded.cornersOf(met[item])));
    }
    MetFace touched{met[at], {corners.begin(), corners.end()}, {}};
    for (std::size_t i = 0; i < pieces.size() && pieces.size() > 1; ++i)
      if (pieces.isLeaf(i))
        touched.parts.push_back(pieces.outline(i));
    all.push_back(std::move(touched));
  }
  return all;
}

std::vector<Vec3d> crossingsOfEdges(const LatticeChain& chain, const TrimmedChain& trimmed) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> all;
  for (const std::uint32_t face : metAndLeft(trimmed))
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& c = chain.welded.faces[face].corners;
      all.insert(std::minmax(c[k], c[(k + 1) % 3]));
    }
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> edges(all.begin(), all.end());
  const std::vector<Vec3d>& points = chain.welded.points;
  std::vector<Box> boxes(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    boxes[i].add(points[edges[i].first]);
    boxes[i].add(points[edges[i].second]);
  }
  const BoxTree tree(boxes);
  std::vector<Vec3d> found;
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    std::vector<std::uint32_t> others;
    tree.visit([&](const Box& box) { return box.meets(boxes[i]); },
               [&](std::uint32_t item) {
                 if (item > i)
                   others.push_back(item);
                 return false;
               });
    std::sort(others.begin(), others.end());
    for (const std::uint32_t item : others)
      if (const auto p = crossing(points[edges[i].first], points[edges[i].second],
                                  points[edges[item].first], points[edges[item].second]))
        found.push_back(*p);
  }
  return found;
}

} // namespace tetvdb
