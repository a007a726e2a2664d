// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/StitchBoundaries.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/TriangulatePolygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr int kMaxRounds = 6;
constexpr double kJoinShare = 0.1;     // of the shortest boundary edge at a vertex
constexpr double kJoinDiagonal = 1e-3; // of the box's diagonal
constexpr double kSplitShare = 0.02;   // of the shortest boundary edge at a vertex
constexpr double kRounding = 0x1p-21;  // of the largest coordinate: several units of a float
constexpr double kFlat = 0x1p-22;      // of the largest coordinate: below a unit of a float
constexpr double kAgainst = -0.9;      // cosine between edges of opposite directions

// The boundary of a mesh: sides that no other face shares, and their vertices.
class Boundary {
public:
  Boundary(const TriangleMesh& mesh, const EdgeTable& edges) : mesh_(mesh) {
    const Box box = boxOf(mesh.points, mesh.triangles);
    for (const Vec3d& p : {box.low, box.high})
      for (const double c : p)
        rounding_ = std::max(rounding_, kRounding * std::abs(c));
    maxJoin_ = kJoinDiagonal * length(minus(box.high, box.low));
    for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
      if (edges.sides(edge).size() == 1)
        sides_.push_back(edges.sides(edge)[0]);
    std::sort(sides_.begin(), sides_.end());
    for (const std::uint32_t side : sides_) {
      const double size = lengthOf(side);
      for (const std::uint32_t v : {start(side), end(side)}) {
        const auto [entry, isNew] = shortest_.try_emplace(v, size);
        entry->second = std::min(entry->second, size);
        atVertex_[v].push_back(side);
      }
    }
    std::vector<Box> boxes;
    for (const auto& [v, size] : shortest_) {
      vertices_.push_back(v);
      boxes.push_back(Box{mesh.points[v], mesh.points[v]});
    }
    tree_ = std::make_unique<BoxTree>(std::move(boxes));
  }

  const std::vector<std::uint32_t>& sides() const { return sides_; }
  const std::vector<std::uint32_t>& vertices() const { return vertices_; }
  const std::vector<std::uint32_t>& sidesAt(std::uint32_t vertex) const {
    return atVertex_.at(vertex);
  }
  std::uint32_t start(std::uint32_t side) const { return mesh_.triangles[side]; }
  std::uint32_t end(std::uint32_t side) const { return mesh_.triangles[EdgeTable::next(side)]; }
  const Vec3d& at(std::uint32_t vertex) const { return mesh_.points[vertex]; }
  double distance(std::uint32_t a, std::uint32_t b) const { return length(minus(at(a), at(b))); }
  double lengthOf(std::uint32_t side) const { return distance(start(side), end(side)); }

  double joinDistance(std::uint32_t v) const {
    const double size = shortest_.at(v);
    return std::min(0.4 * size, std::max(std::min(kJoinShare * size, maxJoin_), rounding_));
  }
  double splitDistance(std::uint32_t v) const {
    const double size = shortest_.at(v);
    return std::min(0.4 * size, std::max(kSplitShare * size, rounding_));
  }

  template <typename Visit>
  void eachVertexIn(Box box, double margin, const Visit& visit) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] -= margin;
      box.high[axis] += margin;
    }
    std::vector<std::uint32_t> found;
    tree_->visit([&](const Box& other) { return other.meets(box); },
                 [&](std::uint32_t item) {
                   found.push_back(vertices_[item]);
                   return false;
                 });
    std::sort(found.begin(), found.end());
    for (const std::uint32_t v : found)
      visit(v);
  }

private:
  const TriangleMesh& mesh_;
  double rounding_ = 0, maxJoin_ = 0;
  std::vector<std::uint32_t> sides_, vertices_; ///< ascending
  std::map<std::uint32_t, double> shortest_;    ///< boundary edge at a vertex
  std::map<std::uint32_t, std::vector<std::uint32_t>> atVertex_;
  std::unique_ptr<BoxTree> tree_;
};

// --- Merging points of boundary edges.

