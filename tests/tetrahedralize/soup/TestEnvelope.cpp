// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/soup/Envelope.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

using Face = std::array<std::uint32_t, 3>;

struct Faces {
  std::vector<Vec3d> points;
  std::vector<Face> faces;
};

// The nearest point as a constrained minimum, found in another way than the library does: of the
// plane's foot, where it is inside by areas, and of the edges' feet.
double distanceToSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d ab = minus(b, a);
  const double l = length(ab);
  if (l == 0)
    return length(minus(p, a));
  const Vec3d along = times(ab, 1 / l);
  const double at = std::min(std::max(dot(minus(p, a), along), 0.0), l);
  return length(minus(p, plus(a, times(along, at))));
}

double distanceToTriangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  double best = std::min(
      {distanceToSegment(p, a, b), distanceToSegment(p, b, c), distanceToSegment(p, c, a)});
  const Vec3d normal = cross(minus(b, a), minus(c, a));
  const double twice = length(normal);
  if (twice > 1e-9 * dot(minus(b, a), minus(b, a))) {
    const double height = dot(minus(p, a), normal) / twice;
    const Vec3d foot = minus(p, times(normal, height / twice));
    const auto turnsLeft = [&](const Vec3d& u, const Vec3d& v) {
      return dot(cross(minus(v, u), minus(foot, u)), normal) >= 0;
    };
    if (turnsLeft(a, b) && turnsLeft(b, c) && turnsLeft(c, a))
      best = std::min(best, std::abs(height));
  }
  return best;
}

double distanceTo(const Faces& mesh, const Vec3d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const Face& f : mesh.faces)
    best = std::min(best,
                    distanceToTriangle(p, mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]]));
  return best;
}

Vec3d randomPoint(meshes::Random& random, double size) {
  return {std::nearbyint(random.between(-size, size)), std::nearbyint(random.between(-size, size)),
          std::nearbyint(random.between(-size, size))};
}

// Triangles of all sorts: about `size` long, within a box that they fill sparsely.
Faces soup(meshes::Random& random, int count, double box, double size) {
  Faces mesh;
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    const Vec3d at = randomPoint(random, box);
    for (int k = 0; k < 3; ++k)
      mesh.points.push_back(plus(at, randomPoint(random, size)));
    Face face{first, first + 1, first + 2};
    switch (random.below(6)) {
    case 0: // a segment
      face[2] = face[1];
      break;
    case 1: // a point
      face[1] = face[2] = face[0];
      break;
    case 2: // three points in line
      mesh.points[first + 2] =
          plus(mesh.points[first], times(minus(mesh.points[first + 1], mesh.points[first]), 2));
      break;
    case 3: // thin
      mesh.points[first + 2] = plus(mesh.points[first + 1], {1, 2, 0});
      break;
    default:
      break;
    }
    mesh.faces.push_back(face);
  }
  return mesh;
}

// A wavy sheet of n x n squares over [-size, size]^2.
Faces waves(int n, double size, double height) {
  Faces mesh;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      mesh.points.push_back(
          {std::nearbyint(size * (2.0 * i / n - 1)), std::nearbyint(size * (2.0 * j / n - 1)),
           std::nearbyint(height * std::sin(7.0 * i / n) * std::cos(5.0 * j / n))});
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const auto a = static_cast<std::uint32_t>(i * (n + 1) + j);
      const auto b = a + static_cast<std::uint32_t>(n + 1);
      mesh.faces.push_back({a, b, b + 1});
      mesh.faces.push_back({a, b + 1, a + 1});
    }
  return mesh;
}

// The largest distance of samples of a triangle, and how far any of its points is from a sample.
struct Sampled {
  double largest = 0, spacing = 0;
};
Sampled sample(const Faces& mesh, const Vec3d& p, const Vec3d& q, const Vec3d& r, int n) {
  Sampled sampled;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      sampled.largest = std::max(
          sampled.largest, distanceTo(mesh, plus(p, plus(times(minus(q, p), double(i) / n),
                                                         times(minus(r, p), double(j) / n)))));
  sampled.spacing = std::max({length(minus(q, p)), length(minus(r, q)), length(minus(p, r))}) / n;
  return sampled;
}

