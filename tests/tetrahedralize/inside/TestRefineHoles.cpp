// SPDX-License-Identifier: Apache-2.0
#include "TetMeshes.h"
#include "TriangleMeshes.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/inside/Classify.h"
#include "tetvdb/tetrahedralize/inside/RefineHoles.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

constexpr double kHoleStep = 1 << 20;
constexpr int kHoleCells = 8;
constexpr double kHoleMiddle = kHoleCells * kHoleStep / 2;
const Vec3d kHoleCentre{kHoleMiddle, kHoleMiddle, kHoleMiddle};

// Half a ball's surface: open.
TetComplex bowl() {
  TetComplex complex = cubeMesh(kHoleCells, kHoleStep, 0.2, ballAt(kHoleCentre, 3.2 * kHoleStep));
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t)
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      TetComplex::Tet& tet = complex.tets[t];
      if (tet.chains[localFace] == 0 || tet.neighbours[localFace] == TetComplex::kOutside ||
          complex.at(tet.corners[kFaceCorners[localFace][0]])[0] < kHoleMiddle)
        continue;
      TetComplex::Tet& other = complex.tets[tet.neighbours[localFace]];
      const unsigned back = complex.localFaceOf(tet.neighbours[localFace], t);
      tet.chains[localFace] = other.chains[back] = 0;
      tet.tracked[localFace] = other.tracked[back] = false;
    }
  return complex;
}

TriangleMesh surfaceWithHoles(const TetComplex& complex) {
  const TrackedFaces tracked = trackedFaces(complex);
  TriangleMesh mesh;
  mesh.points = tracked.points;
  for (const auto& face : tracked.faces)
    mesh.triangles.insert(mesh.triangles.end(), face.begin(), face.end());
  return mesh;
}

// The share of tets' volume whose side is not that of points in it, by solid angles.
double volumeWrong(const TetComplex& complex, const std::vector<std::uint16_t>& inside,
                   const TriangleMesh& surface) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  double wrong = 0, all = 0;
  for (std::size_t t = 0; t < complex.tets.size(); ++t) {
    const TetComplex::Tet& tet = complex.tets[t];
    if (!tet.exists())
      continue;
    const auto at = [&](std::size_t i) { return complex.at(tet.corners[i]); };
    const double volume = orientDeterminant(at(0), at(1), at(2), at(3));
    all += volume;
    std::array<double, 4> share{};
    double sum = 0;
    for (double& s : share)
      sum += s = -std::log(1 - unit(random));
    Vec3d p{0, 0, 0};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        p[axis] += share[i] / sum * at(i)[axis];
    if ((meshes::windingNumberAt(surface, p) > 0.5) != (inside[t] != 0))
      wrong += volume;
  }
  return wrong / all;
}

double longestEdge(const TetComplex& complex, const TetComplex::Tet& tet) {
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3d along = minus(complex.at(tet.corners[i]), complex.at(tet.corners[j]));
      longest = std::max(longest, std::sqrt(dot(along, along)));
    }
  return longest;
}

// Tets with a face at which the inside ends, but the input is not.
std::vector<std::size_t> tetsAtHoles(const TetComplex& complex,
                                     const std::vector<std::uint16_t>& inside) {
  std::vector<std::size_t> found;
  for (std::size_t t = 0; t < complex.tets.size(); ++t) {
    const TetComplex::Tet& tet = complex.tets[t];
    bool ends = false;
    for (std::size_t localFace = 0; tet.exists() && localFace < 4; ++localFace) {
      const std::uint32_t next = tet.neighbours[localFace];
      ends = ends || (next != TetComplex::kOutside && tet.chains[localFace] == 0 &&
                      inside[next] != inside[t]);
    }
    if (ends)
      found.push_back(t);
  }
  return found;
}

TEST(RefineHoles, SurfaceComesNearTheWindingNumbersAsTetsGetSmall) {
  Progress progress;
  TetComplex complex = bowl();
  const TriangleMesh surface = surfaceWithHoles(complex);
  const Int128 volume = volumeOf(complex);
  std::vector<std::uint16_t> inside = insideOf(complex, 1, {}, {}, progress);
  const double before = volumeWrong(complex, inside, surface);
  const double length = kHoleStep / 3;
  EXPECT_GT(refineHoles(complex, 1, {}, {}, {length, 200000}, inside, progress), 100u);
  complex.verify();
  EXPECT_TRUE(volumeOf(complex) == volume);
  EXPECT_LT(volumeWrong(complex, inside, surface), before / 2.5);
  EXPECT_EQ(inside, insideOf(complex, 1, {}, {}, progress));
  const std::vector<std::size_t> ends = tetsAtHoles(complex, inside);
  for (const std::size_t t : ends)
    EXPECT_LE(longestEdge(complex, complex.tets[t]), length);
  EXPECT_GT(ends.size(), 100u);
}

