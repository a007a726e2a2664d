// SPDX-License-Identifier: Apache-2.0
#include "TetMeshCheck.h"

#include "ExactVolume.h"
#include "Meshes.h"
#include "corpus/SolidAngles.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/ClosestPoint.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tuple>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

using Triangle = std::array<Vec3d, 3>;
using Corners = std::array<std::uint32_t, 4>;

constexpr std::size_t kMaxFarPoints = 2000; // looked at

// Of a positive tet, seen from outside counter-clockwise; the face opposite each corner.
constexpr std::size_t kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

class Tets {
public:
  explicit Tets(const TetMesh& mesh) : points(mesh.points) {
    for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
      corners.push_back(
          {mesh.tets[4 * t], mesh.tets[4 * t + 1], mesh.tets[4 * t + 2], mesh.tets[4 * t + 3]});
      inside.push_back(mesh.regions.empty() || mesh.regions[mesh.cell(t)] != -1 ? 1 : 0);
    }
  }
  const Vec3d& at(std::size_t tet, std::size_t corner) const {
    return points[corners[tet][corner]];
  }
  int sign(std::size_t tet) const {
    return exact_volume::sign(at(tet, 0), at(tet, 1), at(tet, 2), at(tet, 3));
  }
  // 1 inside, 0 on the surface, -1 outside of a positive tet.
  int side(std::size_t tet, const Vec3d& p) const {
    int minValue = 1;
    for (const auto& face : kFaces) {
      const int sign = -exact_volume::sign(at(tet, face[0]), at(tet, face[1]), at(tet, face[2]), p);
      minValue = std::min(minValue, sign);
    }
    return minValue;
  }

  const std::vector<Vec3d>& points;
  std::vector<Corners> corners;
  std::vector<char> inside;
};

double area(const Triangle& t) {
  return length(cross(minus(t[1], t[0]), minus(t[2], t[0]))) / 2;
}

Vec3d mixed(const Triangle& t, double u, double v) {
  return plus(t[0], plus(times(minus(t[1], t[0]), u), times(minus(t[2], t[0]), v)));
}

// Answers how far the nearest of some triangles is.
class Triangles {
public:
  explicit Triangles(std::vector<Triangle> triangles)
      : triangles_(std::move(triangles)), tree_(boxesOf(triangles_)) {}

  const std::vector<Triangle>& all() const { return triangles_; }

  // `hint` is a triangle that may be near; what was nearest on return.
  double distance(const Vec3d& p, std::uint32_t& hint) const {
    if (triangles_.empty())
      return std::numeric_limits<double>::infinity();
    double best = squared(p, hint);
    tree_.visit([&](const Box& box) { return squaredToBox(p, box) < best; },
                [&](std::uint32_t i) {
                  const double other = squared(p, i);
                  if (other < best) {
                    best = other;
                    hint = i;
                  }
                  return false;
                });
    return std::sqrt(best);
  }

  // The distances of many points, in any order of tasks.
  std::vector<double> distances(const std::vector<Vec3d>& from) const {
    std::vector<double> found(from.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, from.size(), 64), [&](const auto& range) {
      std::uint32_t hint = 0;
      for (std::size_t i = range.begin(); i < range.end(); ++i)
        found[i] = distance(from[i], hint);
    });
    return found;
  }

  // Points that are spread evenly by area, and no more corners; `of` receives the triangle of
  // each.
  std::vector<Vec3d> samples(std::size_t count, meshes::Random& random,
                             std::vector<std::uint32_t>& of) const {
    std::vector<Vec3d> points;
    const auto add = [&](std::size_t triangle, const Vec3d& p) {
      points.push_back(p);
      of.push_back(static_cast<std::uint32_t>(triangle));
    };
    double whole = 0, passed = 0;
    for (const Triangle& t : triangles_)
      whole += area(t);
    const double density = whole > 0 ? static_cast<double>(count) / whole : 0;
    const std::size_t step = 3 * triangles_.size() / std::max<std::size_t>(count, 1) + 1;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const Triangle& t = triangles_[i];
      for (std::size_t k = 0; k < 3; ++k)
        if ((3 * i + k) % step == 0)
          add(i, t[k]);
      const double next = passed + area(t) * density;
      for (double k = std::ceil(passed); k < next; ++k) {
        double u = random.unit(), v = random.unit();
        if (u + v > 1) {
          u = 1 - u;
          v = 1 - v;
        }
        add(i, mixed(t, u, v));
      }
      passed = next;
    }
    return points;
  }

