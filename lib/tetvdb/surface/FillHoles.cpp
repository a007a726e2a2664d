// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FillHoles.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/BoundaryLoops.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/FairPatch.h"
#include "tetvdb/surface/SelfIntersections.h"
#include "tetvdb/surface/TriangulateLoop.h"
#include "tetvdb/surface/TriangulatePolygon.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace tetvdb {
namespace {

// Maximum distance of a plane loop's points from the plane, relative to the loop's size.
constexpr double kFlat = 1e-4;
// Longer loops are not tested for a plane, since the time is quadratic.
constexpr std::size_t kMaxPlanePoints = 4096;
// Curved holes of fewer edges are filled without new points.
constexpr std::size_t kFewestFairEdges = 7;

struct Plane {
  Vec3d origin{0, 0, 0}, normal{0, 0, 0}; ///< the loop is counter-clockwise around the normal
  double area = 0, size = 0;              ///< of the loop; diagonal of its box
  Box box;
  bool flat = false;
};

Plane planeOf(const std::vector<Vec3d>& points, const BoundaryLoop& loop) {
  Plane plane;
  plane.origin = points[loop.points[0]];
  Vec3d sum{0, 0, 0};
  for (std::size_t i = 0; i < loop.points.size(); ++i) {
    const Vec3d& p = points[loop.points[i]];
    plane.box.add(p);
    sum = plus(sum, cross(minus(p, plane.origin),
                          minus(points[loop.points[(i + 1) % loop.points.size()]], plane.origin)));
  }
  plane.size = length(minus(plane.box.high, plane.box.low));
  plane.area = length(sum) / 2;
  if (!(plane.area > 0))
    return plane;
  plane.normal = times(sum, 0.5 / plane.area);
  double low = 0, high = 0;
  for (const std::uint32_t i : loop.points) {
    const double height = dot(minus(points[i], plane.origin), plane.normal);
    low = std::min(low, height);
    high = std::max(high, height);
  }
  plane.flat = high - low <= kFlat * plane.size && loop.points.size() <= kMaxPlanePoints;
  return plane;
}

class Filling {
public:
  Filling(TriangleMesh& mesh, Progress& progress)
      : mesh_(mesh), progress_(progress), edges_(mesh), loops_(findBoundaryLoops(mesh, edges_)) {
    for (const BoundaryLoop& loop : loops_)
      planes_.push_back(planeOf(mesh.points, loop));
    std::vector<char> onLoop(mesh.points.size(), 0);
    for (const BoundaryLoop& loop : loops_)
      for (const std::uint32_t point : loop.points)
        onLoop[point] = 1;
    for (std::uint32_t edge = 0; edge < edges_.edgeCount(); ++edge)
      if (onLoop[edges_.lowPoint(edge)] != 0 && onLoop[edges_.highPoint(edge)] != 0)
        taken_.insert(key(edges_.lowPoint(edge), edges_.highPoint(edge)));
  }