class Joining {
public:
  Joining(TriangleMesh& mesh, const Boundary& boundary)
      : mesh_(mesh), boundary_(boundary), sets_(mesh.points.size()) {
    for (const std::uint32_t v : boundary.vertices())
      members_[v] = {v};
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      if (members_.count(mesh.triangles[i]) == 0)
        continue;
      auto& around = neighbours_[mesh.triangles[i]];
      const auto side = static_cast<std::uint32_t>(i);
      around.push_back(mesh.triangles[EdgeTable::next(side)]);
      around.push_back(mesh.triangles[EdgeTable::previous(side)]);
    }
  }

  void run(StitchCounts& counts, Progress& progress) {
    using Pair = std::tuple<double, std::uint32_t, std::uint32_t>;
    std::vector<Pair> pairs;
    for (const std::uint32_t side : boundary_.sides()) {
      progress.check();
      const std::uint32_t a = boundary_.start(side), b = boundary_.end(side);
      Box place;
      place.add(boundary_.at(a));
      boundary_.eachVertexIn(place, boundary_.joinDistance(a), [&](std::uint32_t c) {
        for (const std::uint32_t other : boundary_.sidesAt(c)) {
          const std::uint32_t d = boundary_.start(other);
          if (other <= side || boundary_.end(other) != c || (a == c && b == d))
            continue;
          const double first = boundary_.distance(a, c), second = boundary_.distance(b, d);
          if (first <= std::min(boundary_.joinDistance(a), boundary_.joinDistance(c)) &&
              second <= std::min(boundary_.joinDistance(b), boundary_.joinDistance(d)))
            pairs.emplace_back(std::max(first, second), side, other);
        }
      });
    }
    std::sort(pairs.begin(), pairs.end());
    std::map<std::uint32_t, bool> matched;
    for (const auto& [distance, side, other] : pairs) {
      if (matched[side] || matched[other])
        continue;
      const bool first = join(boundary_.start(side), boundary_.end(other));
      const bool second = join(boundary_.end(side), boundary_.start(other));
      if (first && second)
        matched[side] = matched[other] = true;
    }
    for (const std::uint32_t v : boundary_.vertices()) {
      const std::uint32_t becomes = sets_.find(v);
      if (becomes == v)
        continue;
      ++counts.joinedPoints;
      counts.largestMove = std::max(counts.largestMove, boundary_.distance(v, becomes));
    }
    for (std::uint32_t& corner : mesh_.triangles)
      corner = sets_.find(corner);
  }

private:
  // Returns false if an edge would have no length.
  bool join(std::uint32_t a, std::uint32_t b) {
    a = sets_.find(a);
    b = sets_.find(b);
    if (a == b)
      return true;
    for (const std::uint32_t member : members_[a])
      for (const std::uint32_t neighbour : neighbours_[member])
        if (sets_.find(neighbour) == b)
          return false;
    sets_.join(a, b);
    std::vector<std::uint32_t>&kept = members_[std::min(a, b)], &gone = members_[std::max(a, b)];
    kept.insert(kept.end(), gone.begin(), gone.end());
    gone.clear();
    return true;
  }

  TriangleMesh& mesh_;
  const Boundary& boundary_;
  DisjointSets sets_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> members_, neighbours_;
};

// --- Splitting faces at vertices on their boundary edges.

struct Split {
  double along; ///< from the side's first point
  std::uint32_t vertex;
  bool operator<(const Split& other) const {
    return std::tie(along, vertex) < std::tie(other.along, other.vertex);
  }
};

double distanceToSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b, double& along) {
  const Vec3d way = minus(b, a);
  const double size = dot(way, way);
  const double share = size > 0 ? std::clamp(dot(minus(p, a), way) / size, 0.0, 1.0) : 0;
  along = share * std::sqrt(size);
  return length(minus(p, plus(a, times(way, share))));
}

