// SPDX-License-Identifier: Apache-2.0
#include "TetMeshes.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/tetrahedralize/inside/Classify.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

constexpr double kStep = 1 << 20;
constexpr int kCells = 14;
constexpr double kMiddle = kCells * kStep / 2;
const Vec3d kCentre{kMiddle, kMiddle, kMiddle};

std::vector<std::uint16_t> classify(const TetComplex& complex, std::size_t inputs,
                                    const LatticeSoup& soup = {},
                                    const std::vector<std::uint32_t>& missing = {}) {
  Progress progress;
  return insideOf(complex, inputs, soup, missing, progress);
}

Vec3d centreOf(const TetComplex& complex, const TetComplex::Tet& tet) {
  Vec3d centre{0, 0, 0};
  for (const std::uint32_t corner : tet.corners)
    for (std::size_t axis = 0; axis < 3; ++axis)
      centre[axis] += complex.at(corner)[axis] / 4;
  return centre;
}

// Makes tracked faces plain ones, and returns them as they were seen from their positive side.
template <typename Choose>
std::vector<std::array<std::uint32_t, 3>> forget(TetComplex& complex, const Choose& choose) {
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t)
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      TetComplex::Tet& tet = complex.tets[t];
      const auto& at = kFaceCorners[localFace];
      const std::array<std::uint32_t, 3> face{tet.corners[at[0]], tet.corners[at[1]],
                                              tet.corners[at[2]]};
      if (tet.chains[localFace] <= 0 || !choose(complex.at(face[0])))
        continue;
      faces.push_back(face);
      TetComplex::Tet& other = complex.tets[tet.neighbours[localFace]];
      const unsigned back = complex.localFaceOf(tet.neighbours[localFace], t);
      tet.chains[localFace] = other.chains[back] = 0;
      tet.tracked[localFace] = other.tracked[back] = false;
    }
  return faces;
}

// What stands for the input, for the sum of solid angles.
TriangleMesh classifiedSurface(const TetComplex& complex) {
  TriangleMesh mesh;
  const TrackedFaces tracked = trackedFaces(complex);
  mesh.points = tracked.points;
  for (std::size_t i = 0; i < tracked.faces.size(); ++i)
    for (Chain n = 0; n < tracked.chains[i]; ++n)
      mesh.triangles.insert(mesh.triangles.end(), tracked.faces[i].begin(), tracked.faces[i].end());
  return mesh;
}

void expectAsBruteForce(const TetComplex& complex, const TriangleMesh& surface,
                        const std::vector<std::uint16_t>& inside) {
  std::size_t in = 0, unsure = 0;
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t) {
    const double winding = meshes::windingNumberAt(surface, centreOf(complex, complex.tets[t]));
    if (std::abs(winding - 0.5) < 2e-3)
      ++unsure;
    else
      EXPECT_EQ(inside[t], winding > 0.5 ? 1 : 0) << "tet " << t << ", winding " << winding;
    in += inside[t];
  }
  EXPECT_GT(in, complex.tets.size() / 50);
  EXPECT_LT(unsure, complex.tets.size() / 100);
}

TEST(Classify, FloodsClosedInputsWhateverTheirWindings) {
  const auto ball = ballAt(kCentre, 5.2 * kStep), core = ballAt(kCentre, 3.1 * kStep);
  for (const Chain inner : {-2, -1, 0, 1, 5}) {
    const auto winding = [&](const Vec3d& p) { return core(p) != 0 ? inner : ball(p); };
    const TetComplex complex = cubeMesh(kCells, kStep, 0.2, winding);
    const std::vector<std::uint16_t> inside = classify(complex, 1);
    ASSERT_EQ(inside.size(), complex.tets.size());
    for (std::size_t t = 0; t < inside.size(); ++t)
      EXPECT_EQ(inside[t], winding(centreOf(complex, complex.tets[t])) > 0 ? 1 : 0);
  }
}

