// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SimplifySurface.h"

#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/HalfEdges.h"
#include "tetvdb/surface/TriangleScene.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <queue>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = HalfEdges::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The share of the tolerance that is held at the points looked at; between them lies the rest.
constexpr double kHeldBack = 0.65;
constexpr double kLeastCosine = 0.5;    ///< of the angle by which a face may turn in one step
constexpr double kLeastAgreement = 0.3; ///< cosine between a point's normal and its face's
constexpr double kLeastShape = 0.02;    ///< height over longest side of a new face, unless it grows
constexpr std::size_t kManyPoints = 1024; ///< that the faces around a vertex stand for
constexpr double kOnFace = 0.01;      ///< square of the distance of a point that lies on its face
constexpr std::size_t kMaxFaces = 32; ///< around a vertex
constexpr int kTries = 4;             ///< neighbours that a vertex is tried to move onto
// What a squared length adds to a squared distance when edges are ordered: flat parts keep
// well-shaped triangles.
constexpr double kLengthWeight = 1e-3;
constexpr double kLongSide = 3;          ///< in mean edge lengths
constexpr double kRegionEdges = 64;      ///< side of a region, in mean edge lengths
constexpr std::size_t kSerial = 1 << 14; ///< vertices of meshes that are one region

// Sum over planes of the squared distance, weighted by area: a symmetric 4 x 4 matrix.
struct Quadric {
  std::array<double, 10> m{};

  void add(const Vec3d& n, double d, double weight) {
    const std::array<double, 4> v{n[0], n[1], n[2], d};
    std::size_t k = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i; j < 4; ++j)
        m[k++] += weight * v[i] * v[j];
  }
  void add(const Quadric& other) {
    for (std::size_t k = 0; k < m.size(); ++k)
      m[k] += other.m[k];
  }
  double at(const Vec3d& p) const {
    return p[0] * (m[0] * p[0] + 2 * (m[1] * p[1] + m[2] * p[2] + m[3])) +
           p[1] * (m[4] * p[1] + 2 * (m[5] * p[2] + m[6])) + p[2] * (m[7] * p[2] + 2 * m[8]) + m[9];
  }
};

// What all regions share. Lengths are in tolerances, relative to the middle of the box.
struct Surface {
  const TriangleScene original; ///< in the mesh's own units
  Vec3d middle{0, 0, 0};        ///< of the box
  double tolerance;
  double longSide = 0; ///< squared: a side that is looked at in more than its middle
  HalfEdges edges;
  std::vector<Vec3d> points;                 ///< vertices, then middles of edges
  std::vector<std::array<float, 3>> normals; ///< of unit length, at points
  std::vector<Quadric> quadrics;
  /// Points of the surface that have to stay near, as lists: each belongs to the face next to it.
  /// Vertices come in once they are gone, middles of edges, numbered after them, from the start:
  /// between its vertices a surface can be bent more than the tolerance.
  std::vector<std::uint32_t> firstGone; ///< of a face
  std::vector<std::uint32_t> nextGone;  ///< of a point
  std::vector<std::uint32_t> region;    ///< of a vertex
  std::vector<std::uint32_t> stamp;     ///< of a vertex: its newest entry in a queue

  Surface(const TriangleMesh& mesh, double limit)
      : original(mesh), tolerance(limit), edges(mesh), points(mesh.points),
        normals(mesh.points.size()), quadrics(mesh.points.size()),
        firstGone(mesh.triangleCount(), kNone), nextGone(mesh.points.size(), kNone),
        region(mesh.points.size(), 0), stamp(mesh.points.size(), 0) {
    Vec3d low = points[0], high = points[0];
    for (const Vec3d& p : points)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], p[axis]);
        high[axis] = std::max(high[axis], p[axis]);
      }
    middle = times(plus(low, high), 0.5);
    for (Vec3d& p : points)
      p = times(minus(p, middle), 1 / tolerance);
    std::vector<Vec3d> sums(points.size(), Vec3d{0, 0, 0}), ofFaces(mesh.triangleCount());
    for (std::size_t face = 0; face < mesh.triangleCount(); ++face) {
      const std::uint32_t* v = &mesh.triangles[3 * face];
      const Vec3d n = cross(minus(points[v[1]], points[v[0]]), minus(points[v[2]], points[v[0]]));
      const double twice = length(n);
      const Vec3d unit = times(n, twice > 0 ? 1 / twice : 0);
      ofFaces[face] = unit;
      for (std::size_t k = 0; k < 3; ++k) {
        quadrics[v[k]].add(unit, -dot(unit, points[v[0]]), twice / 6);
        sums[v[k]] = plus(sums[v[k]], n);
      }
    }
    for (std::size_t v = 0; v < sums.size(); ++v)
      normals[v] = unitOf(sums[v]);
    addMiddles(ofFaces);
  }

  /// Whether a place of the new surface is near the old one.
  bool isNear(const Vec3d& p) const {
    return original.isWithin(plus(middle, times(p, tolerance)), kHeldBack * tolerance);
  }

