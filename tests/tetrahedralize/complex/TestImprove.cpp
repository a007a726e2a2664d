// SPDX-License-Identifier: Apache-2.0
#include "tetrahedralize/TetMeshes.h"
#include "tetvdb/tetrahedralize/complex/Improve.h"
#include "tetvdb/tetrahedralize/complex/PeelTets.h"
#include "tetvdb/tetrahedralize/complex/SwapEdges.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <tbb/global_control.h>
#include <vector>

namespace tetvdb {
namespace {

constexpr double kImproveStep = 1e6;

Vec3d minusOf(const Vec3d& a, const Vec3d& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dotOf(const Vec3d& a, const Vec3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// tr(J^T J) / det(J)^(2/3) for the map J from a regular tet, by the definition.
double amips(const TetComplex& complex, const std::array<std::uint32_t, 4>& corners) {
  // The inverse of the regular tet's edges (1,0,0), (1/2,s3/2,0), (1/2,s3/6,s6/3), as columns.
  const double s3 = std::sqrt(3.0), s6 = std::sqrt(6.0);
  const double inverse[3][3] = {{1, -1 / s3, -1 / s6}, {0, 2 / s3, -1 / s6}, {0, 0, 3 / s6}};
  double edges[3][3], j[3][3] = {};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      edges[axis][k] = complex.at(corners[k + 1])[axis] - complex.at(corners[0])[axis];
  double trace = 0;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column) {
      for (std::size_t k = 0; k < 3; ++k)
        j[row][column] += edges[row][k] * inverse[k][column];
      trace += j[row][column] * j[row][column];
    }
  const double det = j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) -
                     j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0]) +
                     j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]);
  return trace / std::pow(det, 2.0 / 3);
}

double worstOf(const TetComplex& complex) {
  double worst = 0;
  for (const auto& tet : complex.tets)
    if (tet.exists())
      worst = std::max(worst, amips(complex, tet.corners));
  return worst;
}

// To a triangle, by the plane where the foot lies inside and by the edges.
double distanceTo(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d* corners[3] = {&a, &b, &c};
  double minValue = std::numeric_limits<double>::infinity();
  const Vec3d u = minusOf(b, a), v = minusOf(c, a), w = minusOf(p, a);
  const double uu = dotOf(u, u), uv = dotOf(u, v), vv = dotOf(v, v), uw = dotOf(u, w),
               vw = dotOf(v, w), det = uu * vv - uv * uv;
  const double s = (vv * uw - uv * vw) / det, t = (uu * vw - uv * uw) / det;
  if (s >= 0 && t >= 0 && s + t <= 1)
    minValue = std::sqrt(std::max(0.0, dotOf(w, w) - s * uw - t * vw));
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d e = minusOf(*corners[(i + 1) % 3], *corners[i]), d = minusOf(p, *corners[i]);
    const double along = std::clamp(dotOf(d, e) / dotOf(e, e), 0.0, 1.0);
    double square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      square += (d[axis] - along * e[axis]) * (d[axis] - along * e[axis]);
    minValue = std::min(minValue, std::sqrt(square));
  }
  return minValue;
}

// The farthest of some points on the faces of `from` to `to`.
double farthest(const TrackedFaces& from, const TrackedFaces& to, int samples) {
  double maxValue = 0;
  for (const auto& face : from.faces)
    for (int i = 0; i <= samples; ++i)
      for (int j = 0; i + j <= samples; ++j) {
        Vec3d p{0, 0, 0};
        const double weights[3] = {double(i) / samples, double(j) / samples,
                                   double(samples - i - j) / samples};
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t axis = 0; axis < 3; ++axis)
            p[axis] += weights[k] * from.points[face[k]][axis];
        double minValue = std::numeric_limits<double>::infinity();
        for (const auto& other : to.faces)
          minValue = std::min(minValue, distanceTo(p, to.points[other[0]], to.points[other[1]],
                                                   to.points[other[2]]));
        maxValue = std::max(maxValue, minValue);
      }
  return maxValue;
}

TetComplex ball(int cells) {
  const double midpoint = cells * kImproveStep / 2;
  return cubeMesh(cells, kImproveStep, 0.1,
                  ballAt({midpoint, midpoint, midpoint}, 0.33 * cells * kImproveStep));
}

// A ball's tets and what must be kept of them.
struct Kept {
  TetComplex complex;
  TrackedFaces surface;
  Int128 volume;
  double radius;
  Envelope envelope, boundary;
  Bounds bounds;

  Kept(TetComplex mesh, double epsilon)
      : complex(std::move(mesh)), surface(trackedFaces(complex)), volume(volumeOf(complex)),
        radius(epsilon), envelope(surface.points, surface.faces, epsilon),
        boundary({}, {}, epsilon), bounds{envelope, boundary, epsilon} {}