TEST(RefineHoles, TetsNearPointsGetSmaller) {
  Progress progress;
  const double near = kHoleStep / 8, length = kHoleStep / 2;
  TetComplex complex = bowl();
  // Where the surface that closes the hole passes the axis.
  const TriangleMesh surface = surfaceWithHoles(complex);
  Vec3d point = kHoleCentre;
  double in = kHoleMiddle - 3 * kHoleStep, out = kHoleMiddle + 3 * kHoleStep;
  for (int i = 0; i < 40; ++i) {
    point[0] = (in + out) / 2;
    (meshes::windingNumberAt(surface, point) > 0.5 ? in : out) = point[0];
  }
  std::vector<std::uint16_t> inside = insideOf(complex, 1, {}, {}, progress);
  refineHoles(complex, 1, {}, {}, {length, 200000, {point}, near}, inside, progress);
  complex.verify();
  std::size_t small = 0, large = 0;
  for (const std::size_t t : tetsAtHoles(complex, inside)) {
    const TetComplex::Tet& tet = complex.tets[t];
    bool isNear = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double low = complex.at(tet.corners[0])[axis], high = low;
      for (const std::uint32_t corner : tet.corners) {
        low = std::min(low, complex.at(corner)[axis]);
        high = std::max(high, complex.at(corner)[axis]);
      }
      isNear = isNear && low - near <= point[axis] && point[axis] <= high + near;
    }
    const double longest = longestEdge(complex, tet);
    EXPECT_LE(longest, isNear ? near : length);
    ++(longest <= near ? small : large);
  }
  EXPECT_GT(small, 5u);
  EXPECT_GT(large, 100u);
  EXPECT_EQ(inside, insideOf(complex, 1, {}, {}, progress));
}

TEST(RefineHoles, LeavesClosedInputsAlone) {
  Progress progress;
  TetComplex complex = cubeMesh(kHoleCells, kHoleStep, 0.2, ballAt(kHoleCentre, 3.2 * kHoleStep));
  std::vector<std::uint16_t> inside = insideOf(complex, 1, {}, {}, progress);
  const std::vector<std::uint16_t> before = inside;
  EXPECT_EQ(refineHoles(complex, 1, {}, {}, {1, 1000}, inside, progress), 0u);
  EXPECT_EQ(inside, before);
}

TEST(RefineHoles, ClosedInputsKeepWhatTheyHave) {
  // Input 1, closed, is where the hole of input 0 is.
  Progress progress;
  TetComplex complex = bowl();
  const auto ball = ballAt({kHoleMiddle + kHoleStep, kHoleMiddle, kHoleMiddle}, 1.6 * kHoleStep);
  const auto centre = [&](const TetComplex::Tet& tet) {
    Vec3d sum{0, 0, 0};
    for (const std::uint32_t corner : tet.corners)
      for (std::size_t axis = 0; axis < 3; ++axis)
        sum[axis] += complex.at(corner)[axis] / 4;
    return sum;
  };
  for (TetComplex::Tet& tet : complex.tets)
    for (unsigned localFace = 0; localFace < 4; ++localFace)
      if (tet.neighbours[localFace] != TetComplex::kOutside) {
        const Chain change =
            ball(centre(tet)) - ball(centre(complex.tets[tet.neighbours[localFace]]));
        tet.chains[localFace] += change * unitChain(1, 2);
        tet.tracked[localFace] = tet.tracked[localFace] || change != 0;
      }
  std::vector<std::uint16_t> inside = insideOf(complex, 2, {}, {}, progress);
  refineHoles(complex, 2, {}, {}, {kHoleStep / 2, 200000}, inside, progress);
  complex.verify();
  EXPECT_EQ(inside, insideOf(complex, 2, {}, {}, progress));
}

TEST(RefineHoles, StopsWhereThereAreManyTets) {
  Progress progress;
  TetComplex complex = bowl();
  const std::size_t before = complex.tetCount();
  std::vector<std::uint16_t> inside = insideOf(complex, 1, {}, {}, progress);
  refineHoles(complex, 1, {}, {}, {1, 3000}, inside, progress);
  EXPECT_GE(complex.tetCount(), before + 3000);
  EXPECT_LT(complex.tetCount(), before + 3100);
}

} // namespace
} // namespace tetvdb
