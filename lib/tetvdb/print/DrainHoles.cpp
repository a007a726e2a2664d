// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/DrainHoles.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/print/CutNearby.h"
#include "tetvdb/print/Shells.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/LocalRepair.h"
#include "tetvdb/surface/RemoveCrossings.h"
#include "tetvdb/surface/TriangleScene.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <utility>

namespace tetvdb {
namespace {

constexpr int kSides = 64;       // of a prism
constexpr int kRaysAround = 16;  // rays along a hole's edge
constexpr double kMaxSlant = 4;  // radii that the wall may extend beyond its end on the axis
constexpr double kBeyond = 0.05; // radii by which a prism is longer than its wall at either end
constexpr int kTwists = 3;
constexpr double kTwist = 0.0137; // sides of a prism, and radii at its ends
constexpr double kRoom = 1.05;    // of the ball around a prism
constexpr double kBottom = 0.1;   // radii by which a cavity's bottom may deviate from horizontal

struct Axis {
  Vec3d point, along, side, up; // of unit length, at right angles
};

Axis axisOf(const DrainHole& hole) {
  const double size = length(hole.direction);
  if (!(size > 0) || !std::isfinite(size))
    throw Error(Status::Usage, "`drain`", "the direction has no length", "give another one");
  if (!(hole.radius > 0) || !std::isfinite(hole.radius))
    throw Error(Status::Usage, "`drain`", "the radius must be above zero");
  Axis axis{hole.point, times(hole.direction, 1 / size), {}, {}};
  std::size_t smallest = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(axis.along[k]) < std::abs(axis.along[smallest]))
      smallest = k;
  Vec3d other{0, 0, 0};
  other[smallest] = 1;
  const Vec3d side = cross(axis.along, other);
  axis.side = times(side, 1 / length(side));
  axis.up = cross(axis.along, axis.side);
  return axis;
}

// A section of the solid along a line, and the faces at its ends.
struct Wall {
  double begin, end;
  std::uint32_t enters, leaves;

  double distanceTo(double t) const { return std::max({begin - t, t - end, 0.0}); }
};

class HoleFinder {
public:
  explicit HoleFinder(const TriangleMesh& solid) : scene_(solid), shells_(findShells(solid)) {
    Box box;
    for (const std::uint32_t v : solid.triangles)
      box.add(solid.points[v]);
    low_ = box.low;
    size_ = length(minus(box.high, box.low));
  }

  // The range of a prism along the axis.
  std::pair<double, double> reachOf(const DrainHole& hole, const Axis& axis) const {
    const std::optional<Wall> wall = wallAt(axis, 0, 0, hole.radius);
    if (!wall || (!isCavity(wall->enters) && !isCavity(wall->leaves)))
      throw Error(Status::Invalid, "`drain`",
                  fmt::format("the wall at ({:.6g}, {:.6g}, {:.6g}) along ({:.3g}, {:.3g}, {:.3g}) "
                              "is not one of a cavity",
                              hole.point[0], hole.point[1], hole.point[2], axis.along[0],
                              axis.along[1], axis.along[2]),
                  "place it on the outside, with the direction into the cavity");
    double begin = wall->begin, end = wall->end;
    const double slant = kMaxSlant * hole.radius;
    for (int i = 0; i < kRaysAround; ++i) {
      const double turn = 2 * kPi * i / kRaysAround;
      const auto edge = wallAt(axis, hole.radius * std::cos(turn), hole.radius * std::sin(turn),
                               hole.radius, (wall->begin + wall->end) / 2);
      if (!edge)
        continue;
      begin = std::min(begin, std::max(edge->begin, wall->begin - slant));
      end = std::max(end, std::min(edge->end, wall->end + slant));
    }
    const double beyond = kBeyond * hole.radius;
    return {begin - beyond, end + beyond};
  }

private:
  bool isCavity(std::uint32_t face) const { return shells_.volumes[shells_.ofFace[face]] < 0; }