  HoleFilling run() {
    std::vector<std::vector<std::size_t>> within(loops_.size());
    std::vector<char> isInner(loops_.size(), 0);
    findRings(within, isInner);
    HoleFilling filling;
    std::vector<std::uint32_t> added;
    for (std::size_t i = 0; i < loops_.size(); ++i) {
      progress_.check();
      if (isInner[i] != 0)
        continue;
      std::vector<std::size_t> group{i};
      group.insert(group.end(), within[i].begin(), within[i].end());
      if (fillInPlane(group, added, filling))
        continue;
      for (const std::size_t loop : group)
        fillInSpace(loop, added, filling);
    }
    takeBackCrossing(added, filling);
    mesh_.triangles.insert(mesh_.triangles.end(), added.begin(), added.end());
    mesh_.faceCount = mesh_.triangleCount();
    if (dropsPoints_)
      dropUnusedPoints(mesh_);
    return filling;
  }

private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b);
  }
  bool isTaken(std::uint32_t a, std::uint32_t b) const { return taken_.count(key(a, b)) > 0; }

  // Assigns loops to the smallest loop around them in the same plane and of opposite direction.
  void findRings(std::vector<std::vector<std::size_t>>& within, std::vector<char>& isInner) const {
    std::vector<Box> boxes;
    for (const Plane& plane : planes_)
      boxes.push_back(plane.box);
    const BoxTree tree(boxes);
    for (std::uint32_t inner = 0; inner < loops_.size(); ++inner) {
      const Plane& small = planes_[inner];
      if (!small.flat)
        continue;
      std::size_t best = loops_.size();
      tree.visit([&](const Box& box) { return box.meets(small.box); },
                 [&](std::uint32_t outer) {
                   const Plane& large = planes_[outer];
                   if (outer != inner && large.flat && large.area > small.area &&
                       dot(large.normal, small.normal) < -0.999 &&
                       std::abs(dot(minus(small.origin, large.origin), large.normal)) <=
                           kFlat * large.size &&
                       (best == loops_.size() || large.area < planes_[best].area) &&
                       isAround(outer, small.origin))
                     best = outer;
                   return false;
                 });
      if (best == loops_.size() || isInner[best] != 0)
        continue;
      within[best].push_back(inner);
      isInner[inner] = 1;
    }
  }

  // Whether a plane loop encloses a point of its plane, by the sum of angles.
  bool isAround(std::size_t loop, const Vec3d& p) const {
    double turn = 0;
    const std::vector<std::uint32_t>& points = loops_[loop].points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d a = minus(mesh_.points[points[i]], p);
      const Vec3d b = minus(mesh_.points[points[(i + 1) % points.size()]], p);
      turn += std::atan2(dot(cross(a, b), planes_[loop].normal), dot(a, b));
    }
    return std::abs(turn) > 3;
  }

  bool fillInPlane(const std::vector<std::size_t>& group, std::vector<std::uint32_t>& added,
                   HoleFilling& filling) {
    const Plane& plane = planes_[group[0]];
    if (!plane.flat)
      return false;
    std::vector<std::vector<std::uint32_t>> outlines;
    FilledHole hole;
    for (const std::size_t loop : group) {
      outlines.push_back(loops_[loop].points);
      hole.edges += loops_[loop].points.size();
    }
    const std::size_t first = added.size();
    if (!triangulatePolygon(
            mesh_.points, outlines, plane.normal,
            [&](std::uint32_t a, std::uint32_t b) { return isTaken(a, b); }, added))
      return false;
    finish(hole, added, first, filling);
    return true;
  }

  void fillInSpace(std::size_t index, std::vector<std::uint32_t>& added, HoleFilling& filling) {
    const BoundaryLoop& loop = loops_[index];
    SpaceLoop space;
    space.points = loop.points;
    for (const std::uint32_t side : loop.sides)
      space.beyond.push_back(edges_.opposite(side));
    FilledHole hole;
    hole.edges = loop.points.size();
    const std::size_t first = added.size();
    if (!triangulateLoop(
            mesh_.points, space, [&](std::uint32_t a, std::uint32_t b) { return isTaken(a, b); },
            added, progress_))
      triangulateLoop(
          mesh_.points, space, [](std::uint32_t, std::uint32_t) { return false; }, added,
          progress_);
    if (loop.points.size() >= kFewestFairEdges)
      fair(loop, added, first, hole, filling.holes.size());
    finish(hole, added, first, filling);
  }

  // Refines and fairs the faces from `first` on, over a loop.
  void fair(const BoundaryLoop& loop, std::vector<std::uint32_t>& added, std::size_t first,
            FilledHole& hole, std::size_t number) {
    HolePatch patch;
    const auto begin = added.begin() + static_cast<std::ptrdiff_t>(first);
    for (auto c = begin; c != added.end(); c += 3)
      patch.faces.push_back({c[0], c[1], c[2]});
    findFacesAtLoops();
    std::vector<std::uint32_t> around;
    for (const std::uint32_t point : loop.points)
      around.insert(around.end(), facesAt_[point].begin(), facesAt_[point].end());
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    for (const std::uint32_t face : around)
      patch.around.push_back(cornersOf(mesh_.triangles, face));
    hole.points = fairPatch(
        mesh_.points, patch, [&](std::uint32_t a, std::uint32_t b) { return isTaken(a, b); },
        progress_);
    if (hole.points == 0)
      return;
    fairHoles_.push_back({number, {begin, added.end()}});
    added.erase(begin, added.end());
    for (const HolePatch::Corners& c : patch.faces)
      added.insert(added.end(), c.begin(), c.end());
  }

  void findFacesAtLoops() {
    if (!facesAt_.empty())
      return;
    for (const BoundaryLoop& loop : loops_)
      for (const std::uint32_t point : loop.points)
        facesAt_[point];
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
      if (const auto at = facesAt_.find(mesh_.triangles[i]); at != facesAt_.end())
        at->second.push_back(static_cast<std::uint32_t>(i / 3));
  }

  static HolePatch::Corners cornersOf(const std::vector<std::uint32_t>& corners, std::size_t face) {
    return {corners[3 * face], corners[3 * face + 1], corners[3 * face + 2]};
  }

  // Restores the plain patch where faired patches intersect other faces.
  void takeBackCrossing(std::vector<std::uint32_t>& added, HoleFilling& filling) {
    if (fairHoles_.empty())
      return;
    std::vector<char> looked;
    std::vector<std::uint32_t> corners, hole; // the latter by face, fairHoles_.size(): none
    const auto add = [&](const HolePatch::Corners& c, std::size_t number) {
      if (areCollinear(mesh_.points[c[0]], mesh_.points[c[1]], mesh_.points[c[2]]))
        return;
      corners.insert(corners.end(), c.begin(), c.end());
      hole.push_back(static_cast<std::uint32_t>(number));
      looked.push_back(number < fairHoles_.size());
    };
    for (std::size_t face = 0; face < mesh_.triangleCount(); ++face)
      add(cornersOf(mesh_.triangles, face), fairHoles_.size());
    for (std::size_t i = 0, face = 0, fair = 0; i < filling.holes.size(); ++i) {
      while (fair < fairHoles_.size() && fairHoles_[fair].number < i)
        ++fair;
      const bool isFair = fair < fairHoles_.size() && fairHoles_[fair].number == i;
      for (std::size_t k = 0; k < filling.holes[i].faces; ++k, ++face)
        add(cornersOf(added, face), isFair ? fair : fairHoles_.size());
    }
    std::vector<char> crosses(fairHoles_.size(), 0);
    for (const std::uint32_t face : facesThatMeetOthers(mesh_.points, corners, looked, progress_))
      crosses[hole[face]] = 1;
    for (std::size_t i = fairHoles_.size(); i-- > 0;) {
      if (crosses[i] == 0)
        continue;
      FilledHole& filled = filling.holes[fairHoles_[i].number];
      std::size_t before = 0;
      for (std::size_t k = 0; k < fairHoles_[i].number; ++k)
        before += filling.holes[k].faces;
      const std::vector<std::uint32_t>& plain = fairHoles_[i].plain;
      const auto begin = added.begin() + static_cast<std::ptrdiff_t>(3 * before);
      added.insert(added.erase(begin, begin + static_cast<std::ptrdiff_t>(3 * filled.faces)),
                   plain.begin(), plain.end());
      filled.faces = plain.size() / 3;
      filled.points = 0;
      dropsPoints_ = true;
    }
  }

  void finish(FilledHole& hole, const std::vector<std::uint32_t>& added, std::size_t first,
              HoleFilling& filling) {
    hole.faces = (added.size() - first) / 3;
    for (std::size_t i = first; i < added.size(); ++i)
      taken_.insert(key(added[i], added[i % 3 == 2 ? i - 2 : i + 1]));
    filling.holes.push_back(hole);
  }

  TriangleMesh& mesh_;
  Progress& progress_;
  const EdgeTable edges_;
  const std::vector<BoundaryLoop> loops_;
  std::vector<Plane> planes_; ///< by loop
  std::unordered_set<std::uint64_t> taken_;
  struct FairHole {
    std::size_t number;               ///< of the filled hole
    std::vector<std::uint32_t> plain; ///< its faces before fairing
  };
  std::vector<FairHole> fairHoles_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> facesAt_; ///< points of loops
  bool dropsPoints_ = false;
};

} // namespace

HoleFilling fillHoles(TriangleMesh& mesh, Progress& progress) {
  return Filling(mesh, progress).run();
}

} // namespace tetvdb
