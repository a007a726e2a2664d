// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/SplitPolyhedron.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tetvdb {
namespace {

// Volume that inverted tets may have, as a share of the cell's: faces of four and more corners are
// seldom exactly planar.
constexpr double kTolerance = 1e-6;

struct Edge {
  std::uint32_t low, high;
  std::uint32_t face;
  bool forward; ///< the face runs from low to high

  friend bool operator<(const Edge& a, const Edge& b) {
    return a.low != b.low ? a.low < b.low : a.high < b.high;
  }
};

/// Turns faces so that neighbours run along shared edges in opposite directions. False where an
/// edge has not two faces, the faces are not connected, or no such orientation exists.
bool orientAlike(PolyhedronFaces& faces) {
  std::vector<Edge> edges;
  edges.reserve(faces.nodes.size());
  for (std::size_t f = 0; f < faces.count(); ++f) {
    const std::size_t begin = faces.begin[f];
    const std::size_t end = faces.begin[f + 1];
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t a = faces.nodes[i];
      const std::uint32_t b = faces.nodes[i + 1 == end ? begin : i + 1];
      if (a == b)
        return false;
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(f), a < b});
    }
  }
  std::sort(edges.begin(), edges.end());
  if (edges.size() % 2 != 0)
    return false;
  struct Neighbour {
    std::uint32_t face;
    bool turned;
  };
  std::vector<std::vector<Neighbour>> neighbours(faces.count());
  for (std::size_t i = 0; i < edges.size(); i += 2) {
    const Edge& a = edges[i];
    const Edge& b = edges[i + 1];
    const bool third = i + 2 < edges.size() && !(b < edges[i + 2]);
    if (a < b || third || a.face == b.face)
      return false;
    const bool turned = a.forward == b.forward;
    neighbours[a.face].push_back({b.face, turned});
    neighbours[b.face].push_back({a.face, turned});
  }
  enum class Turn : std::uint8_t { Unknown, As, Reversed };
  std::vector<Turn> turn(faces.count(), Turn::Unknown);
  std::vector<std::uint32_t> open{0};
  turn[0] = Turn::As;
  for (std::size_t done = 0; done < open.size(); ++done)
    for (const Neighbour& next : neighbours[open[done]]) {
      const bool reversed = (turn[open[done]] == Turn::Reversed) != next.turned;
      const Turn wanted = reversed ? Turn::Reversed : Turn::As;
      if (turn[next.face] == Turn::Unknown) {
        turn[next.face] = wanted;
        open.push_back(next.face);
      } else if (turn[next.face] != wanted) {
        return false;
      }
    }
  if (open.size() != faces.count())
    return false;
  for (std::size_t f = 0; f < faces.count(); ++f)
    if (turn[f] == Turn::Reversed)
      std::reverse(faces.nodes.begin() + static_cast<std::ptrdiff_t>(faces.begin[f]),
                   faces.nodes.begin() + static_cast<std::ptrdiff_t>(faces.begin[f + 1]));
  return true;
}

} // namespace

PolyhedronFaces polyhedronFaces(const std::uint32_t* numbers, std::size_t size) {
  PolyhedronFaces faces;
  if (size == 0 || numbers[0] > size)
    return faces;
  std::size_t at = 1;
  for (std::uint32_t f = 0; f < numbers[0]; ++f) {
    if (at >= size || numbers[at] > size - at - 1)
      return {};
    const std::size_t sides = numbers[at++];
    faces.nodes.insert(faces.nodes.end(), numbers + at, numbers + at + sides);
    faces.begin.push_back(faces.nodes.size());
    at += sides;
  }
  return faces;
}

bool splitPolyhedron(PolyhedronFaces faces, const std::vector<Vec3d>& points,
                     std::vector<std::uint32_t>& tets) {
  if (faces.count() < 4 || !orientAlike(faces))
    return false;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return isBefore(points.data(), a, b);
  };
  const std::uint32_t apex = *std::min_element(faces.nodes.begin(), faces.nodes.end(), before);
  const std::size_t tetsBefore = tets.size();
  std::vector<double> volumes;
  for (std::size_t f = 0; f < faces.count(); ++f) {
    const std::uint32_t* corner = faces.nodes.data() + faces.begin[f];
    const std::size_t sides = faces.begin[f + 1] - faces.begin[f];
    if (std::find(corner, corner + sides, apex) != corner + sides)
      continue;
    const auto first =
        static_cast<std::size_t>(std::min_element(corner, corner + sides, before) - corner);
    for (std::size_t i = 1; i + 1 < sides; ++i) {
      const std::array<std::uint32_t, 4> tet{apex, corner[first], corner[(first + i) % sides],
                                             corner[(first + i + 1) % sides]};
      volumes.push_back(
          sixfoldVolume(points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]));
      tets.insert(tets.end(), tet.begin(), tet.end());
    }
  }
  double positive = 0;
  double negative = 0;
  for (const double volume : volumes)
    (volume > 0 ? positive : negative) += volume;
  if (positive < -negative)
    std::swap(positive, negative);
  if (volumes.empty() || std::abs(negative) > kTolerance * std::abs(positive)) {
    tets.resize(tetsBefore);
    return false;
  }
  return true;
}

} // namespace tetvdb