private:
  static std::vector<Box> boxesOf(const std::vector<Triangle>& triangles) {
    std::vector<Box> boxes(triangles.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
      for (const Vec3d& p : triangles[i])
        boxes[i].add(p);
    return boxes;
  }
  double squared(const Vec3d& p, std::uint32_t i) const {
    const Triangle& t = triangles_[i];
    return nearestOnTriangle(minus(t[0], p), minus(t[1], p), minus(t[2], p)).squared;
  }
  static double squaredToBox(const Vec3d& p, const Box& box) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double away = std::max({box.low[axis] - p[axis], p[axis] - box.high[axis], 0.0});
      sum += away * away;
    }
    return sum;
  }

  std::vector<Triangle> triangles_;
  BoxTree tree_;
};

std::vector<Triangle> trianglesOf(const TriangleMesh& mesh) {
  std::vector<Triangle> triangles(mesh.triangleCount());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      triangles[i][k] = mesh.points[mesh.triangles[3 * i + k]];
  return triangles;
}

// Of every edge the times it is passed one way less those the other way are 0.
bool isClosed(const TriangleMesh& mesh) {
  std::vector<std::tuple<std::uint32_t, std::uint32_t, int>> edges;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t from = mesh.triangles[i];
    const std::uint32_t to = mesh.triangles[i % 3 == 2 ? i - 2 : i + 1];
    edges.emplace_back(std::min(from, to), std::max(from, to), from < to ? 1 : -1);
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    const auto [low, high, way] = edges[i];
    int sum = 0;
    for (; i < edges.size() && std::get<0>(edges[i]) == low && std::get<1>(edges[i]) == high; ++i)
      sum += std::get<2>(edges[i]);
    if (sum != 0)
      return false;
  }
  return true;
}

// Winding numbers, in a frame where all lengths are near 1: shifted, and scaled by a power of two.
class Windings {
public:
  explicit Windings(const std::vector<Triangle>& triangles) : triangles_(triangles) {
    Box box;
    for (const Triangle& t : triangles)
      for (const Vec3d& p : t)
        box.add(p);
    if (triangles.empty())
      return;
    origin_ = times(plus(box.low, box.high), 0.5);
    const double size = length(minus(box.high, box.low));
    scale_ = size > 0 ? std::ldexp(1.0, -std::ilogb(size)) : 1;
    for (Triangle& t : triangles_)
      for (Vec3d& p : t)
        p = framed(p);
  }
  std::vector<double> at(const std::vector<Vec3d>& points) const {
    using namespace solid_angles;
    std::vector<double> found(points.size());
    tbb::parallel_for(std::size_t(0), (points.size() + kLanes - 1) / kLanes, [&](std::size_t k) {
      Lanes x, y, z, w;
      for (std::size_t i = 0; i < kLanes; ++i) {
        const Vec3d p = framed(points[std::min(k * kLanes + i, points.size() - 1)]);
        x[i] = p[0];
        y[i] = p[1];
        z[i] = p[2];
      }
      windings(triangles_, x, y, z, w);
      for (std::size_t i = 0; i < kLanes && k * kLanes + i < points.size(); ++i)
        found[k * kLanes + i] = w[i];
    });
    return found;
  }

private:
  Vec3d framed(const Vec3d& p) const { return times(minus(p, origin_), scale_); }

  std::vector<Triangle> triangles_;
  Vec3d origin_{0, 0, 0};
  double scale_ = 1;
};