  void expect() const {
    ASSERT_NO_THROW(complex.verify());
    EXPECT_TRUE(volumeOf(complex) == volume);
    const TrackedFaces now = trackedFaces(complex);
    expectClosed(now);
    EXPECT_EQ(eulerNumber(now), eulerNumber(surface));
    EXPECT_LE(farthest(now, surface, 4), radius * (1 + 1e-9));
  }
};

bool sameTets(const TetComplex& a, const TetComplex& b) {
  if (a.tets.size() != b.tets.size() || a.points.size() != b.points.size())
    return false;
  for (std::size_t t = 0; t < a.tets.size(); ++t)
    if (a.tets[t].corners != b.tets[t].corners || a.tets[t].chains != b.tets[t].chains)
      return false;
  for (std::size_t p = 0; p < a.points.size(); ++p)
    if (a.points[p].at != b.points[p].at)
      return false;
  return true;
}

TEST(TetEnergy, IsAmips) {
  std::mt19937_64 random(1);
  for (const double scale : {10.0, 1e5, 1e10})
    for (int i = 0; i < 300; ++i) {
      TetComplex complex;
      std::uniform_real_distribution<double> coordinate(-scale, scale);
      for (int k = 0; k < 4; ++k)
        complex.addPoint(
            roundToLattice({coordinate(random), coordinate(random), coordinate(random)}));
      const bool isPositive = complex.isPositive({0, 1, 2, 3});
      const double energy = tetEnergy(complex.at(0), complex.at(1), complex.at(2), complex.at(3));
      if (!isPositive) {
        EXPECT_EQ(energy, std::numeric_limits<double>::infinity());
        continue;
      }
      const double expected = amips(complex, {0, 1, 2, 3});
      EXPECT_NEAR(energy, expected, 1e-6 * expected);
      EXPECT_GE(energy, 3 - 1e-12);
      const Vec3d &p = complex.at(0), &a = complex.at(1), &b = complex.at(2), &c = complex.at(3);
      EXPECT_TRUE(EnergyLimit(energy * (1 + 1e-9)).allows(p, a, b, c));
      EXPECT_FALSE(EnergyLimit(energy * (1 - 1e-9)).allows(p, a, b, c));
      EXPECT_FALSE(EnergyLimit(1e30).allows(p, b, a, c));
    }
  // One unit high, 2^37 wide: doubles alone see no volume.
  const double far = 137438953471.0;
  const Vec3d o{0, 0, 0}, x{far, 1, 0}, y{far - 1, far, 0}, z{far - 2, far - 3, 1};
  EXPECT_TRUE(std::isfinite(tetEnergy(o, x, y, z)));
  EXPECT_TRUE(std::isinf(tetEnergy(o, y, x, z)));
}

TEST(Coarsen, FewerTetsAndTheSurfaceStays) {
  for (const double epsilon : {0.02, 0.4}) {
    Kept kept(ball(12), epsilon * kImproveStep);
    const std::size_t before = kept.complex.tetCount();
    Progress progress;
    const ImproveCounts counts = coarsen(kept.complex, kept.bounds, progress);
    kept.expect();
    EXPECT_LT(kept.complex.tetCount(), before / 2);
    EXPECT_GT(counts.collapses, 100u);
    EXPECT_LE(worstOf(kept.complex), kCoarsenEnergy * (1 + 1e-6));
    EXPECT_NEAR(counts.worstEnergy, worstOf(kept.complex), 1e-4 * counts.worstEnergy);
  }
}

// Two solids with a wall of one cell between them, thinner than the envelope: it must not be
// pressed together.
TEST(Coarsen, ThinWallsStay) {
  const int cells = 12;
  Kept kept(cubeMesh(cells, kImproveStep, 0.1,
                     [](const Vec3d& p) {
                       const double x = p[0] / kImproveStep, y = p[1] / kImproveStep,
                                    z = p[2] / kImproveStep;
                       const bool inside = y > 3 && y < 9 && z > 3 && z < 9;
                       return inside && x > 3 && x < 9 && !(x > 6 && x < 7) ? 1 : 0;
                     }),
            1.2 * kImproveStep);
  EXPECT_EQ(eulerNumber(kept.surface), 4);
  Progress progress;
  coarsen(kept.complex, kept.bounds, progress);
  kept.expect();
}