// What Envelope.h promises of an answer.
void judge(const Faces& mesh, const Envelope& envelope, const Vec3d& p, const Vec3d& q,
           const Vec3d& r, double radius, int (&answers)[2]) {
  const bool isIn = q == r ? envelope.contains(p, q, radius) : envelope.contains(p, q, r, radius);
  ++answers[isIn];
  const Sampled sampled = sample(mesh, p, q, r, q == r ? 64 : 20);
  if (isIn)
    EXPECT_LE(sampled.largest, radius * (1 + 1e-9));
  else
    EXPECT_GE(sampled.largest, radius * (1 - Envelope::kSlack) - sampled.spacing);
}

TEST(Envelope, PointsAndNearestPointsByBruteForce) {
  meshes::Random random(1);
  for (const double box : {100.0, 1e6, 0x1p36}) {
    const Faces mesh = soup(random, 150, box, box / 5);
    const Envelope envelope(mesh.points, mesh.faces, box);
    EXPECT_FALSE(envelope.empty());
    EXPECT_EQ(envelope.epsilon(), box);
    int answers[2] = {0, 0};
    for (int i = 0; i < 600; ++i) {
      Vec3d p = randomPoint(random, i % 3 == 0 ? 4 * box : box);
      if (i % 7 == 0)
        p = mesh.points[random.below(mesh.points.size())];
      const double distance = distanceTo(mesh, p);
      const Envelope::Nearest nearest = envelope.nearest(p);
      EXPECT_NEAR(nearest.distance, distance, 1e-11 * box);
      EXPECT_NEAR(length(minus(nearest.point, p)), nearest.distance, 1e-11 * box);
      const Face& f = mesh.faces[nearest.face];
      EXPECT_NEAR(distanceToTriangle(nearest.point, mesh.points[f[0]], mesh.points[f[1]],
                                     mesh.points[f[2]]),
                  0, 1e-11 * box);
      const double radius = box * random.between(0.01, 0.3);
      if (std::abs(distance - radius) < 1e-10 * box)
        continue;
      ++answers[distance < radius];
      EXPECT_EQ(envelope.contains(p, radius), distance < radius);
      if (distance > 0.01) {
        EXPECT_FALSE(envelope.contains(p, distance * (1 - 1e-9)));
      }
      EXPECT_TRUE(envelope.contains(p, distance * (1 + 1e-9) + 1e-9));
    }
    EXPECT_GT(answers[0], 50);
    EXPECT_GT(answers[1], 50);
  }
}

TEST(Envelope, OfEquallyNearFacesTheLowest) {
  Faces fan; // eight faces around a point
  fan.points.push_back({0, 0, 0});
  for (int i = 0; i < 8; ++i)
    fan.points.push_back({std::nearbyint(1000 * std::cos(i * 0.785)),
                          std::nearbyint(1000 * std::sin(i * 0.785)), 0});
  for (std::uint32_t i = 0; i < 8; ++i)
    fan.faces.push_back({0, 1 + (i + 5) % 8, 1 + (i + 6) % 8});
  const Envelope envelope(fan.points, fan.faces, 10);
  EXPECT_EQ(envelope.nearest({0, 0, 77}).face, 0u);
  EXPECT_EQ(envelope.nearest({0, 0, 0}).face, 0u);
  for (std::uint32_t i = 1; i < 8; ++i) { // on the edge of faces i - 1 and i
    const Vec3d& corner = fan.points[1 + (i + 5) % 8];
    EXPECT_EQ(envelope.nearest({corner[0] * 0.3, corner[1] * 0.3, -5}).face, i - 1);
  }
  const Faces twice{fan.points, {fan.faces[3], fan.faces[3], fan.faces[3]}};
  EXPECT_EQ(Envelope(twice.points, twice.faces, 10).nearest({1, 2, 3}).face, 0u);
}