// Faces between inside and outside, seen from outside counter-clockwise.
std::vector<Triangle> findSurface(const Tets& tets, TetMeshCheck& check) {
  struct Side {
    std::array<std::uint32_t, 3> key; // sorted
    std::uint32_t tet;
    std::uint8_t face;
    bool odd; // a turn of the key the other way
    bool operator<(const Side& other) const {
      return std::tie(key, tet, face) < std::tie(other.key, other.tet, other.face);
    }
  };
  std::vector<Side> sides;
  sides.reserve(4 * tets.corners.size());
  for (std::uint32_t t = 0; t < tets.corners.size(); ++t)
    for (std::uint8_t face = 0; face < 4; ++face) {
      std::array<std::uint32_t, 3> key{};
      for (std::size_t k = 0; k < 3; ++k)
        key[k] = tets.corners[t][kFaces[face][k]];
      bool odd = false;
      for (const auto& [a, b] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 2}, {0, 1}})
        if (key[a] > key[b]) {
          std::swap(key[a], key[b]);
          odd = !odd;
        }
      sides.push_back({key, t, face, odd});
    }
  std::sort(sides.begin(), sides.end());
  std::vector<Triangle> surface;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i, inside = 0;
    const Side* seen = &sides[i];
    for (; end < sides.size() && sides[end].key == sides[i].key; ++end)
      if (tets.inside[sides[end].tet] != 0) {
        ++inside;
        seen = &sides[end];
      }
    if (end - i > 2 || (end - i == 2 && sides[i].odd == sides[i + 1].odd))
      ++check.wrongFaces;
    if (inside % 2 != 0) {
      Triangle triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        triangle[k] = tets.at(seen->tet, kFaces[seen->face][k]);
        edges.emplace_back(seen->key[k == 2 ? 0 : k], seen->key[k == 2 ? 2 : k + 1]);
      }
      surface.push_back(triangle);
    }
    i = end;
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    const std::size_t first = i;
    while (i < edges.size() && edges[i] == edges[first])
      ++i;
    check.unevenEdges += (i - first) % 2;
  }
  check.surfaceFaces = surface.size();
  return surface;
}

void measureVolumes(const Tets& tets, const std::vector<Triangle>& surface, TetMeshCheck& check) {
  long double sum = 0, enclosed = 0, absSum = 0;
  Vec3d origin{0, 0, 0};
  if (!surface.empty())
    origin = surface[0][0];
  for (std::size_t t = 0; t < tets.corners.size(); ++t) {
    check.notPositive += tets.sign(t) > 0 ? 0 : 1;
    if (tets.inside[t] == 0)
      continue;
    ++check.insideTets;
    sum +=
        exact_volume::sixfold(tets.at(t, 0), tets.at(t, 1), tets.at(t, 2), tets.at(t, 3), absSum);
  }
  for (const Triangle& f : surface)
    enclosed -= exact_volume::sixfold(f[0], f[1], f[2], origin, absSum);
  check.volume = static_cast<double>(sum / 6);
  check.enclosedVolume = static_cast<double>(enclosed / 6);
}

// tr(J^T J) / det(J)^(2/3), where J takes the regular tet of edge 1 to this one: its columns are
// the images of the unit vectors, found from the edges of the regular tet.
double energyOf(const Tets& tets, std::size_t tet) {
  const Vec3d p = minus(tets.at(tet, 1), tets.at(tet, 0));
  const Vec3d q = minus(tets.at(tet, 2), tets.at(tet, 0));
  const Vec3d r = minus(tets.at(tet, 3), tets.at(tet, 0));
  // (1, 0, 0), (1/2, sqrt(3)/2, 0), (1/2, sqrt(3)/6, sqrt(2/3)) are the regular tet's edges.
  const Vec3d y = times(minus(q, times(p, 0.5)), 2 / std::sqrt(3.0));
  const Vec3d z =
      times(minus(r, plus(times(p, 0.5), times(y, std::sqrt(3.0) / 6))), std::sqrt(1.5));
  const double det = dot(cross(p, y), z);
  if (!(det > 0))
    return std::numeric_limits<double>::infinity();
  return (dot(p, p) + dot(y, y) + dot(z, z)) / std::cbrt(det * det);
}

void measureShapes(const Tets& tets, TetMeshCheck& check) {
  double sum = 0;
  for (std::size_t t = 0; t < tets.corners.size(); ++t) {
    if (tets.inside[t] == 0)
      continue;
    const double energy = energyOf(tets, t);
    sum += energy;
    check.worstEnergy = std::max(check.worstEnergy, energy);
    Vec3d normals[4];
    for (std::size_t i = 0; i < 4; ++i)
      normals[i] = cross(minus(tets.at(t, kFaces[i][1]), tets.at(t, kFaces[i][0])),
                         minus(tets.at(t, kFaces[i][2]), tets.at(t, kFaces[i][0])));
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < i; ++k) {
        const double between =
            std::atan2(length(cross(normals[i], normals[k])), -dot(normals[i], normals[k])) *
            (180 / 3.14159265358979323846);
        check.smallestAngle = std::min(check.smallestAngle, between);
        check.largestAngle = std::max(check.largestAngle, between);
      }
  }
  check.meanEnergy = check.insideTets > 0 ? sum / static_cast<double>(check.insideTets) : 0;
}