// Whether a boundary edge at `v` runs along the side in the opposite direction.
bool hasEdgeAlong(const Boundary& boundary, std::uint32_t side, std::uint32_t v, double distance) {
  const Vec3d &a = boundary.at(boundary.start(side)), &b = boundary.at(boundary.end(side));
  const Vec3d way = minus(b, a);
  for (const std::uint32_t other : boundary.sidesAt(v)) {
    if (other == side)
      continue;
    const Vec3d &p = boundary.at(boundary.start(other)), &q = boundary.at(boundary.end(other));
    if (dot(minus(q, p), way) > kAgainst * boundary.lengthOf(other) * boundary.lengthOf(side))
      continue;
    double along;
    const Vec3d& far = boundary.start(other) == v ? q : p;
    if (distanceToSegment(far, a, b, along) <= distance ||
        distanceToSegment(a, p, q, along) <= distance ||
        distanceToSegment(b, p, q, along) <= distance)
      return true;
  }
  return false;
}

std::map<std::uint32_t, std::vector<Split>> findSplits(const Boundary& boundary,
                                                       Progress& progress) {
  std::map<std::uint32_t, std::vector<Split>> splits; // by side
  for (const std::uint32_t side : boundary.sides()) {
    progress.check();
    const std::uint32_t a = boundary.start(side), b = boundary.end(side);
    const double max = std::min(boundary.splitDistance(a), boundary.splitDistance(b));
    Box box;
    box.add(boundary.at(a));
    box.add(boundary.at(b));
    boundary.eachVertexIn(box, max, [&](std::uint32_t v) {
      const double near = std::min(max, boundary.splitDistance(v));
      double along;
      if (v == a || v == b ||
          distanceToSegment(boundary.at(v), boundary.at(a), boundary.at(b), along) > near ||
          boundary.distance(v, a) <= near || boundary.distance(v, b) <= near ||
          !hasEdgeAlong(boundary, side, v, near))
        return;
      splits[side].push_back({along, v});
    });
  }
  return splits;
}

void splitFaces(TriangleMesh& mesh, const Boundary& boundary, StitchCounts& counts,
                Progress& progress) {
  std::map<std::uint32_t, std::vector<Split>> splits = findSplits(boundary, progress);
  for (auto entry = splits.begin(); entry != splits.end();) {
    const std::uint32_t face = EdgeTable::faceOf(entry->first);
    std::vector<std::uint32_t> outline;
    const std::array<std::uint32_t, 3> c{mesh.triangles[3 * face], mesh.triangles[3 * face + 1],
                                         mesh.triangles[3 * face + 2]};
    for (std::uint32_t k = 0; k < 3; ++k) {
      outline.push_back(c[k]);
      if (entry == splits.end() || entry->first != 3 * face + k)
        continue;
      std::sort(entry->second.begin(), entry->second.end());
      for (const Split& split : entry->second)
        outline.push_back(split.vertex);
      ++entry;
    }
    std::vector<std::uint32_t> sorted = outline;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
      continue;
    const Vec3d normal = cross(minus(mesh.points[c[1]], mesh.points[c[0]]),
                               minus(mesh.points[c[2]], mesh.points[c[0]]));
    std::vector<std::uint32_t> parts;
    if (!triangulatePolygon(
            mesh.points, {outline}, normal, [](std::uint32_t, std::uint32_t) { return false; },
            parts))
      continue;
    std::copy(parts.begin(), parts.begin() + 3, mesh.triangles.begin() + 3 * std::ptrdiff_t(face));
    mesh.triangles.insert(mesh.triangles.end(), parts.begin() + 3, parts.end());
    ++counts.splitFaces;
  }
}

// --- Collinear faces.

// The largest height of a face that 32-bit floats cannot resolve.
double flatHeight(const TriangleMesh& mesh) {
  double largest = 0;
  for (const std::uint32_t corner : mesh.triangles)
    for (const double c : mesh.points[corner])
      largest = std::max(largest, std::abs(c));
  return kFlat * largest;
}

// The side of three points (0: from the first to the second) whose opposite point lies on it, or
// within `height` of it, between its end points; 3 if they are a face with area.
std::uint32_t flatSide(const std::array<Vec3d, 3>& p, double height) {
  std::uint32_t longest = 0;
  double max = -1;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const double size = length(minus(p[(k + 1) % 3], p[k]));
    if (size > max) {
      max = size;
      longest = k;
    }
  }
  if (areCollinear(p[0], p[1], p[2]))
    return longest;
  const double twice = length(cross(minus(p[1], p[0]), minus(p[2], p[0])));
  return twice <= height * max ? longest : 3;
}