private:
  static std::array<float, 3> unitOf(const Vec3d& v) {
    const double l = length(v), factor = l > 0 ? 1 / l : 0;
    return {static_cast<float>(v[0] * factor), static_cast<float>(v[1] * factor),
            static_cast<float>(v[2] * factor)};
  }

  void addMiddles(const std::vector<Vec3d>& ofFaces) {
    points.reserve(points.size() + 3 * std::size_t(edges.faceCount()) / 2);
    for (std::uint32_t h = 0; h < 3 * edges.faceCount(); ++h) {
      if (edges.start(h) > edges.end(h))
        continue;
      nextGone.push_back(firstGone[h / 3]);
      firstGone[h / 3] = static_cast<std::uint32_t>(points.size());
      points.push_back(times(plus(points[edges.start(h)], points[edges.end(h)]), 0.5));
      normals.push_back(unitOf(plus(ofFaces[h / 3], ofFaces[edges.twin(h) / 3])));
    }
  }
};

// Simplifies what lies within one region: vertices whose neighbours are all of it. Touches nothing
// that another region's vertices look at.
class Region {
public:
  Region(Surface& surface, Progress& progress) : s_(surface), progress_(progress) {}

  void run(const std::vector<std::uint32_t>& vertices) {
    for (const std::uint32_t v : vertices)
      enqueue(v);
    for (std::size_t steps = 0; !queue_.empty(); ++steps) {
      if (steps % 1024 == 0)
        progress_.check();
      const Entry entry = queue_.top();
      queue_.pop();
      if (s_.edges.out(entry.vertex) != kNone && s_.stamp[entry.vertex] == entry.stamp)
        tryToRemove(entry.vertex);
    }
  }

private:
  struct Entry {
    double cost;
    std::uint32_t vertex, stamp;
    bool operator<(const Entry& other) const { // the queue's top is its largest
      return cost != other.cost ? cost > other.cost : vertex > other.vertex;
    }
  };
  struct Choice {
    double cost;
    std::uint32_t halfEdge;
  };

  double cost(std::uint32_t from, std::uint32_t to) const {
    const Vec3d step = minus(s_.points[to], s_.points[from]);
    return std::max(s_.quadrics[from].at(s_.points[to]), 0.0) + kLengthWeight * dot(step, step);
  }

  // Half-edges out of v by cost; none where v has neighbours in other regions.
  void choose(std::uint32_t v) {
    choices_.clear();
    bool within = true;
    s_.edges.forEachOut(v, [&](std::uint32_t h) {
      const std::uint32_t to = s_.edges.end(h);
      within = within && s_.region[to] == s_.region[v];
      choices_.push_back({cost(v, to), h});
    });
    if (!within)
      choices_.clear();
  }

  void enqueue(std::uint32_t v) {
    if (s_.edges.out(v) == kNone)
      return;
    choose(v);
    double least = kInfinity;
    for (const Choice& choice : choices_)
      least = std::min(least, choice.cost);
    ++s_.stamp[v];
    if (least < kInfinity)
      queue_.push({least, v, s_.stamp[v]});
  }

  void tryToRemove(std::uint32_t v) {
    choose(v);
    std::sort(choices_.begin(), choices_.end(), [&](const Choice& a, const Choice& b) {
      return a.cost != b.cost ? a.cost < b.cost
                              : s_.edges.end(a.halfEdge) < s_.edges.end(b.halfEdge);
    });
    int tries = 0;
    for (const Choice& choice : choices_) {
      if (tries++ == kTries)
        return;
      if (!isManifoldAfter(choice.halfEdge) || !isNearAfter(choice.halfEdge))
        continue;
      remove(choice.halfEdge);
      return;
    }
  }

  std::size_t valence(std::uint32_t v) const {
    std::size_t count = 0;
    s_.edges.forEachOut(v, [&](std::uint32_t) { ++count; });
    return count;
  }

