// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/threemf/BeamLattice.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kSides = 16; ///< of a cross-section
constexpr std::uint32_t kRings = 6;  ///< of a half ball at a beam's end, the outermost a point
constexpr int kSubdivisions = 2;     ///< of an icosahedron
constexpr std::uint64_t kBallPoints = 162, kBallTriangles = 320;

bool isRadius(double radius) {
  return radius > 0 && std::isfinite(radius);
}

/// The points and triangles of a ball of volume 4/3 pi.
class UnitBall {
public:
  UnitBall() {
    const double golden = (1 + std::sqrt(5.0)) / 2;
    for (const double a : {-1.0, 1.0})
      for (const double b : {-golden, golden}) {
        points.push_back({0, a, b});
        points.push_back({a, b, 0});
        points.push_back({b, 0, a});
      }
    for (Vec3d& p : points)
      p = onSphere(p);
    addIcosahedron();
    for (int i = 0; i < kSubdivisions; ++i)
      subdivide();
    double volume = 0;
    for (std::size_t i = 0; i < triangles.size(); i += 3)
      volume +=
          dot(points[triangles[i]], cross(points[triangles[i + 1]], points[triangles[i + 2]])) / 6;
    const double scale = std::cbrt(4 * kPi / 3 / volume);
    for (Vec3d& p : points)
      p = times(p, scale);
  }

  std::vector<Vec3d> points;
  std::vector<std::uint32_t> triangles;

private:
  static Vec3d onSphere(const Vec3d& p) { return times(p, 1 / length(p)); }

  /// Three vertices make a face if all are neighbours: an edge is the shortest distance of two.
  void addIcosahedron() {
    const auto areNeighbours = [&](std::uint32_t i, std::uint32_t j) {
      return length(minus(points[i], points[j])) < 1.2;
    };
    const auto n = static_cast<std::uint32_t>(points.size());
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = i + 1; j < n; ++j)
        for (std::uint32_t k = j + 1; k < n; ++k)
          if (areNeighbours(i, j) && areNeighbours(j, k) && areNeighbours(i, k)) {
            const bool outward = dot(points[i], cross(points[j], points[k])) > 0;
            triangles.insert(triangles.end(), {i, outward ? j : k, outward ? k : j});
          }
  }

  void subdivide() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
    const auto midpoint = [&](std::uint32_t i, std::uint32_t j) {
      const auto [at, isNew] =
          midpoints.emplace(std::minmax(i, j), static_cast<std::uint32_t>(points.size()));
      if (isNew)
        points.push_back(onSphere(plus(points[i], points[j])));
      return at->second;
    };
    std::vector<std::uint32_t> finer;
    for (std::size_t t = 0; t < triangles.size(); t += 3) {
      const std::uint32_t a = triangles[t], b = triangles[t + 1], c = triangles[t + 2];
      const std::uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
      finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
    triangles = std::move(finer);
  }
};

class LatticeMaker {
public:
  explicit LatticeMaker(const std::vector<Vec3d>& vertices) : vertices_(vertices) {}