  // The section closest to `t` on a line parallel to the axis. A line through an edge may cross it
  // once or twice: then neighbouring lines are used.
  std::optional<Wall> wallAt(const Axis& axis, double side, double up, double radius,
                             double t = 0) const {
    constexpr int kTries = 8;
    constexpr double kAside = 1e-4;
    std::vector<TriangleScene::Hit> hits;
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const double aside = kAside * radius * (attempt + 1);
      const Vec3d at = plus(axis.point, plus(times(axis.side, side + 0.83 * aside),
                                             times(axis.up, up + 0.56 * aside)));
      const double back = length(minus(at, low_)) + 2 * size_;
      scene_.crossings(minus(at, times(axis.along, back)), axis.along, 2 * back, hits);
      bool alternate = hits.size() % 2 == 0;
      for (std::size_t i = 0; i < hits.size(); ++i)
        alternate = alternate && hits[i].leaving == (i % 2 == 1);
      if (!alternate)
        continue;
      std::optional<Wall> nearest;
      for (std::size_t i = 0; i + 1 < hits.size(); i += 2) {
        const Wall wall{hits[i].t - back, hits[i + 1].t - back, hits[i].triangle,
                        hits[i + 1].triangle};
        if (!nearest || wall.distanceTo(t) < nearest->distanceTo(t))
          nearest = wall;
      }
      return nearest;
    }
    return std::nullopt;
  }

  TriangleScene scene_;
  Shells shells_;
  Vec3d low_{};
  double size_ = 0;
};

// From `begin` to `end` along the axis, oriented outward; rotated by `twist` sides around it.
TriangleMesh prismOf(const Axis& axis, double radius, double begin, double end, double twist) {
  const double corner = radius * std::sqrt(2 * kPi / (kSides * std::sin(2 * kPi / kSides)));
  TriangleMesh prism;
  for (const double t : {begin, end})
    for (int i = 0; i < kSides; ++i) {
      const double turn = 2 * kPi * (i + 0.5 + twist) / kSides;
      prism.points.push_back(plus(plus(axis.point, times(axis.along, t)),
                                  plus(times(axis.side, corner * std::cos(turn)),
                                       times(axis.up, corner * std::sin(turn)))));
    }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    prism.triangles.insert(prism.triangles.end(), {a, b, c});
  };
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t next = (i + 1) % kSides;
    add(i, next, kSides + next);
    add(i, kSides + next, kSides + i);
    if (i > 0 && i + 1 < kSides) {
      add(0, i + 1, i);
      add(kSides, kSides + i, kSides + i + 1);
    }
  }
  prism.faceCount = prism.triangleCount();
  return prism;
}

void appendFaces(TriangleMesh& mesh, const TriangleMesh& more, bool turned) {
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), more.points.begin(), more.points.end());
  for (std::size_t i = 0; i < more.triangles.size(); i += 3)
    for (const std::size_t k :
         {std::size_t(0), std::size_t(turned ? 2 : 1), std::size_t(turned ? 1 : 2)})
      mesh.triangles.push_back(first + more.triangles[i + k]);
  mesh.faceCount = mesh.triangleCount();
}

// A box far around everything, inside out: reduces the winding number of the inside by one.
void addSurroundings(TriangleMesh& mesh) {
  Box box;
  for (const Vec3d& p : mesh.points)
    box.add(p);
  const double margin = length(minus(box.high, box.low));
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  for (int i = 0; i < 8; ++i) {
    Vec3d p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = i >> k & 1 ? box.high[k] + margin : box.low[k] - margin;
    mesh.points.push_back(p);
  }
  constexpr std::uint32_t kInward[12][3] = {{0, 1, 3}, {0, 3, 2}, {4, 7, 5}, {4, 6, 7},
                                            {0, 5, 1}, {0, 4, 5}, {2, 3, 7}, {2, 7, 6},
                                            {0, 2, 6}, {0, 6, 4}, {1, 7, 3}, {1, 5, 7}};
  for (const auto& face : kInward)
    for (const std::uint32_t v : face)
      mesh.triangles.push_back(first + v);
  mesh.faceCount = mesh.triangleCount();
}