// A spike of one cell's width: one-sided bounds would let it be worn away.
TEST(Coarsen, SpikesStay) {
  constexpr double kRadius = 0.75 * kImproveStep;
  const int cells = 12;
  Kept kept(cubeMesh(cells, kImproveStep, 0.05,
                     [](const Vec3d& p) {
                       const double x = p[0] / kImproveStep, y = p[1] / kImproveStep,
                                    z = p[2] / kImproveStep;
                       const bool body = x > 2 && x < 5 && y > 3 && y < 8 && z > 3 && z < 8;
                       const bool spike = x > 4 && x < 10 && y > 5 && y < 6 && z > 5 && z < 6;
                       return body || spike ? 1 : 0;
                     }),
            kRadius);
  Progress progress;
  coarsen(kept.complex, kept.bounds, progress);
  kept.expect();
  EXPECT_LE(farthest(kept.surface, trackedFaces(kept.complex), 2), kRadius);
}

// One hundredth of less than a hundred tets is none.
TEST(Coarsen, EndsOnFewTets) {
  Kept kept(cubeMesh(2, kImproveStep, 0.1,
                     ballAt({kImproveStep, kImproveStep, kImproveStep}, 0.8 * kImproveStep)),
            0.3 * kImproveStep);
  Progress progress;
  progress.setDeadline(Progress::Clock::now() + std::chrono::minutes(1));
  EXPECT_NO_THROW(coarsen(kept.complex, kept.bounds, progress));
  EXPECT_LT(kept.complex.tetCount(), 100u);
}

TEST(Coarsen, SameForAnyNumberOfThreads) {
  std::vector<TetComplex> results;
  for (const std::size_t threads : {1u, 2u, 8u}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Kept kept(ball(16), 0.3 * kImproveStep);
    Progress progress;
    coarsen(kept.complex, kept.bounds, progress);
    results.push_back(kept.complex);
  }
  EXPECT_TRUE(sameTets(results[0], results[1]));
  EXPECT_TRUE(sameTets(results[0], results[2]));
}

TEST(SwapEdges, EverySwapMakesTheWorstBetter) {
  Kept kept(
      cubeMesh(8, kImproveStep, 0.2,
               ballAt({4 * kImproveStep, 4 * kImproveStep, 4 * kImproveStep}, 2.6 * kImproveStep)),
      0.3 * kImproveStep);
  EdgeSwapper swapper(kept.complex, kept.bounds, 3.5);
  double worst = worstOf(kept.complex);
  std::size_t swaps = 0;
  for (int sweep = 0; sweep < 5; ++sweep) {
    swaps += swapper.sweep();
    EXPECT_LE(worstOf(kept.complex), worst * (1 + 1e-6));
    worst = worstOf(kept.complex);
    kept.expect();
  }
  EXPECT_GT(swaps, 100u);
  // What has not changed is not tried again.
  while (swapper.sweep() > 0) {
  }
  const std::size_t tried = swapper.tried();
  EXPECT_EQ(swapper.sweep(), 0u);
  EXPECT_LT(swapper.tried() - tried, tried / 20);
}

TEST(Improve, ReachesTheEnergyWithinBounds) {
  std::vector<TetComplex> results;
  for (const std::size_t threads : {1u, 2u, 8u}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Kept kept(ball(12), 0.4 * kImproveStep);
    Progress progress;
    coarsen(kept.complex, kept.bounds, progress);
    ASSERT_GT(worstOf(kept.complex), 50);
    ImproveOptions options;
    options.edgeLength = 4 * kImproveStep;
    options.smallestEdge = 0.1 * kImproveStep;
    const ImproveCounts counts = improve(kept.complex, kept.bounds, options, progress);
    kept.expect();
    EXPECT_LE(worstOf(kept.complex), 10 * (1 + 1e-6));
    EXPECT_GT(counts.splits + counts.swaps, 0u);
    EXPECT_GT(counts.moves, 0u);
    results.push_back(kept.complex);
  }
  EXPECT_TRUE(sameTets(results[0], results[1]));
  EXPECT_TRUE(sameTets(results[0], results[2]));
}

// Tets outside the ball count less.
void makeOutsideLight(TetComplex& complex, float weight) {
  std::vector<Chain> winding(complex.tets.size(), 0);
  std::vector<char> seen(complex.tets.size(), 0);
  std::vector<std::uint32_t> open{complex.points[0].tet}; // at the box's corner
  seen[open[0]] = 1;
  while (!open.empty()) {
    const std::uint32_t t = open.back();
    open.pop_back();
    TetComplex::Tet& tet = complex.tets[t];
    tet.weight = winding[t] == 0 ? weight : 1;
    tet.energy = 0;
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      const std::uint32_t next = tet.neighbours[localFace];
      if (next == TetComplex::kOutside || seen[next] != 0)
        continue;
      seen[next] = 1;
      winding[next] = winding[t] - tet.chains[localFace];
      open.push_back(next);
    }
  }
}

std::size_t countWhole(const TetComplex& complex) {
  std::size_t count = 0;
  for (const auto& tet : complex.tets)
    count += tet.exists() && tet.weight == 1;
  return count;
}