  LatticeFaces make(const BeamLattice& lattice) {
    for (const Beam& beam : lattice.beams)
      addBeam(beam);
    for (const LatticeBall& ball : lattice.balls)
      if (ball.vertex < vertices_.size() && isRadius(ball.radius))
        raiseBall(ball.vertex, ball.radius);
      else
        ++made_.invalid;
    for (const auto& [vertex, radius] : balls_)
      addBall(vertices_[vertex], radius);
    return std::move(made_);
  }

private:
  void addBeam(const Beam& beam) {
    const auto [from, to] = beam.ends;
    if (from >= vertices_.size() || to >= vertices_.size() || !isRadius(beam.radius[0]) ||
        !isRadius(beam.radius[1])) {
      ++made_.invalid;
      return;
    }
    for (std::size_t k = 0; k < 2; ++k)
      if (beam.cap[k] == BeamCap::Sphere)
        raiseBall(beam.ends[k], beam.radius[k]);
    const Vec3d way = minus(vertices_[to], vertices_[from]);
    const double distance = length(way);
    if (!(distance > 0))
      return; // its balls alone, if it has any
    axis_ = times(way, 1 / distance);
    // Two directions across, from the coordinate axis that is farthest from the beam's.
    const double x = std::abs(axis_[0]), y = std::abs(axis_[1]), z = std::abs(axis_[2]);
    const Vec3d other = x <= y && x <= z ? Vec3d{1, 0, 0}
                        : y <= z         ? Vec3d{0, 1, 0}
                                         : Vec3d{0, 0, 1};
    const Vec3d perpendicular = cross(axis_, other);
    across_[0] = times(perpendicular, 1 / length(perpendicular));
    across_[1] = cross(axis_, across_[0]);

    const std::uint32_t first = addEnd(beam, 0);
    addRing(vertices_[from], beam.radius[0]);
    addRing(vertices_[to], beam.radius[1]);
    const std::uint32_t last = addEnd(beam, 1);
    const auto rings = (last - first - 1) / kSides;
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t next = (side + 1) % kSides;
      const auto at = [&](std::uint32_t ring, std::uint32_t i) {
        return first + 1 + ring * kSides + i;
      };
      addTriangle(first, at(0, next), at(0, side));
      for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
        addTriangle(at(ring, side), at(ring, next), at(ring + 1, next));
        addTriangle(at(ring, side), at(ring + 1, next), at(ring + 1, side));
      }
      addTriangle(last, at(rings - 1, side), at(rings - 1, next));
    }
  }

  /// The outermost point of an end, and the rings between it and the ring of the end: before these
  /// for the first end, after them for the second. Returns the point's number.
  std::uint32_t addEnd(const Beam& beam, std::size_t end) {
    const Vec3d& vertex = vertices_[beam.ends[end]];
    const double radius = beam.radius[end], direction = end == 0 ? -1 : 1;
    const std::uint32_t rings = beam.cap[end] == BeamCap::Hemisphere ? kRings : 1;
    const auto at = [&](std::uint32_t ring) { // 0: the end's own ring, `rings`: the point
      const double angle = kPi / 2 * ring / kRings;
      return std::pair{plus(vertex, times(axis_, direction * radius * std::sin(angle))),
                       radius * std::cos(angle)};
    };
    const Vec3d tip = rings == 1 ? vertex : at(rings).first;
    std::uint32_t number = 0;
    if (end == 0)
      number = addPoint(tip);
    for (std::uint32_t i = 1; i < rings; ++i) {
      const auto [midpoint, size] = at(end == 0 ? rings - i : i);
      addRing(midpoint, size);
    }
    return end == 0 ? number : addPoint(tip);
  }

  /// A regular polygon of the circle's area, seen from the end of the beam counterclockwise.
  void addRing(const Vec3d& midpoint, double radius) {
    static const double scale = std::sqrt(2 * kPi / (kSides * std::sin(2 * kPi / kSides)));
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const double angle = 2 * kPi * i / kSides;
      addPoint(plus(midpoint, plus(times(across_[0], scale * radius * std::cos(angle)),
                                   times(across_[1], scale * radius * std::sin(angle)))));
    }
  }

  void raiseBall(std::uint32_t vertex, double radius) {
    double& known = balls_[vertex];
    known = std::max(known, radius);
  }
  void addBall(const Vec3d& midpoint, double radius) {
    const auto first = static_cast<std::uint32_t>(made_.points.size());
    for (const Vec3d& p : ball_.points)
      addPoint(plus(midpoint, times(p, radius)));
    for (const std::uint32_t corner : ball_.triangles)
      made_.triangles.push_back(first + corner);
  }

  std::uint32_t addPoint(const Vec3d& p) {
    made_.points.push_back(p);
    return static_cast<std::uint32_t>(made_.points.size() - 1);
  }
  void addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    made_.triangles.insert(made_.triangles.end(), {a, b, c});
  }

  const std::vector<Vec3d>& vertices_;
  const UnitBall ball_;
  LatticeFaces made_;
  std::map<std::uint32_t, double> balls_; ///< the radius at a vertex
  Vec3d axis_{}, across_[2];              ///< of the beam
};

} // namespace

LatticeFaces facesOfLattice(const BeamLattice& lattice, const std::vector<Vec3d>& vertices,
                            const std::string& path) {
  std::uint64_t balls = lattice.balls.size(), points = 0, triangles = 0;
  for (const Beam& beam : lattice.beams) {
    std::uint64_t rings = 2;
    for (const BeamCap cap : beam.cap) {
      rings += cap == BeamCap::Hemisphere ? kRings - 1 : 0;
      balls += cap == BeamCap::Sphere ? 1 : 0;
    }
    points += kSides * rings + 2;
    triangles += 2 * kSides * rings;
  }
  balls = std::min<std::uint64_t>(balls, vertices.size());
  points += kBallPoints * balls;
  triangles += kBallTriangles * balls;
  // Here, and in the mesh that they are copied to.
  const std::uint64_t bytes = 2 * (sizeof(Vec3d) * points + 3 * sizeof(std::uint32_t) * triangles);
  if (bytes > availableBytes() || points > UINT32_MAX)
    throw Error(Status::Limit, path,
                "its " + std::to_string(lattice.beams.size()) +
                    " beams need more memory than is available",
                "use a machine with more memory, or split the lattice");
  return LatticeMaker(vertices).make(lattice);
}

} // namespace tetvdb