TEST(Classify, TellsPackedInputsApart) {
  // Shells of 2 each, so that windings in the middle are beyond the digits of a single face.
  const std::size_t inputs = kMaxInputs;
  const auto windingOf = [](std::size_t input, const Vec3d& p) {
    int sum = 0;
    for (int shell = 0; shell < 3; ++shell)
      sum += ballAt({kMiddle + (double(input) - 4) * kStep / 3, kMiddle, kMiddle},
                    (6 - 1.5 * shell) * kStep)(p);
    return (input % 3 == 1 ? -2 : input % 3 == 2 ? 1 : 2) * sum;
  };
  TetComplex complex = cubeMesh(kCells, kStep, 0.2, [](const Vec3d&) { return 0; });
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t) {
    TetComplex::Tet& tet = complex.tets[t];
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      if (tet.neighbours[localFace] == TetComplex::kOutside)
        continue;
      const Vec3d here = centreOf(complex, tet);
      const Vec3d there = centreOf(complex, complex.tets[tet.neighbours[localFace]]);
      for (std::size_t input = 0; input < inputs; ++input) {
        const int change = windingOf(input, here) - windingOf(input, there);
        ASSERT_LT(std::abs(change), 4) << "a digit's width";
        tet.chains[localFace] += change * unitChain(input, inputs);
      }
    }
  }
  const std::vector<std::uint16_t> inside = classify(complex, inputs);
  std::size_t beyond = 0;
  for (std::size_t t = 0; t < inside.size(); ++t)
    for (std::size_t input = 0; input < inputs; ++input) {
      const int winding = windingOf(input, centreOf(complex, complex.tets[t]));
      EXPECT_EQ(inside[t] >> input & 1, winding > 0 ? 1 : 0);
      beyond += winding > 3 || winding < -4 ? 1 : 0;
    }
  EXPECT_GT(beyond, 0u);
}

TEST(Classify, ClosesHolesByTheWindingNumber) {
  for (const double share : {-0.3, 0.3, 0.8}) {
    TetComplex complex = cubeMesh(kCells, kStep, 0.2, ballAt(kCentre, 5.2 * kStep));
    forget(complex, [&](const Vec3d& p) { return p[0] > kMiddle + share * 5.2 * kStep; });
    complex.verify();
    expectAsBruteForce(complex, classifiedSurface(complex), classify(complex, 1));
  }
}

TEST(Classify, StopsWhereThereAreMoreSumsThanAllowed) {
  TetComplex complex = cubeMesh(kCells, kStep, 0.2, ballAt(kCentre, 5.2 * kStep));
  Progress progress;
  const std::vector<std::uint16_t> closed = insideOf(complex, 1, {}, {}, progress, 0);
  EXPECT_NE(std::find(closed.begin(), closed.end(), 1), closed.end());
  forget(complex, [&](const Vec3d& p) { return p[0] > kMiddle; });
  // No more than every tet and every edge that there may be, no less than a few of each.
  const double tets = static_cast<double>(complex.tets.size());
  EXPECT_EQ(insideOf(complex, 1, {}, {}, progress, 6 * tets * tets), classify(complex, 1));
  try {
    insideOf(complex, 1, {}, {}, progress, 100);
    ADD_FAILURE() << "it goes on";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Limit);
  }
}

TEST(Classify, FollowsTheWindingNumberFromWherever) {
  // An open ball within a closed one, and two shells: integer parts of up to 3.
  const auto outer = ballAt(kCentre, 6.4 * kStep), inner = ballAt(kCentre, 2.6 * kStep);
  TetComplex complex =
      cubeMesh(kCells, kStep, 0.1, [&](const Vec3d& p) { return outer(p) + 2 * inner(p); });
  forget(complex, [&](const Vec3d& p) { return p[2] > kMiddle + 2.5 * kStep && inner(p) == 0; });
  expectAsBruteForce(complex, classifiedSurface(complex), classify(complex, 1));
}