TEST(Envelope, TrianglesAndSegmentsNearASoup) {
  meshes::Random random(2);
  int answers[2] = {0, 0};
  for (int round = 0; round < 4; ++round) {
    const double box = round % 2 == 0 ? 1e4 : 0x1p36, size = round < 2 ? 0.5 * box : 0.15 * box;
    const Faces mesh = soup(random, 60, box, size);
    const Envelope envelope(mesh.points, mesh.faces, box);
    for (int i = 0; i < 100; ++i) {
      const Face& f = mesh.faces[random.below(mesh.faces.size())];
      const double radius = box * random.between(0.03, 0.3), away = 1.4 * radius * random.unit();
      std::array<Vec3d, 3> at;
      for (std::size_t k = 0; k < 3; ++k)
        at[k] = plus(mesh.points[f[k]], randomPoint(random, away));
      judge(mesh, envelope, at[0], at[1], i % 3 == 0 ? at[1] : at[2], radius, answers);
    }
  }
  EXPECT_GT(answers[0], 50);
  EXPECT_GT(answers[1], 50);
}

TEST(Envelope, LargeTrianglesOverManySmallFaces) {
  meshes::Random random(3);
  constexpr double kSize = 0x1p30, kHeight = kSize / 20;
  const Faces mesh = waves(12, kSize, kHeight);
  const Envelope envelope(mesh.points, mesh.faces, kSize);
  int answers[2] = {0, 0};
  for (int i = 0; i < 150; ++i) {
    const double l = kSize * random.between(0.05, 0.8);
    const Vec3d at = randomPoint(random, kSize * 0.7);
    std::array<Vec3d, 3> corner;
    for (Vec3d& p : corner) {
      p = plus(at, randomPoint(random, l));
      p[2] = envelope.nearest({p[0], p[1], 0}).point[2] + random.between(-1, 1) * kHeight / 5;
    }
    judge(mesh, envelope, corner[0], corner[1], i % 4 == 0 ? corner[1] : corner[2],
          kHeight * random.between(0.1, 1.5), answers);
  }
  EXPECT_GT(answers[0], 25);
  EXPECT_GT(answers[1], 25);
}

// The whole of the radius counts, but for kSlack near the border.
TEST(Envelope, ParallelSheetsJustInsideAndJustOutside) {
  for (const int n : {1, 7, 90}) { // faces from much larger than the radius to much smaller
    const Faces mesh = waves(n, 1e9, 0);
    const Envelope envelope(mesh.points, mesh.faces, 1e8);
    for (const double height : {0.5, 0.9, 0.97, 1 - Envelope::kSlack}) {
      const auto at = [&](double x, double y) { return Vec3d{x, y, height * 1e8}; };
      EXPECT_TRUE(envelope.contains(at(-8e8, -7e8), at(9e8, -5e8), at(2e8, 8e8), 1e8)) << n;
      EXPECT_TRUE(envelope.contains(at(-8e8, -7e8), at(9e8, 5e8), 1e8)) << n;
    }
    const Vec3d out{0, 0, 1.0001e8};
    EXPECT_FALSE(envelope.contains(out, plus(out, {3e8, 0, 0}), plus(out, {0, 3e8, 0}), 1e8));
    EXPECT_FALSE(envelope.contains({-8e8, 0, 0}, {1.2e9, 0, 0}, {0, 8e8, 0}, 1e8));
  }
}