TEST(PeelTets, TetsGoOutsideAndTheSurfaceStays) {
  for (const double radius : {0.3, 0.6, 1.2}) {
    Kept kept(ball(10), radius * kImproveStep);
    makeOutsideLight(kept.complex, 0.1f);
    const std::size_t before = countWhole(kept.complex);
    const TetComplex old = kept.complex;
    const Landmarks landmarks(kept.envelope, kept.radius);
    const Bounds bounds{kept.envelope, kept.boundary, kept.radius, &landmarks};
    TetPeeler peeler(kept.complex, bounds, 3.5);
    std::size_t gone = 0;
    while (const std::size_t now = peeler.sweep())
      gone += now;
    kept.expect();
    EXPECT_EQ(countWhole(kept.complex) + gone, before);
    if (radius > 0.5) {
      EXPECT_GT(gone, 20u);
    }
    // Points and tets are where they were; weights are what the chains say.
    for (std::size_t t = 0; t < old.tets.size(); ++t)
      EXPECT_EQ(kept.complex.tets[t].corners, old.tets[t].corners);
    TetComplex flooded = kept.complex;
    makeOutsideLight(flooded, 0.1f);
    for (std::size_t t = 0; t < old.tets.size(); ++t)
      EXPECT_EQ(flooded.tets[t].weight, kept.complex.tets[t].weight);
    EXPECT_LE(farthest(kept.surface, trackedFaces(kept.complex), 2), kept.radius * (1 + 1e-9));
  }
}

// All of a plate of one cell is within the envelope: nothing may go through it.
TEST(PeelTets, PlatesKeepTheirTopology) {
  Kept kept(cubeMesh(10, kImproveStep, 0.1,
                     [](const Vec3d& p) {
                       const double x = p[0] / kImproveStep, y = p[1] / kImproveStep,
                                    z = p[2] / kImproveStep;
                       return x > 2 && x < 8 && y > 2 && y < 8 && z > 5 && z < 6 ? 1 : 0;
                     }),
            1.5 * kImproveStep);
  makeOutsideLight(kept.complex, 0.1f);
  TetPeeler peeler(kept.complex, kept.bounds, 3.2);
  std::size_t gone = 0;
  while (const std::size_t now = peeler.sweep())
    gone += now;
  EXPECT_GT(gone, 10u);
  kept.expect();
}

TEST(Improve, OutsideCountsLess) {
  Kept kept(ball(12), 0.4 * kImproveStep);
  makeOutsideLight(kept.complex, 1.f / 30);
  Progress progress;
  ImproveOptions options;
  options.edgeLength = 3 * kImproveStep;
  options.smallestEdge = 0.1 * kImproveStep;
  const ImproveCounts counts = improve(kept.complex, kept.bounds, options, progress);
  kept.expect();
  double worst = 0, worstOutside = 0, sum = 0;
  for (const auto& tet : kept.complex.tets) {
    if (!tet.exists())
      continue;
    const double energy = amips(kept.complex, tet.corners);
    (tet.weight == 1 ? worst : worstOutside) =
        std::max(tet.weight == 1 ? worst : worstOutside, energy);
    sum += tet.weight == 1 ? energy : 0;
  }
  EXPECT_LE(worst, 10 * (1 + 1e-6));
  EXPECT_LE(worstOutside, 300 * (1 + 1e-6));
  EXPECT_NEAR(counts.worstEnergy, worst, 1e-4 * worst);
  const double mean = sum / static_cast<double>(countWhole(kept.complex));
  EXPECT_NEAR(counts.meanEnergy, mean, 1e-4 * mean);
  EXPECT_LT(mean, 3.8);
  // What the weights say is still the ball.
  TetComplex flooded = kept.complex;
  makeOutsideLight(flooded, 1.f / 30);
  for (std::size_t t = 0; t < flooded.tets.size(); ++t)
    if (flooded.tets[t].exists()) {
      EXPECT_EQ(flooded.tets[t].weight, kept.complex.tets[t].weight);
    }
}

// Nobody reaches that: it ends all the same, and with a mesh that is valid.
TEST(Improve, EndsInVain) {
  Kept kept(ball(4), 0.2 * kImproveStep);
  Progress progress;
  ImproveOptions options;
  options.edgeLength = 3 * kImproveStep;
  options.smallestEdge = 0.5 * kImproveStep;
  options.stopEnergy = 3.01;
  const ImproveCounts counts = improve(kept.complex, kept.bounds, options, progress);
  EXPECT_LT(counts.passes, options.maxPasses);
  kept.expect();
}

TEST(Improve, StopsWhenCancelled) {
  Kept kept(ball(8), 0.4 * kImproveStep);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(coarsen(kept.complex, kept.bounds, progress), Error);
}

} // namespace
} // namespace tetvdb
