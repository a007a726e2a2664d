// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/LatticeChain.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/surface/FacePieces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <map>
#include <set>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;

bool stays(const FaceRest& rest) {
  return rest.fate == PartFate::Stays || rest.fate == PartFate::StaysInverse;
}

} // namespace

LatticeChain latticeChain(const TriangleMesh& mesh) {
  LatticeChain chain;
  Box box;
  for (const std::uint32_t corner : mesh.triangles)
    box.add(mesh.points[corner]);
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
    for (std::size_t axis = 0; axis < 3; ++axis)
      snapped[corner][axis] = std::round((mesh.points[corner][axis] - box.low[axis]) * chain.scale);
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
  std::vector<std::uint32_t> met;
  std::vector<Box> boxes;
  for (std::uint32_t i = 0; i < trimmed.rests.size(); ++i) {
    if (trimmed.isMet[i] == 0 || (trimmed.rests[i].parts.empty() && !stays(trimmed.rests[i])))
      continue;
    met.push_back(i);
    boxes.emplace_back();
    for (const Vec3d& p : chain.welded.cornersOf(i))
      boxes.back().add(p);
  }
  const BoxTree tree(boxes);
  std::vector<MetFace> all;
  for (std::size_t at = 0; at < met.size(); ++at) {
    if (!trimmed.rests[met[at]].parts.empty())
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

} // namespace tetvdb
