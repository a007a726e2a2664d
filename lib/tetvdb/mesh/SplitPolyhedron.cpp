// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/SplitPolyhedron.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/AddedValues.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tetvdb {
namespace {

// Volume that inverted tets may have, as a share of the cell's: faces of four and more corners are
// seldom exactly planar.
constexpr double kTolerance = 1e-6;
// Of a cell that is not star-shaped about its centre either. All tets lie in the hull of its
// vertices.
constexpr double kMostInverted = 0.5;
constexpr double kFlat = 1e-3; // how far from their plane a face's corners are, for its size

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

// The mean of points, each once.
Vec3d meanOf(const std::vector<std::uint32_t>& nodes, const std::vector<Vec3d>& points) {
  Vec3d sum{0, 0, 0};
  for (const std::uint32_t node : nodes)
    for (std::size_t k = 0; k < 3; ++k)
      sum[k] += points[node][k] / static_cast<double>(nodes.size());
  return sum;
}

std::vector<std::uint32_t> ascending(const std::uint32_t* nodes, std::size_t count) {
  std::vector<std::uint32_t> sorted(nodes, nodes + count);
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

// Whether all corners of a face are close to a plane through its mean.
bool isFlat(const std::uint32_t* corners, std::size_t count, const Vec3d& mean,
            const std::vector<Vec3d>& points) {
  // Newell's normal: the sum of the products of neighbours.
  Vec3d normal{0, 0, 0};
  double size = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d a = minus(points[corners[i]], mean);
    const Vec3d n = cross(a, minus(points[corners[(i + 1) % count]], mean));
    for (std::size_t k = 0; k < 3; ++k)
      normal[k] += n[k];
    size = std::max(size, dot(a, a));
  }
  const double bound = kFlat * std::sqrt(size * dot(normal, normal));
  for (std::size_t i = 0; i < count; ++i)
    if (std::abs(dot(normal, minus(points[corners[i]], mean))) > bound)
      return false;
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

std::uint32_t PolyhedronCutter::addPoint(const Vec3d& p,
                                         const std::vector<std::uint32_t>& vertices) {
  points_.push_back(p);
  vertices_.insert(vertices_.end(), vertices.begin(), vertices.end());
  begin_.push_back(vertices_.size());
  return static_cast<std::uint32_t>(points_.size() - 1);
}

// The point that a face is fanned from; kNone: its smallest vertex.
std::uint32_t PolyhedronCutter::centreOf(const std::uint32_t* corners, std::size_t count) {
  if (count < 5)
    return kNone;
  const std::vector<std::uint32_t> vertices = ascending(corners, count);
  const Vec3d mean = meanOf(vertices, points_);
  if (isFlat(corners, count, mean, points_))
    return kNone;
  std::uint64_t hash = 0;
  for (const std::uint32_t vertex : vertices)
    hash = (hash ^ vertex) * 0x9E3779B97F4A7C15u;
  const auto [begin, end] = centres_.equal_range(hash);
  for (auto at = begin; at != end; ++at) {
    const std::size_t number = at->second - first_;
    if (std::equal(vertices.begin(), vertices.end(),
                   vertices_.begin() + static_cast<std::ptrdiff_t>(begin_[number]),
                   vertices_.begin() + static_cast<std::ptrdiff_t>(begin_[number + 1])))
      return at->second;
  }
  const std::uint32_t centre = addPoint(mean, vertices);
  centres_.emplace(hash, centre);
  return centre;
}

// Adds the tets between a point and the faces that do not hold it; returns the volumes of one sign
// and of the other, the larger first.
std::array<double, 2> PolyhedronCutter::join(const PolyhedronFaces& faces, std::uint32_t apex,
                                             std::vector<std::uint32_t>& tets) const {
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return isBefore(points_.data(), a, b);
  };
  double positive = 0, negative = 0;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const double volume = sixfoldVolume(points_[apex], points_[a], points_[b], points_[c]);
    (volume > 0 ? positive : negative) += volume;
    tets.insert(tets.end(), {apex, a, b, c});
  };
  for (std::size_t f = 0; f < faces.count(); ++f) {
    const std::uint32_t* corner = faces.nodes.data() + faces.begin[f];
    const std::size_t sides = faces.begin[f + 1] - faces.begin[f];
    if (std::find(corner, corner + sides, apex) != corner + sides)
      continue;
    if (ofFaces_[f] != kNone) {
      for (std::size_t i = 0; i < sides; ++i)
        add(ofFaces_[f], corner[i], corner[(i + 1) % sides]);
      continue;
    }
    const auto first =
        static_cast<std::size_t>(std::min_element(corner, corner + sides, before) - corner);
    for (std::size_t i = 1; i + 1 < sides; ++i)
      add(corner[first], corner[(first + i) % sides], corner[(first + i + 1) % sides]);
  }
  return positive < -negative ? std::array<double, 2>{-negative, positive}
                              : std::array<double, 2>{positive, -negative};
}

PolyhedronCut PolyhedronCutter::cut(PolyhedronFaces faces, std::vector<std::uint32_t>& tets) {
  if (faces.count() < 4 || !orientAlike(faces))
    return PolyhedronCut::None;
  const std::size_t before = tets.size();
  ofFaces_.clear();
  bool allFlat = true;
  for (std::size_t f = 0; f < faces.count(); ++f) {
    ofFaces_.push_back(
        centreOf(faces.nodes.data() + faces.begin[f], faces.begin[f + 1] - faces.begin[f]));
    allFlat = allFlat && ofFaces_.back() == kNone;
  }
  if (allFlat) {
    const std::uint32_t smallest = *std::min_element(
        faces.nodes.begin(), faces.nodes.end(),
        [&](std::uint32_t a, std::uint32_t b) { return isBefore(points_.data(), a, b); });
    const auto [volume, inverted] = join(faces, smallest, tets);
    if (tets.size() > before && inverted <= kTolerance * volume)
      return PolyhedronCut::FromVertex;
    tets.resize(before);
  }
  const std::vector<std::uint32_t> vertices = ascending(faces.nodes.data(), faces.nodes.size());
  const std::uint32_t centre = addPoint(meanOf(vertices, points_), vertices);
  const auto [volume, inverted] = join(faces, centre, tets);
  if (inverted <= kTolerance * volume)
    return PolyhedronCut::AroundCentre;
  if (inverted <= kMostInverted * volume)
    return PolyhedronCut::Concave;
  tets.resize(before);
  return PolyhedronCut::None; // the point remains, without tets
}

void PolyhedronCutter::addValues(Attribute& array) const {
  appendAddedValues(
      array, first_, begin_.size() - 1, [&](std::size_t i) { return &vertices_[begin_[i]]; },
      [&](std::size_t i, double base, const auto& difference) {
        const std::size_t count = begin_[i + 1] - begin_[i];
        double sum = 0;
        for (std::size_t k = 0; k < count; ++k)
          sum += difference(k);
        return base + sum / static_cast<double>(count);
      });
}

} // namespace tetvdb