  // The link condition of Dey, Edelsbrunner, Guha and Nekhayev (Topology preserving edge
  // contraction, 1999), with no vertex left of fewer than three faces.
  bool isManifoldAfter(std::uint32_t h) {
    const std::uint32_t from = s_.edges.start(h), to = s_.edges.end(h);
    neighbours_.clear();
    s_.edges.forEachOut(from, [&](std::uint32_t o) { neighbours_.push_back(s_.edges.end(o)); });
    std::size_t common = 0, ofTo = 0;
    s_.edges.forEachOut(to, [&](std::uint32_t o) {
      ++ofTo;
      common +=
          std::find(neighbours_.begin(), neighbours_.end(), s_.edges.end(o)) != neighbours_.end();
    });
    const std::uint32_t left = s_.edges.end(HalfEdges::next(h));
    const std::uint32_t right = s_.edges.end(HalfEdges::next(s_.edges.twin(h)));
    return common == 2 && neighbours_.size() + ofTo <= kMaxFaces + 4 && valence(left) > 3 &&
           valence(right) > 3;
  }

  struct Face {
    std::uint32_t number;
    std::array<Vec3d, 3> corners;
    Vec3d normal; ///< of unit length
  };

  static double shape(const Vec3d& twiceNormal, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d ab = minus(b, a), bc = minus(c, b), ca = minus(a, c);
    return length(twiceNormal) / std::max({dot(ab, ab), dot(bc, bc), dot(ca, ca)});
  }

  // Whether the faces around the start of h, moved onto its end, keep their sides and stay near all
  // vertices that they stand for. Leaves these faces in faces_, and in gone_ the vertices.
  bool isNearAfter(std::uint32_t h) {
    const std::uint32_t from = s_.edges.start(h);
    const Vec3d& old = s_.points[from];
    const Vec3d& moved = s_.points[s_.edges.end(h)];
    faces_.clear();
    bool upright = true;
    s_.edges.forEachOut(from, [&](std::uint32_t o) {
      if (o == h || o == HalfEdges::next(s_.edges.twin(h)) || !upright)
        return;
      const Vec3d& a = s_.points[s_.edges.end(o)];
      const Vec3d& b = s_.points[s_.edges.start(HalfEdges::previous(o))];
      const Vec3d before = cross(minus(a, old), minus(b, old));
      const Vec3d after = cross(minus(a, moved), minus(b, moved));
      upright =
          dot(before, after) > kLeastCosine * length(before) * length(after) &&
          shape(after, moved, a, b) > std::min(kLeastShape, shape(before, old, a, b) * (1 - 1e-9));
      faces_.push_back({o / 3, {moved, a, b}, times(after, 1 / length(after))});
    });
    if (!upright)
      return false;
    gone_.clear();
    owner_.clear();
    squares_.clear();
    if (!assign(from))
      return false;
    bool near = true;
    s_.edges.forEachOut(from, [&](std::uint32_t o) {
      for (std::uint32_t v = s_.firstGone[o / 3]; near && v != kNone; v = s_.nextGone[v])
        near = assign(v);
    });
    return near && std::all_of(faces_.begin(), faces_.end(),
                               [&](const Face& face) { return isNearOriginal(face); });
  }

  // Looks at the middle of a new face and at the side that is new as well.
  bool isNearOriginal(const Face& face) const {
    const auto& [a, b, c] = face.corners;
    const Vec3d side = minus(b, a);
    if (!s_.isNear(plus(a, times(side, 0.5))))
      return false;
    if (dot(side, side) > s_.longSide)
      for (const double t : {0.25, 0.75})
        if (!s_.isNear(plus(a, times(side, t))))
          return false;
    return s_.isNear(times(plus(a, plus(b, c)), 1.0 / 3));
  }

  // Finds the nearest of faces_ that looks the way of a point that is gone.
  bool assign(std::uint32_t v) {
    const Vec3d& p = s_.points[v];
    double nearest = kHeldBack * kHeldBack;
    std::uint32_t owner = kNone;
    const std::array<float, 3>& n = s_.normals[v];
    for (const Face& face : faces_) {
      if (!(face.normal[0] * n[0] + face.normal[1] * n[1] + face.normal[2] * n[2] >
            kLeastAgreement))
        continue;
      const double squared = nearestOnTriangle(minus(face.corners[0], p), minus(face.corners[1], p),
                                               minus(face.corners[2], p))
                                 .squared;
      if (squared < nearest) {
        nearest = squared;
        owner = face.number;
        if (squared < 1e-12)
          break;
      }
    }
    if (owner == kNone)
      return false;
    gone_.push_back(v);
    owner_.push_back(owner);
    squares_.push_back(nearest);
    return true;
  }