TEST(Envelope, HolesAreNotCovered) {
  Faces mesh = waves(40, 1e9, 0); // squares of 5e7
  const auto isNearMiddle = [&](const Face& f) {
    double far = 0;
    for (const std::uint32_t v : f)
      far = std::max({far, std::abs(mesh.points[v][0]), std::abs(mesh.points[v][1])});
    return far < 1.1e8;
  };
  mesh.faces.erase(std::remove_if(mesh.faces.begin(), mesh.faces.end(), isNearMiddle),
                   mesh.faces.end()); // a hole from -1e8 to 1e8
  const Envelope envelope(mesh.points, mesh.faces, 2e8);
  const Vec3d a{-9e8, -8e8, 0}, b{9e8, -8e8, 0}, c{0, 9e8, 0};
  EXPECT_FALSE(envelope.contains(a, b, c, 0.99e8));
  EXPECT_TRUE(envelope.contains(a, b, c, 1.03e8));
}

TEST(Envelope, DegenerateCandidates) {
  const Faces mesh = waves(10, 1e6, 1e5);
  const Envelope envelope(mesh.points, mesh.faces, 1e5);
  const Vec3d on = mesh.points[37], off = plus(on, {0, 0, 9e5});
  EXPECT_TRUE(envelope.contains(on, on, on, 1));
  EXPECT_TRUE(envelope.contains(on, on, 1));
  EXPECT_FALSE(envelope.contains(on, on, off, 1e5));
  EXPECT_FALSE(envelope.contains(on, off, on, 1e5));
  EXPECT_FALSE(envelope.contains(off, off, off, 1e5));
  EXPECT_TRUE(envelope.contains(on, plus(on, {0, 0, 1e3}), plus(on, {0, 0, 2e3}), 3e3));
}

TEST(Envelope, NoFacesOneFaceEqualFaces) {
  const std::vector<Vec3d> points{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
  const Envelope none(points, {}, 5);
  EXPECT_TRUE(none.empty());
  EXPECT_FALSE(none.contains(points[0], 5));
  EXPECT_FALSE(none.contains(points[0], points[1], 5));
  EXPECT_FALSE(none.contains(points[0], points[1], points[2], 5));
  const Envelope one(points, {{0, 1, 2}}, 5);
  EXPECT_TRUE(one.contains(points[0], points[1], points[2], 1e-3));
  EXPECT_EQ(one.nearest({3, 3, 7}).distance, 7);
  EXPECT_EQ(one.nearest({3, 3, 7}).point, (Vec3d{3, 3, 0}));
  EXPECT_EQ(one.nearest({-3e9, -4e9, 0}).distance, 5e9);
  const Envelope many(points, std::vector<Face>(5000, Face{0, 1, 2}), 5);
  EXPECT_EQ(many.nearest({3, 3, 7}).face, 0u);
  EXPECT_TRUE(many.contains({3, 3, 4.9}, 5));
  EXPECT_FALSE(many.contains({3, 3, 5.1}, 5));
}

TEST(Envelope, TheSameForAnyNumberOfThreads) {
  meshes::Random random(4);
  const Faces mesh = soup(random, 20000, 1e9, 1e7);
  std::vector<Vec3d> at;
  for (int i = 0; i < 500; ++i)
    at.push_back(randomPoint(random, 1e9));
  std::vector<double> first;
  for (const int threads : {1, 2, 8})
    tbb::task_arena(threads).execute([&] {
      const Envelope envelope(mesh.points, mesh.faces, 1e8);
      std::vector<double> answers;
      for (std::size_t i = 0; i + 2 < at.size(); ++i) {
        const Envelope::Nearest nearest = envelope.nearest(at[i]);
        answers.insert(answers.end(), {nearest.distance, nearest.point[0], double(nearest.face)});
        const auto closer = [&](const Vec3d& p) {
          return plus(at[i], times(minus(p, at[i]), 0.1));
        };
        answers.push_back(envelope.contains(at[i], closer(at[i + 1]), closer(at[i + 2]), 1e8));
      }
      if (first.empty())
        first = answers;
      EXPECT_EQ(answers, first);
    });
}

} // namespace
} // namespace tetvdb