TEST(Classify, MissingFacesCountAsIfTheyWereIn) {
  const auto ball = ballAt(kCentre, 5.2 * kStep);
  TetComplex complex = cubeMesh(kCells, kStep, 0.2, ball);
  const std::vector<std::uint16_t> before = classify(complex, 1);
  // Positions are all that the soup and the mesh have in common.
  LatticeSoup soup;
  const auto last = static_cast<std::uint32_t>(complex.points.size() - 1);
  for (std::uint32_t i = 0; i <= last; ++i)
    soup.points.push_back(complex.at(last - i));
  soup.faces.push_back({0, 1, 2}); // not missing
  std::vector<std::uint32_t> missing;
  for (const auto& face :
       forget(complex, [&](const Vec3d& p) { return p[1] < kMiddle - 2 * kStep; })) {
    missing.push_back(static_cast<std::uint32_t>(soup.faces.size()));
    soup.faces.push_back({last - face[0], last - face[1], last - face[2]});
  }
  ASSERT_GT(missing.size(), 50u);
  EXPECT_EQ(classify(complex, 1, soup, missing), before);
}

TEST(Classify, MissingFacesMayCutThroughTets) {
  TetComplex complex = cubeMesh(kCells, kStep, 0.2, ballAt(kCentre, 5.2 * kStep));
  forget(complex, [&](const Vec3d& p) { return p[0] > kMiddle; });
  // A lid that no tet knows of, far too large.
  LatticeSoup soup;
  const double low = -2 * kStep, high = (kCells + 2) * kStep, x = kMiddle + 1000;
  soup.points = {{x, low, low}, {x, high, low}, {x, high, high}, {x, low, high}};
  soup.faces = {{0, 1, 2}, {0, 2, 3}};
  soup.inputs = {0, 0};
  TriangleMesh surface = classifiedSurface(complex);
  const auto first = static_cast<std::uint32_t>(surface.points.size());
  surface.points.insert(surface.points.end(), soup.points.begin(), soup.points.end());
  for (const auto& face : soup.faces)
    for (const std::uint32_t corner : face)
      surface.triangles.push_back(first + corner);
  expectAsBruteForce(complex, surface, classify(complex, 1, soup, {0, 1}));
}

TEST(Classify, OpenAndClosedInputsTogether) {
  const auto ball = ballAt(kCentre, 5.2 * kStep);
  const auto other = ballAt({kMiddle, kMiddle + 2 * kStep, kMiddle}, 4.2 * kStep);
  TetComplex complex = cubeMesh(kCells, kStep, 0.2, ball);
  forget(complex, [&](const Vec3d& p) { return p[0] > kMiddle + 2 * kStep; });
  const std::vector<std::uint16_t> alone = classify(complex, 1);
  for (TetComplex::Tet& tet : complex.tets)
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      const std::uint32_t next = tet.neighbours[localFace];
      if (next != TetComplex::kOutside)
        tet.chains[localFace] +=
            (other(centreOf(complex, tet)) - other(centreOf(complex, complex.tets[next]))) *
            unitChain(1, 3);
    }
  const std::vector<std::uint16_t> inside = classify(complex, 3);
  for (std::size_t t = 0; t < inside.size(); ++t)
    EXPECT_EQ(inside[t], alone[t] | other(centreOf(complex, complex.tets[t])) << 1);
}

TEST(Classify, SlotsOfTetsThatAreGoneAreOutside) {
  TetComplex complex = cubeMesh(6, kStep, 0, ballAt({3 * kStep, 3 * kStep, 3 * kStep}, 2 * kStep));
  const auto midpoint = static_cast<std::size_t>(6 * (6 * (6 * 3 + 3) + 3));
  complex.tets.push_back(complex.tets[midpoint]);
  complex.tets.back().corners[0] = TetComplex::kNone;
  ASSERT_EQ(classify(complex, 1)[midpoint], 1);
  EXPECT_EQ(classify(complex, 1).back(), 0);
}

} // namespace
} // namespace tetvdb