  void remove(std::uint32_t h) {
    const std::uint32_t from = s_.edges.start(h), to = s_.edges.end(h);
    s_.edges.forEachOut(from, [&](std::uint32_t o) { s_.firstGone[o / 3] = kNone; });
    // On large flat faces every second point that lies on them does.
    const bool many = gone_.size() > kManyPoints;
    for (std::size_t i = 0; i < gone_.size(); ++i) {
      if (many && i % 2 == 1 && squares_[i] < kOnFace)
        continue;
      s_.nextGone[gone_[i]] = s_.firstGone[owner_[i]];
      s_.firstGone[owner_[i]] = gone_[i];
    }
    s_.quadrics[to].add(s_.quadrics[from]);
    s_.edges.collapse(h);
    neighbours_.clear();
    s_.edges.forEachOut(to, [&](std::uint32_t o) {
      if (s_.region[s_.edges.end(o)] == s_.region[to])
        neighbours_.push_back(s_.edges.end(o));
    });
    enqueue(to);
    for (const std::uint32_t v : neighbours_)
      enqueue(v);
  }

  Surface& s_;
  Progress& progress_;
  std::priority_queue<Entry> queue_;
  std::vector<Choice> choices_;
  std::vector<std::uint32_t> neighbours_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> gone_, owner_;
  std::vector<double> squares_; ///< of the distances from gone_ to owner_
};

double meanEdge(const Surface& surface) {
  double sum = 0;
  for (std::uint32_t h = 0; h < 3 * surface.edges.faceCount(); ++h)
    sum +=
        length(minus(surface.points[surface.edges.end(h)], surface.points[surface.edges.start(h)]));
  return sum / (3.0 * surface.edges.faceCount());
}

// Vertices by cubes of that side, the cubes in order, one of their corners at `corner` sides.
std::vector<std::vector<std::uint32_t>> divide(Surface& surface, double side, double corner) {
  std::map<Vec3i, std::uint32_t> numbers;
  std::vector<std::vector<std::uint32_t>> regions;
  for (std::uint32_t v = 0; v < surface.quadrics.size(); ++v) {
    if (surface.edges.out(v) == kNone)
      continue;
    Vec3i cube{0, 0, 0};
    for (std::size_t axis = 0; axis < 3; ++axis)
      cube[axis] = static_cast<std::int32_t>(
          std::clamp(std::floor(surface.points[v][axis] / side + corner), -1e9, 1e9));
    const auto [entry, isNew] =
        numbers.try_emplace(cube, static_cast<std::uint32_t>(regions.size()));
    if (isNew)
      regions.emplace_back();
    regions[entry->second].push_back(v);
    surface.region[v] = entry->second;
  }
  return regions;
}

// Cubes first, then cubes that have the first ones' borders inside, then everything.
void simplify(Surface& surface, Progress& progress) {
  std::vector<std::pair<double, double>> passes;
  const double edge = meanEdge(surface);
  surface.longSide = kLongSide * kLongSide * edge * edge;
  if (surface.quadrics.size() > kSerial) {
    const double side = kRegionEdges * edge;
    passes = {{side, 0.0}, {side, 0.5}};
  }
  passes.push_back({kInfinity, 0.0});
  for (std::size_t pass = 0; pass < passes.size(); ++pass) {
    const std::vector<std::vector<std::uint32_t>> regions =
        divide(surface, passes[pass].first, passes[pass].second);
    std::atomic<std::size_t> done{0};
    tbb::parallel_for(std::size_t(0), regions.size(), [&](std::size_t i) {
      Region(surface, progress).run(regions[i]);
      progress.update((static_cast<double>(pass) +
                       static_cast<double>(++done) / static_cast<double>(regions.size())) /
                      static_cast<double>(passes.size()));
    });
  }
}

} // namespace

void simplifySurface(TriangleMesh& mesh, double tolerance, Progress& progress) {
  if (mesh.triangles.empty() || !(tolerance > 0))
    return;
  Surface surface(mesh, tolerance);
  simplify(surface, progress);
  std::vector<std::uint32_t> number(mesh.points.size(), kNone);
  std::vector<Vec3d> points;
  for (std::uint32_t v = 0; v < mesh.points.size(); ++v)
    if (surface.edges.out(v) != kNone) {
      number[v] = static_cast<std::uint32_t>(points.size());
      points.push_back(mesh.points[v]);
    }
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t face = 0; face < surface.edges.faceCount(); ++face)
    if (!surface.edges.isDeleted(face))
      for (std::uint32_t k = 0; k < 3; ++k)
        triangles.push_back(number[surface.edges.start(3 * face + k)]);
  mesh.points = std::move(points);
  mesh.triangles = std::move(triangles);
  mesh.faceCount = mesh.triangleCount();
}

} // namespace tetvdb