// Which tets hold a point.
class Finder {
public:
  explicit Finder(const Tets& tets) : tets_(tets), tree_(boxesOf(tets)) {}

  // Tets that hold p strictly.
  std::size_t count(const Vec3d& p) const {
    std::size_t found = 0;
    visit(p, [&](std::uint32_t t) {
      found += tets_.side(t, p) > 0 ? 1 : 0;
      return false;
    });
    return found;
  }
  // Whether p is in one of the inside tets or on its surface.
  bool isInside(const Vec3d& p) const {
    bool found = false;
    visit(p, [&](std::uint32_t t) {
      found = tets_.inside[t] != 0 && tets_.side(t, p) >= 0;
      return found;
    });
    return found;
  }

private:
  template <typename Found>
  void visit(const Vec3d& p, const Found& found) const {
    tree_.visit([&](const Box& box) { return box.contains(p); }, found);
  }
  static std::vector<Box> boxesOf(const Tets& tets) {
    std::vector<Box> boxes(tets.corners.size());
    for (std::size_t t = 0; t < boxes.size(); ++t)
      for (std::size_t corner = 0; corner < 4; ++corner)
        boxes[t].add(tets.at(t, corner));
    return boxes;
  }

  const Tets& tets_;
  BoxTree tree_;
};

Vec3d randomIn(const Box& box, meshes::Random& random) {
  Vec3d p{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    p[axis] = random.between(box.low[axis], box.high[axis]);
  return p;
}

// Points in random tets, small ones as often as large ones, and in the box.
void countOverlaps(const Tets& tets, const Finder& finder, std::size_t count,
                   meshes::Random& random, TetMeshCheck& check) {
  if (tets.corners.empty())
    return;
  Box box;
  for (std::size_t t = 0; t < tets.corners.size(); ++t)
    for (std::size_t corner = 0; corner < 4; ++corner)
      box.add(tets.at(t, corner));
  std::vector<Vec3d> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i] = randomIn(box, random);
    if (i % 4 == 0)
      continue;
    const std::size_t t = random.below(tets.corners.size());
    double weights[4], sum = 0;
    for (double& weight : weights)
      sum += weight = -std::log(1 - random.unit()); // exponential: even in the tet
    if (!(sum > 0))
      continue;
    points[i] = {0, 0, 0};
    for (std::size_t corner = 0; corner < 4; ++corner)
      points[i] = plus(points[i], times(tets.at(t, corner), weights[corner] / sum));
  }
  std::atomic<std::size_t> overlapping{0};
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
    if (finder.count(points[i]) > 1)
      ++overlapping;
  });
  check.overlappingPoints = overlapping;
}

bool isInside(double winding) {
  return winding > 0.5;
}
bool isUnclear(double winding) {
  return std::abs(winding - 0.5) < 0.1;
}

// Input far from the tets' surface: whether there should be some.
void judgeFarPoints(const Triangles& input, const Windings& windings,
                    const std::vector<Vec3d>& samples, const std::vector<std::uint32_t>& of,
                    const std::vector<double>& distances, TetMeshCheck& check) {
  std::vector<std::size_t> far;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    check.inToOut = std::max(check.inToOut, distances[i]);
    if (distances[i] > check.epsilon)
      far.push_back(i);
  }
  check.farPoints = far.size();
  std::vector<Vec3d> sides;
  const std::size_t step = far.size() / kMaxFarPoints + 1;
  for (std::size_t k = 0; k < far.size(); k += step) {
    const Triangle& t = input.all()[of[far[k]]];
    const Vec3d normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
    const double size = length(normal);
    if (!(size > 0))
      continue;
    const Vec3d away = times(normal, check.epsilon / 2 / size);
    sides.push_back(plus(samples[far[k]], away));
    sides.push_back(minus(samples[far[k]], away));
  }
  const std::vector<double> w = windings.at(sides);
  for (std::size_t k = 0; k < w.size(); k += 2) {
    ++check.judgedFarPoints;
    if (isInside(w[k]) != isInside(w[k + 1]) && !isUnclear(w[k]) && !isUnclear(w[k + 1]))
      ++check.lostPoints;
  }
}