bool isOver(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const auto side = [&](const Vec3d& from, const Vec3d& to) {
    return (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0]);
  };
  const double ab = side(a, b), bc = side(b, c), ca = side(c, a);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

// The lowest point of some faces; if they are horizontal up to `tolerance`, the centre of the
// horizontal part, or one of its points close to that.
Vec3d bottomOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& faces,
               double tolerance) {
  Vec3d lowest{0, 0, std::numeric_limits<double>::infinity()};
  for (const std::uint32_t face : faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& p = mesh.points[mesh.triangles[3 * std::size_t(face) + k]];
      if (p[2] < lowest[2] || (p[2] == lowest[2] && p < lowest))
        lowest = p;
    }
  struct Level {
    Vec3d a, b, c, centre;
  };
  std::vector<Level> level;
  Vec3d sum{0, 0, 0};
  double area = 0;
  for (const std::uint32_t face : faces) {
    const std::uint32_t* v = mesh.triangles.data() + 3 * std::size_t(face);
    const Vec3d &a = mesh.points[v[0]], &b = mesh.points[v[1]], &c = mesh.points[v[2]];
    const double own = std::abs(cross(minus(b, a), minus(c, a))[2]);
    if (std::max({a[2], b[2], c[2]}) > lowest[2] + tolerance || !(own > 0))
      continue;
    level.push_back({a, b, c, times(plus(plus(a, b), c), 1.0 / 3)});
    sum = plus(sum, times(level.back().centre, own));
    area += own;
  }
  if (!(area > 0))
    return lowest;
  const Vec3d centre = times(sum, 1 / area);
  Vec3d nearest = lowest;
  double distance = std::numeric_limits<double>::infinity();
  for (const Level& face : level) {
    if (isOver(centre, face.a, face.b, face.c))
      return centre;
    const double away = std::hypot(face.centre[0] - centre[0], face.centre[1] - centre[1]);
    if (away < distance) {
      distance = away;
      nearest = face.centre;
    }
  }
  return nearest;
}

// The boundary of the region that faces enclose more often than inside out, as a closed manifold.
std::size_t cutAlongCrossings(TriangleMesh& mesh, Progress& progress) {
  const CrossingCounts counts = removeCrossings(mesh, NewCorners::FloatsAsGiven, progress);
  std::string broken = counts.complete ? whatIsBroken(mesh, progress, true) : "crossings";
  if (counts.complete && !broken.empty()) {
    const LocalRepair repair = repairLocally(mesh, progress);
    broken = repair.succeeded ? "" : repair.why;
  }
  if (!broken.empty())
    throw Error(Status::Invalid, "`drain`", "cutting the holes left " + broken,
                "move a hole a little, or change its radius");
  return counts.cutFaces;
}

// Assigns each removed component to the hole with the nearest axis.
std::vector<TriangleMesh> plugsOf(const TriangleMesh& taken, const std::vector<Axis>& axes) {
  std::vector<TriangleMesh> plugs(axes.size());
  const Shells shells = findShells(taken);
  std::vector<std::size_t> holeOf(shells.volumes.size(), axes.size());
  for (std::size_t face = 0; face < shells.ofFace.size(); ++face) {
    std::size_t& hole = holeOf[shells.ofFace[face]];
    if (hole < axes.size())
      continue;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const Vec3d off = minus(taken.points[taken.triangles[3 * face]], axes[i].point);
      const double beside = length(minus(off, times(axes[i].along, dot(off, axes[i].along))));
      const double distance = beside + 1e-3 * std::abs(dot(off, axes[i].along));
      if (distance < nearest) {
        nearest = distance;
        hole = i;
      }
    }
  }
  for (std::size_t i = 0; i < plugs.size(); ++i) {
    plugs[i] = taken;
    std::vector<char> drops(shells.ofFace.size());
    for (std::size_t face = 0; face < drops.size(); ++face)
      drops[face] = holeOf[shells.ofFace[face]] != i;
    dropFaces(plugs[i], drops);
    dropUnusedPoints(plugs[i]);
    plugs[i].faceCount = plugs[i].triangleCount();
  }
  return plugs;
}

