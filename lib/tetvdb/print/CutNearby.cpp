// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/CutNearby.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/FloatPositions.h"
#include "tetvdb/surface/RemoveCrossings.h"
#include "tetvdb/surface/SampleBox.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr double kFarFaces = 256;     // multiple of the size of the faces nearby: the end
                                      // of walls
constexpr int kDirections = 256;      // candidates for the direction of the apex
constexpr double kOpposite = -0.9999; // cosine beyond which the apex is behind the ball
// Relative to the ball around the tool, and to a cube around the faces nearby, which determines the
// rounding of intersections.
constexpr double kSameVolume = 1e-6, kSameVolumeFar = 1e-8;

using Edge = std::pair<std::uint32_t, std::uint32_t>;

void addFace(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.triangles.insert(mesh.triangles.end(), {a, b, c});
  mesh.faceCount = mesh.triangleCount();
}

void append(TriangleMesh& mesh, const TriangleMesh& more, bool turned) {
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), more.points.begin(), more.points.end());
  for (std::size_t i = 0; i < more.triangles.size(); i += 3)
    addFace(mesh, first + more.triangles[i], first + more.triangles[i + (turned ? 2 : 1)],
            first + more.triangles[i + (turned ? 1 : 2)]);
}

void addBox(TriangleMesh& mesh, const Vec3d& centre, double half, bool turned) {
  TriangleMesh box;
  for (int i = 0; i < 8; ++i)
    box.points.push_back({centre[0] + (i & 1 ? half : -half), centre[1] + (i & 2 ? half : -half),
                          centre[2] + (i & 4 ? half : -half)});
  constexpr std::uint32_t kSides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& side : kSides) {
    addFace(box, side[0], side[1], side[2]);
    addFace(box, side[0], side[2], side[3]);
  }
  append(mesh, box, turned);
}

// For a closed mesh (van Oosterom and Strackee 1983); none on its faces.
std::optional<int> windingAt(const TriangleMesh& mesh, const Vec3d& p) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const Vec3d a = minus(mesh.points[mesh.triangles[i]], p);
    const Vec3d b = minus(mesh.points[mesh.triangles[i + 1]], p);
    const Vec3d c = minus(mesh.points[mesh.triangles[i + 2]], p);
    const double la = length(a), lb = length(b), lc = length(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)),
                          la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  const double winding = sum / (4 * kPi), whole = std::round(winding);
  if (!(std::abs(winding - whole) < 1e-3))
    return std::nullopt;
  return static_cast<int>(whole);
}

double volumeAbout(const TriangleMesh& mesh, const Vec3d& centre) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
    sum += dot(minus(mesh.points[mesh.triangles[i]], centre),
               cross(minus(mesh.points[mesh.triangles[i + 1]], centre),
                     minus(mesh.points[mesh.triangles[i + 2]], centre)));
  return sum / 6;
}

// Edges of a mesh with a face on the left and none on the right; none if an edge is traversed twice
// in one direction.
std::optional<std::set<Edge>> borderOf(const std::vector<std::uint32_t>& triangles) {
  std::set<Edge> edges;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (!edges.insert({triangles[i], triangles[i % 3 == 2 ? i - 2 : i + 1]}).second)
      return std::nullopt;
  std::set<Edge> border;
  for (const Edge& edge : edges)
    if (edges.count({edge.second, edge.first}) == 0)
      border.insert(edge);
  return border;
}

class Cutting {
public:
  Cutting(TriangleMesh& solid, const TriangleMesh& tool, const Vec3d& centre, double reach,
          NearbyCut& cut, Progress& progress)
      : solid_(solid), tool_(tool), centre_(centre), reach_(reach), cut_(cut), progress_(progress) {
  }