std::uint32_t longSide(const TriangleMesh& mesh, std::uint32_t face, double height) {
  const std::uint32_t* c = &mesh.triangles[3 * std::size_t(face)];
  const std::uint32_t side =
      flatSide({mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]]}, height);
  return side == 3 ? EdgeTable::kNone : 3 * face + side;
}

std::size_t flipFlat(TriangleMesh& mesh, const EdgeTable& edges) {
  const double height = flatHeight(mesh);
  std::vector<std::uint32_t> long_;
  for (std::uint32_t face = 0; face < mesh.triangleCount(); ++face)
    if (const std::uint32_t side = longSide(mesh, face, height); side != EdgeTable::kNone)
      long_.push_back(side);
  if (long_.empty())
    return 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> made; // edges of this round
  std::vector<char> touched(mesh.triangleCount(), 0);
  const auto exists = [&](std::uint32_t a, std::uint32_t b) {
    const auto low = std::min(a, b), high = std::max(a, b);
    std::uint32_t first = 0, last = edges.edgeCount();
    while (first < last) {
      const std::uint32_t midpoint = first + (last - first) / 2;
      if (std::make_pair(edges.lowPoint(midpoint), edges.highPoint(midpoint)) <
          std::make_pair(low, high))
        first = midpoint + 1;
      else
        last = midpoint;
    }
    return (first < edges.edgeCount() && edges.lowPoint(first) == low &&
            edges.highPoint(first) == high) ||
           made.count({low, high}) > 0;
  };
  std::size_t flipped = 0;
  for (const std::uint32_t side : long_) {
    const std::uint32_t face = EdgeTable::faceOf(side);
    if (!edges.hasFace(face))
      continue;
    const EdgeTable::Sides sides = edges.sides(edges.edgeOf(side));
    if (sides.size() != 2)
      continue;
    const std::uint32_t back = sides[0] == side ? sides[1] : sides[0];
    const std::uint32_t other = EdgeTable::faceOf(back);
    // The side runs from c to a with b in between; the neighbour is (a, c, d).
    const std::uint32_t c = mesh.triangles[side], a = mesh.triangles[EdgeTable::next(side)],
                        b = mesh.triangles[EdgeTable::previous(side)],
                        d = mesh.triangles[EdgeTable::previous(back)];
    if (touched[face] != 0 || touched[other] != 0 || mesh.triangles[back] != a || b == d ||
        longSide(mesh, other, height) != EdgeTable::kNone || exists(b, d) ||
        flatSide({mesh.points[a], mesh.points[b], mesh.points[d]}, height) != 3 ||
        flatSide({mesh.points[b], mesh.points[c], mesh.points[d]}, height) != 3)
      continue;
    const std::array<std::uint32_t, 3> first{a, b, d}, second{b, c, d};
    std::copy(first.begin(), first.end(), &mesh.triangles[3 * std::size_t(face)]);
    std::copy(second.begin(), second.end(), &mesh.triangles[3 * std::size_t(other)]);
    touched[face] = touched[other] = 1;
    made[{std::min(b, d), std::max(b, d)}] = true;
    ++flipped;
  }
  return flipped;
}

} // namespace

StitchCounts stitchBoundaries(TriangleMesh& mesh, Progress& progress) {
  StitchCounts counts;
  for (int round = 0; round < kMaxRounds; ++round) {
    const StitchCounts before = counts;
    {
      const EdgeTable edges(mesh);
      const Boundary boundary(mesh, edges);
      if (!boundary.sides().empty())
        Joining(mesh, boundary).run(counts, progress);
    }
    {
      const EdgeTable edges(mesh);
      const Boundary boundary(mesh, edges);
      if (!boundary.sides().empty())
        splitFaces(mesh, boundary, counts, progress);
    }
    const EdgeTable edges(mesh);
    counts.flippedFaces += flipFlat(mesh, edges);
    if (counts.joinedPoints == before.joinedPoints && counts.splitFaces == before.splitFaces &&
        counts.flippedFaces == before.flippedFaces)
      break;
  }
  dropUnusedPoints(mesh);
  mesh.faceCount = mesh.triangleCount();
  return counts;
}

} // namespace tetvdb