// Half of the points anywhere, half of them near the surface.
void judgeSides(const Triangles& input, const Windings& windings, const Finder& finder,
                std::size_t count, meshes::Random& random, TetMeshCheck& check) {
  Box box;
  for (const Triangle& t : input.all())
    for (const Vec3d& p : t)
      box.add(p);
  const double grow = 3 * check.epsilon + 0.05 * length(minus(box.high, box.low));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] -= grow;
    box.high[axis] += grow;
  }
  std::vector<std::uint32_t> of;
  std::vector<Vec3d> points = input.samples(count / 2, random, of);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Triangle& t = input.all()[of[i]];
    const Vec3d normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
    const double size = length(normal);
    const double away = check.epsilon * random.between(2, 6) * (random.unit() < 0.5 ? -1 : 1);
    if (size > 0)
      points[i] = plus(points[i], times(normal, away / size));
  }
  while (points.size() < 2 * count) // about a half of those near are too near to something
    points.push_back(randomIn(box, random));
  const std::vector<double> distances = input.distances(points);
  std::vector<Vec3d> judged;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size() && kept < count; ++i)
    if (distances[i] > 2 * check.epsilon) {
      judged.push_back(points[i]);
      ++kept;
    }
  const std::vector<double> w = windings.at(judged);
  for (std::size_t i = 0; i < judged.size(); ++i) {
    if (isUnclear(w[i]))
      continue;
    ++check.windingPoints;
    check.wrongPoints += finder.isInside(judged[i]) != isInside(w[i]) ? 1 : 0;
  }
}

} // namespace

std::string TetMeshCheck::faults() const {
  std::string names;
  const auto add = [&](bool fault, const char* name) {
    if (fault)
      names += (names.empty() ? "" : " ") + std::string(name);
  };
  add(insideTets == 0, "empty");
  add(notPositive > 0, "not-positive");
  add(wrongFaces > 0, "wrong-faces");
  add(overlappingPoints > 0, "overlaps");
  add(unevenEdges > 0, "uneven-edges");
  add(!(std::abs(volume - enclosedVolume) <= 1e-9 * std::abs(volume)), "volume");
  add(closedInput && !(outToIn <= epsilon * (1 + 1e-6)), "far-surface");
  add(wrongPoints > 0, "wrong-side");
  return names;
}

std::string TetMeshCheck::json() const {
  // JSON knows no infinity.
  const auto number = [](double x) {
    return std::isfinite(x) ? fmt::format("{}", x) : std::string("null");
  };
  return fmt::format(
      R"({{"faults":"{}","epsilon":{},"tets":{},"insideTets":{},"notPositive":{},"wrongFaces":{},)"
      R"("overlappingPoints":{},"surfaceFaces":{},"unevenEdges":{},"volume":{},)"
      R"("enclosedVolume":{},"closedInput":{},"outToIn":{},"inToOut":{},"farPoints":{},)"
      R"("judgedFarPoints":{},"lostPoints":{},"windingPoints":{},"wrongPoints":{},)"
      R"("worstEnergy":{},"meanEnergy":{},"smallestAngle":{},"largestAngle":{}}})",
      faults(), number(epsilon), tets, insideTets, notPositive, wrongFaces, overlappingPoints,
      surfaceFaces, unevenEdges, number(volume), number(enclosedVolume), closedInput,
      number(outToIn), number(inToOut), farPoints, judgedFarPoints, lostPoints, windingPoints,
      wrongPoints, number(worstEnergy), number(meanEnergy), number(smallestAngle),
      number(largestAngle));
}

TetMeshCheck checkTetMesh(const TetMesh& mesh, const TriangleMesh& input, double epsilon,
                          const TetCheckSamples& samples) {
  TetMeshCheck check;
  check.epsilon = epsilon;
  check.tets = mesh.tetCount();
  check.closedInput = isClosed(input);
  const Tets tets(mesh);
  const Triangles surface(findSurface(tets, check));
  measureVolumes(tets, surface.all(), check);
  measureShapes(tets, check);

  meshes::Random random(samples.seed);
  const Finder finder(tets);
  countOverlaps(tets, finder, samples.overlap, random, check);

  const Triangles triangles(trianglesOf(input));
  const Windings windings(triangles.all());
  std::vector<std::uint32_t> of;
  for (const double d : triangles.distances(surface.samples(samples.surface, random, of)))
    check.outToIn = std::max(check.outToIn, d);
  of.clear();
  const std::vector<Vec3d> owed = triangles.samples(samples.surface, random, of);
  judgeFarPoints(triangles, windings, owed, of, surface.distances(owed), check);
  judgeSides(triangles, windings, finder, samples.winding, random, check);
  return check;
}

} // namespace tetvdb