  bool run() {
    if (!gather() || !close() || !compareWinding())
      return false;
    TriangleMesh rest = closed_;
    append(rest, tool_, true);
    TriangleMesh taken = closed_;
    append(taken, tool_, false);
    if (!cutAlone(rest, 0) || !cutAlone(taken, 1))
      return false;
    return take(taken) && replace(rest);
  }

private:
  // Faces nearby, with separate points.
  bool gather() {
    isNear_.assign(solid_.triangleCount(), 0);
    std::map<std::uint32_t, std::uint32_t> numbers;
    for (std::size_t face = 0; face < isNear_.size(); ++face) {
      const std::uint32_t* v = solid_.triangles.data() + 3 * face;
      const Vec3d a = minus(solid_.points[v[0]], centre_), b = minus(solid_.points[v[1]], centre_),
                  c = minus(solid_.points[v[2]], centre_);
      bool isFar = false;
      for (std::size_t k = 0; k < 3; ++k)
        isFar = isFar || std::min({a[k], b[k], c[k]}) > reach_ ||
                std::max({a[k], b[k], c[k]}) < -reach_;
      if (isFar || nearestOnTriangle(a, b, c).squared > reach_ * reach_)
        continue;
      isNear_[face] = 1;
      std::array<std::uint32_t, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [entry, isNew] =
            numbers.try_emplace(v[k], static_cast<std::uint32_t>(near_.points.size()));
        if (isNew) {
          near_.points.push_back(solid_.points[v[k]]);
          numberOf_.emplace(solid_.points[v[k]], v[k]);
        }
        corners[k] = entry->second;
      }
      addFace(near_, corners[0], corners[1], corners[2]);
    }
    return near_.triangleCount() > 0 && numberOf_.size() == near_.points.size();
  }

  // Walls from the border straight away from the ball, and a fan from their ends to an apex.
  bool close() {
    const auto border = borderOf(near_.triangles);
    if (!border)
      return false;
    border_ = *border;
    closed_ = near_;
    double extent = reach_;
    for (const Vec3d& p : near_.points)
      extent = std::max(extent, length(minus(p, centre_)));
    far_ = kFarFaces * extent;
    std::map<std::uint32_t, std::uint32_t> ends;
    std::vector<Vec3d> directions;
    for (const Edge& edge : border_) {
      const Vec3d off = minus(near_.points[edge.first], centre_);
      directions.push_back(times(off, 1 / length(off)));
      if (ends.emplace(edge.first, static_cast<std::uint32_t>(closed_.points.size())).second)
        closed_.points.push_back(plus(centre_, times(directions.back(), far_)));
    }
    if (border_.empty())
      return true;
    const auto apex = static_cast<std::uint32_t>(closed_.points.size());
    closed_.points.push_back(plus(centre_, times(apexDirection(directions), far_)));
    if (apexIsBehind_)
      return false;
    for (const auto& [from, to] : border_) {
      const std::uint32_t fromEnd = ends.at(from), toEnd = ends.at(to);
      addFace(closed_, to, from, fromEnd);
      addFace(closed_, to, fromEnd, toEnd);
      addFace(closed_, toEnd, fromEnd, apex);
    }
    return true;
  }

  // The direction farthest from the opposite of all.
  Vec3d apexDirection(const std::vector<Vec3d>& directions) {
    Vec3d best{0, 0, 1};
    double bestCosine = -2;
    const Box box{{-1, -1, -1}, {1, 1, 1}};
    for (std::size_t i = 0; i < kDirections; ++i) {
      Vec3d u = pointInBox(box, i);
      const double size = length(u);
      if (!(size > 0.1))
        continue;
      u = times(u, 1 / size);
      double cosine = 1;
      for (const Vec3d& direction : directions)
        cosine = std::min(cosine, dot(u, direction));
      if (cosine > bestCosine) {
        bestCosine = cosine;
        best = u;
      }
    }
    apexIsBehind_ = bestCosine < kOpposite;
    return best;
  }

  // The difference of winding numbers in the ball from those of the solid.
  bool compareWinding() {
    constexpr int kTries = 8;
    const double half = reach_ / 4;
    const Box box{minus(centre_, {half, half, half}), plus(centre_, {half, half, half})};
    for (std::size_t i = 0; i < kTries; ++i) {
      progress_.check();
      const Vec3d p = pointInBox(box, i);
      const std::optional<int> own = windingAt(closed_, p);
      const std::optional<int> whole = own ? windingAt(solid_, p) : std::nullopt;
      if (!whole)
        continue;
      excess_ = *own - *whole;
      return true;
    }
    return false;
  }

  // The region enclosed more than `times` times, by winding numbers of the solid.
  bool cutAlone(TriangleMesh& mesh, int times) {
    const int less = excess_ + times;
    for (int i = 0; i < std::abs(less); ++i)
      addBox(mesh, centre_, far_ * (2 + i), less > 0);
    const CrossingCounts counts = removeCrossings(mesh, NewCorners::FloatsAsGiven, progress_);
    if (times == 0)
      cut_.cutFaces = counts.cutFaces;
    return counts.complete;
  }

  // The part inside the ball.
  bool take(const TriangleMesh& made) {
    cut_.taken = made;
    std::vector<char> drops(made.triangleCount(), 0);
    for (std::size_t i = 0; i < made.triangles.size(); ++i)
      if (length(minus(made.points[made.triangles[i]], centre_)) > reach_)
        drops[i / 3] = 1;
    dropFaces(cut_.taken, drops);
    dropUnusedPoints(cut_.taken);
    cut_.taken.faceCount = cut_.taken.triangleCount();
    cut_.taken.units = solid_.units;
    const auto border = borderOf(cut_.taken.triangles);
    return border && border->empty() && equalAsFloats(cut_.taken.points).empty();
  }

  bool replace(const TriangleMesh& made) {
    // Numbers in the solid; new points follow the existing ones.
    std::vector<Vec3d> points = solid_.points;
    std::vector<std::uint32_t> numbers;
    std::map<Vec3d, std::uint32_t> known = numberOf_;
    for (const Vec3d& p : made.points) {
      const auto [entry, isNew] = known.try_emplace(p, static_cast<std::uint32_t>(points.size()));
      if (isNew)
        points.push_back(p);
      numbers.push_back(entry->second);
    }
    std::set<Edge> border;
    for (const auto& [from, to] : border_)
      border.emplace(numberOf_.at(near_.points[from]), numberOf_.at(near_.points[to]));
    const std::vector<std::uint32_t> inner = withinBorder(made, numbers, border);
    const auto found = borderOf(inner);
    if (!found || *found != border)
      return false;
    TriangleMesh patch;
    patch.points = points;
    patch.triangles = inner;
    const double lost = volumeAbout(near_, centre_) - volumeAbout(patch, centre_);
    const double ball = 4 * kPi / 3 * reach_ * reach_ * reach_, extent = far_ / kFarFaces;
    if (!(std::abs(lost - volumeAbout(cut_.taken, centre_)) <
          kSameVolume * ball + kSameVolumeFar * extent * extent * extent))
      return false;
    dropUnusedPoints(patch);
    if (!equalAsFloats(patch.points).empty())
      return false;
    std::vector<std::uint32_t> triangles;
    triangles.reserve(solid_.triangles.size() + inner.size());
    for (std::size_t i = 0; i < solid_.triangles.size(); ++i)
      if (isNear_[i / 3] == 0)
        triangles.push_back(solid_.triangles[i]);
    triangles.insert(triangles.end(), inner.begin(), inner.end());
    solid_.points = std::move(points);
    solid_.triangles = std::move(triangles);
    solid_.faceCount = solid_.triangleCount();
    dropUnusedPoints(solid_);
    return true;
  }

  // Faces that are connected to the left side of the border without crossing it; without a border,
  // all faces that do not reach the boxes.
  std::vector<std::uint32_t> withinBorder(const TriangleMesh& made,
                                          const std::vector<std::uint32_t>& numbers,
                                          const std::set<Edge>& border) const {
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t v : made.triangles)
      corners.push_back(numbers[v]);
    std::map<Edge, std::size_t> faceAt;
    const auto edgeOf = [&](std::size_t i) {
      return Edge{corners[i], corners[i % 3 == 2 ? i - 2 : i + 1]};
    };
    for (std::size_t i = 0; i < corners.size(); ++i)
      faceAt[edgeOf(i)] = i / 3;
    std::vector<char> isWithin(made.triangleCount(), 0);
    std::vector<std::size_t> open;
    const auto reachFace = [&](std::size_t face) {
      if (isWithin[face] == 0) {
        isWithin[face] = 1;
        open.push_back(face);
      }
    };
    for (const Edge& edge : border)
      if (const auto at = faceAt.find(edge); at != faceAt.end())
        reachFace(at->second);
    // Without a border: components that lie in the ball.
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (length(minus(made.points[made.triangles[i]], centre_)) <= reach_)
        reachFace(i / 3);
    while (!open.empty()) {
      const std::size_t face = open.back();
      open.pop_back();
      for (std::size_t i = 3 * face; i < 3 * face + 3; ++i) {
        const Edge edge = edgeOf(i);
        if (border.count(edge) > 0)
          continue;
        if (const auto at = faceAt.find({edge.second, edge.first}); at != faceAt.end())
          reachFace(at->second);
      }
    }
    std::vector<std::uint32_t> inner;
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (isWithin[i / 3] != 0)
        inner.push_back(corners[i]);
    return inner;
  }

  TriangleMesh& solid_;
  const TriangleMesh& tool_;
  const Vec3d centre_;
  const double reach_;
  NearbyCut& cut_;
  Progress& progress_;
  std::vector<char> isNear_; ///< faces of the solid
  TriangleMesh near_, closed_;
  std::map<Vec3d, std::uint32_t> numberOf_; ///< in the solid, of points nearby
  std::set<Edge> border_;                   ///< of near_
  double far_ = 0;
  bool apexIsBehind_ = false;
  int excess_ = 0;
};

} // namespace

bool cutNearby(TriangleMesh& solid, const TriangleMesh& tool, const Vec3d& centre, double reach,
               NearbyCut& cut, Progress& progress) {
  return Cutting(solid, tool, centre, reach, cut, progress).run();
}

} // namespace tetvdb