// A hole with a known wall.
struct Bore {
  Axis axis;
  double radius, begin, end;

  TriangleMesh prism(int attempt) const {
    const double beyond = kTwist * attempt * radius;
    return prismOf(axis, radius, begin - beyond, end + beyond, kTwist * attempt);
  }
};

// By the faces close to the hole only. If the intersections of a prism are too close to corners of
// the solid, a slightly rotated prism is used.
bool boreNearby(TriangleMesh& solid, const Bore& bore, NearbyCut& cut, Progress& progress) {
  const Vec3d centre = plus(bore.axis.point, times(bore.axis.along, (bore.begin + bore.end) / 2));
  for (int attempt = 0; attempt < kTwists; ++attempt) {
    const TriangleMesh prism = bore.prism(attempt);
    double reach = 0;
    for (const Vec3d& p : prism.points)
      reach = std::max(reach, kRoom * length(minus(p, centre)));
    if (cutNearby(solid, prism, centre, reach, cut, progress))
      return true;
    cut = {};
  }
  return false;
}

// All holes at once, by all faces.
std::vector<TriangleMesh> boreTogether(TriangleMesh& solid, const std::vector<Bore>& bores,
                                       std::size_t& cutFaces, Progress& progress) {
  TriangleMesh rest = solid, taken = solid;
  std::vector<Axis> axes;
  for (const Bore& bore : bores) {
    const TriangleMesh prism = bore.prism(0);
    appendFaces(rest, prism, true);
    appendFaces(taken, prism, false);
    axes.push_back(bore.axis);
  }
  addSurroundings(taken);
  cutFaces += cutAlongCrossings(rest, progress);
  cutAlongCrossings(taken, progress);
  solid = std::move(rest);
  return plugsOf(taken, axes);
}

} // namespace

std::vector<DrainHole> holesAtLowestPoints(const TriangleMesh& solid, double radius) {
  const Shells shells = findShells(solid);
  std::vector<std::vector<std::uint32_t>> faces(shells.volumes.size());
  for (std::size_t face = 0; face < shells.ofFace.size(); ++face)
    if (shells.volumes[shells.ofFace[face]] < 0)
      faces[shells.ofFace[face]].push_back(static_cast<std::uint32_t>(face));
  std::vector<DrainHole> holes;
  for (const std::vector<std::uint32_t>& cavity : faces)
    if (!cavity.empty())
      holes.push_back({bottomOf(solid, cavity, kBottom * radius), {0, 0, 1}, radius});
  return holes;
}

DrilledHoles drillHoles(TriangleMesh& solid, const std::vector<DrainHole>& holes,
                        Progress& progress) {
  DrilledHoles drilled;
  if (holes.empty())
    return drilled;
  std::vector<Bore> bores;
  {
    const HoleFinder finder(solid);
    for (const DrainHole& hole : holes) {
      const Axis axis = axisOf(hole);
      const auto [begin, end] = finder.reachOf(hole, axis);
      bores.push_back({axis, hole.radius, begin, end});
    }
  }
  TriangleMesh made = solid;
  std::vector<Bore> left;
  std::vector<std::size_t> leftAt;
  drilled.plugs.resize(holes.size());
  for (std::size_t i = 0; i < bores.size(); ++i) {
    NearbyCut cut;
    if (boreNearby(made, bores[i], cut, progress)) {
      drilled.cutFaces += cut.cutFaces;
      drilled.plugs[i] = std::move(cut.taken);
    } else {
      left.push_back(bores[i]);
      leftAt.push_back(i);
    }
    progress.update(static_cast<double>(i + 1) / static_cast<double>(bores.size() + 1));
  }
  if (!left.empty()) {
    std::vector<TriangleMesh> plugs = boreTogether(made, left, drilled.cutFaces, progress);
    for (std::size_t i = 0; i < left.size(); ++i)
      drilled.plugs[leftAt[i]] = std::move(plugs[i]);
  }
  solid = std::move(made);
  return drilled;
}

} // namespace tetvdb
