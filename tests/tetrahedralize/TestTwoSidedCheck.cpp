// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "TriangleMeshes.h"
#include "tetvdb/surface/TetSurface.h"
#include "tetvdb/tetrahedralize/TwoSidedCheck.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

constexpr double kEpsilon = 0.01;

struct Checked {
  TwoSidedCheck figures;
  std::vector<LostSurface::Point> lost;
  double volumeError = 0;
};

Checked check(const TetMesh& mesh, const std::vector<TriangleMesh>& inputs,
              Boolean boolean = Boolean::Materials, double epsilon = kEpsilon) {
  Progress progress;
  const InputSurface original(inputs, boolean, epsilon, progress);
  const LostSurface lost = original.lost(mesh, progress);
  const InputSurface::Comparison compared = original.compare(mesh, progress);
  return {{compared.outToIn, lost.inToOut, original.owedPoints(), lost.points.size(),
           compared.volume, compared.windingVolume},
          lost.points,
          compared.volumeError};
}

/// The tets of an n^3 grid over the unit cube, each cell in a region; 0: left out.
template <typename Region>
TetMesh grid(int n, const Region& region) {
  const TetMesh whole = meshes::scaled(meshes::kuhnGrid(n, n, n), 1.0 / n);
  TetMesh mesh;
  mesh.points = whole.points;
  for (std::size_t t = 0; t < whole.tetCount(); ++t) {
    Vec3d centre{0, 0, 0};
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        centre[axis] += whole.points[whole.tets[4 * t + k]][axis] / 4;
    const std::int32_t r = region(centre);
    if (r == 0)
      continue;
    mesh.tets.insert(mesh.tets.end(), whole.tets.begin() + static_cast<std::ptrdiff_t>(4 * t),
                     whole.tets.begin() + static_cast<std::ptrdiff_t>(4 * t + 4));
    mesh.regions.push_back(r);
  }
  mesh.cellCount = mesh.tetCount();
  return mesh;
}

TetMesh unitCube() {
  return grid(8, [](const Vec3d&) { return 1; });
}

void expectFaithful(const Checked& found) {
  EXPECT_EQ(found.figures.lostPoints, 0u);
  EXPECT_TRUE(found.lost.empty());
  EXPECT_LT(found.figures.inToOut, kEpsilon);
  EXPECT_LT(found.figures.outToIn, kEpsilon);
  EXPECT_NEAR(found.figures.windingVolume, found.figures.volume, 4 * found.volumeError + 1e-12);
}

// Owed points among those of the whole surface.
double owedShare(const TetMesh& mesh, const std::vector<TriangleMesh>& inputs,
                 const TriangleMesh& allOwed) {
  return double(check(mesh, inputs).figures.owedPoints) /
         double(check(mesh, {allOwed}).figures.owedPoints);
}

TEST(TwoSidedCheck, FindsNothingWrongWithASphere) {
  const TetMesh ball = meshes::ball(10, 1, {5, 5, 5});
  Progress progress;
  const Checked found = check(ball, {tetSurface(ball, progress)});
  expectFaithful(found);
  EXPECT_GT(found.figures.owedPoints, 45000u);
  EXPECT_LT(found.figures.inToOut, 1e-9);
  EXPECT_LT(found.figures.outToIn, 1e-9);
  EXPECT_NEAR(found.figures.volume, meshes::signedVolume(tetSurface(ball, progress)), 1e-9);
  EXPECT_EQ(found.volumeError, 0);
}

TEST(TwoSidedCheck, FindsWhatIsLost) {
  // A block at a corner of the cube is not there.
  const auto isBlock = [](const Vec3d& p) { return p[0] > 0.5 && p[1] > 0.5 && p[2] > 0.75; };
  const TetMesh mesh = grid(8, [&](const Vec3d& p) { return isBlock(p) ? 0 : 1; });
  const Checked found = check(mesh, {meshes::box()});
  // The top's quarter and strips at two sides, all but what is within epsilon of what is left.
  const double side = 0.5 - kEpsilon, height = 0.25 - kEpsilon;
  const double lostArea = side * side + 2 * side * height;
  EXPECT_NEAR(double(found.figures.lostPoints) / double(found.figures.owedPoints), lostArea / 6,
              5e-4);
  ASSERT_EQ(found.lost.size(), found.figures.lostPoints);
  for (const LostSurface::Point& point : found.lost) {
    EXPECT_TRUE(point.at[0] > 0.5 && point.at[1] > 0.5 && point.at[2] > 0.75);
    EXPECT_EQ(point.input, 0u);
    ASSERT_LT(point.triangle, 12u);
  }
  // The cube's corner is nearest to the block's floor.
  EXPECT_NEAR(found.figures.inToOut, 0.25, 0.01);
  // The block's inner corner lies deepest in the cube.
  EXPECT_NEAR(found.figures.outToIn, 0.25, 0.01);
  EXPECT_NEAR(found.figures.volume, 1 - 0.0625, 1e-9);
  EXPECT_NEAR(found.figures.windingVolume, 1, 4 * found.volumeError);
  EXPECT_NEAR(found.volumeError, std::sqrt(0.0625 / 65536), 1e-4);
}

TEST(TwoSidedCheck, FindsALostCorner) {
  // Of the block that is not there the cube's corner alone is farther than epsilon from the rest.
  const double side = 1.0 / 16;
  const TetMesh mesh = grid(16, [&](const Vec3d& p) {
    return p[0] > 1 - side && p[1] > 1 - side && p[2] > 1 - side ? 0 : 1;
  });
  const Checked found = check(mesh, {meshes::box()}, Boolean::Materials, 0.99 * side);
  ASSERT_EQ(found.lost.size(), 1u);
  EXPECT_EQ(found.lost[0].at, (Vec3d{1, 1, 1}));
  EXPECT_NEAR(found.figures.inToOut, side, 1e-9);
  EXPECT_EQ(check(mesh, {meshes::box()}, Boolean::Materials, 1.01 * side).figures.lostPoints, 0u);
}

TEST(TwoSidedCheck, FindsTetsThatStandOut) {
  const Checked found = check(unitCube(), {meshes::box({0, 0, 0}, {1, 1, 0.9})});
  EXPECT_NEAR(found.figures.outToIn, 0.1, 1e-9);
  EXPECT_NEAR(found.figures.inToOut, 0.1, 1e-9);
  EXPECT_NEAR(found.figures.windingVolume, 0.9, 4 * found.volumeError);
  EXPECT_NEAR(found.figures.volume, 1, 1e-12);
}

TEST(TwoSidedCheck, SaysWhichInputAndTriangleIsLost) {
  const TetMesh mesh = grid(8, [](const Vec3d& p) { return p[0] < 0.5 ? 1 : 0; });
  const std::vector<TriangleMesh> inputs{meshes::box({0, 0, 0}, {0.5, 1, 1}),
                                         meshes::box({0.6, 0, 0}, {0.9, 1, 1})};
  const Checked found = check(mesh, inputs);
  ASSERT_GT(found.lost.size(), 100u);
  for (const LostSurface::Point& point : found.lost) {
    ASSERT_EQ(point.input, 1u);
    ASSERT_LT(point.triangle, 12u);
    // On its triangle's plane: a side of the box.
    const TriangleMesh& box = inputs[1];
    std::size_t planes = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bool inPlane = true;
      for (std::size_t k = 0; k < 3; ++k)
        inPlane = inPlane && std::abs(box.points[box.triangles[3 * point.triangle + k]][axis] -
                                      point.at[axis]) < 1e-9;
      planes += inPlane ? 1 : 0;
    }
    EXPECT_EQ(planes, 1u);
  }
}

TEST(TwoSidedCheck, InteriorWallsSheetsAndDoubledShellsAreNotOwed) {
  const TriangleMesh cube = meshes::box();
  const auto unit = [](const Vec3d& p) { return Vec3d{p[0], 0.2 + 0.6 * p[1], p[2] + 0.5}; };
  const TriangleMesh wall = meshes::moved(meshes::sheet(4), [&](const Vec3d& p) {
    return unit({p[1], p[0], 0});
  });
  const TriangleMesh inner = meshes::box({0.2, 0.2, 0.2}, {0.8, 0.8, 0.8});
  const TriangleMesh aside = meshes::moved(meshes::sheet(4), [](const Vec3d& p) {
    return Vec3d{p[0] + 2, p[1], p[2]};
  });
  for (const TriangleMesh& more : {wall, inner, aside}) {
    const Checked found = check(unitCube(), {meshes::joined({cube, more})});
    expectFaithful(found);
    EXPECT_GT(found.figures.owedPoints, 30000u);
  }
  // A cavity is.
  const Checked found = check(unitCube(), {meshes::joined({cube, meshes::flipped(inner)})});
  EXPECT_GT(found.figures.lostPoints, 5000u);
  EXPECT_NEAR(found.figures.windingVolume, 1 - 0.216, 4 * found.volumeError);
}

TEST(TwoSidedCheck, OnlyTheOutsideOfASelfIntersectionIsOwed) {
  // A bar through the cube: 4 * 0.2 * 0.4 of its sides are within, 2 * 0.04 of the cube's in it.
  const TriangleMesh bar = meshes::box({-0.2, 0.4, 0.4}, {1.2, 0.6, 0.6});
  const TetMesh mesh = unitCube();
  const double owedArea = 6 - 2 * 0.04 + 4 * 0.2 * 0.4 + 2 * 0.04;
  const double area = 6 + 4 * 0.2 * 1.4 + 2 * 0.04;
  EXPECT_NEAR(owedShare(mesh, {meshes::joined({meshes::box(), bar})}, meshes::box()),
              owedArea / area, 1e-3);
}

TEST(TwoSidedCheck, WallsThinnerThanHalfAnEpsilonAreNotOwed) {
  const TetMesh mesh = unitCube();
  for (const double thick : {0.4, 0.6}) {
    const TriangleMesh fin = meshes::box({0.2, 0.2, 1.2}, {0.8, 0.8, 1.2 + thick * kEpsilon});
    const Checked found = check(mesh, {meshes::joined({meshes::box(), fin})});
    if (thick < 0.5)
      EXPECT_LT(found.figures.lostPoints, 1000u) << "but its edges"; // of 50 000
    else
      EXPECT_GT(found.figures.lostPoints, 4000u);
  }
}

TEST(TwoSidedCheck, BooleansOweWhatTheyKeep) {
  const TriangleMesh low = meshes::box({0, 0, 0}, {1, 1, 0.5});
  const TriangleMesh high = meshes::box({0, 0, 0.25}, {1, 1, 1});
  const std::vector<TriangleMesh> both{low, high};
  expectFaithful(check(unitCube(), both, Boolean::Union));
  expectFaithful(check(grid(8, [](const Vec3d& p) { return p[2] < 0.25 ? 1 : 0; }), both,
                       Boolean::Difference));
  expectFaithful(check(grid(8, [](const Vec3d& p) { return p[2] > 0.25 && p[2] < 0.5 ? 1 : 0; }),
                       both, Boolean::Intersection));
  // The first owns what both fill.
  expectFaithful(
      check(grid(8, [](const Vec3d& p) { return p[2] < 0.5 ? 1 : 2; }), both, Boolean::Materials));
  // Without regions the surface between them is lost: one of seven unit squares.
  const Checked found = check(unitCube(), both, Boolean::Materials);
  EXPECT_GT(found.figures.lostPoints, 5000u);
  for (const LostSurface::Point& point : found.lost)
    EXPECT_NEAR(point.at[2], 0.5, 1e-12);
  // Nor will what one rule keeps do for another.
  for (const Boolean rule : {Boolean::Difference, Boolean::Intersection})
    EXPECT_GT(check(unitCube(), both, rule).figures.lostPoints, 5000u);
}

TEST(TwoSidedCheck, OutsideTetsAreNoPartOfTheSolid) {
  const TetMesh mesh = grid(8, [](const Vec3d& p) { return p[0] < 0.5 ? 1 : -1; });
  const Checked found = check(mesh, {meshes::box({0, 0, 0}, {0.5, 1, 1})});
  expectFaithful(found);
  EXPECT_NEAR(found.figures.volume, 0.5, 1e-12);
}

TEST(TwoSidedCheck, HolesAreClosedFarFromTheInput) {
  // Without its top the cube's winding number passes one half in the plane where the top was.
  const TriangleMesh cube = meshes::box({0, 0, 0}, {1, 1, 1}, 8);
  const TriangleMesh open = meshes::without(cube, [&](std::size_t face) {
    double minValue = 1;
    for (std::size_t k = 0; k < 3; ++k)
      minValue = std::min(minValue, cube.points[cube.triangles[3 * face + k]][2]);
    return minValue == 1;
  });
  const Checked found = check(unitCube(), {open});
  EXPECT_EQ(found.figures.lostPoints, 0u);
  EXPECT_LT(found.figures.outToIn, 1e-9);
  EXPECT_GT(found.figures.owedPoints, 45000u);
  // What the winding number says by brute force, where it and the cube differ: under the top.
  meshes::Random random(1);
  constexpr int kPoints = 4000;
  int inside = 0;
  for (int i = 0; i < kPoints; ++i)
    inside += meshes::windingNumberAt(open, {random.unit(), random.unit(), random.unit()}) > 0.5;
  EXPECT_NEAR(found.figures.windingVolume, double(inside) / kPoints,
              4 * found.volumeError + 2 / std::sqrt(double(kPoints)) * 0.5);
  // The closed cube's tets are judged everywhere.
  EXPECT_NEAR(check(unitCube(), {meshes::box({0, 0, 0}, {1, 1, 0.5})}).figures.outToIn, 0.5, 1e-2);
}

TEST(TwoSidedCheck, WhatIsBesideABoundaryEdgeIsNotOwed) {
  // An open box without its upper part: lost are the walls there, as far as it is clear that they
  // part inside from outside.
  const TriangleMesh cube = meshes::box({0, 0, 0}, {1, 1, 1}, 8);
  const TriangleMesh open = meshes::without(cube, [&](std::size_t face) {
    double minValue = 1;
    for (std::size_t k = 0; k < 3; ++k)
      minValue = std::min(minValue, cube.points[cube.triangles[3 * face + k]][2]);
    return minValue == 1;
  });
  constexpr double kHeight = 0.5;
  const TetMesh mesh = grid(8, [](const Vec3d& p) { return p[2] < kHeight ? 1 : 0; });
  const Checked found = check(mesh, {open});
  // By brute force, at points of the wall x = 0: how many are owed, and the nearest to 0.5 of all.
  const auto doubt = [&](double y, double z) {
    double minValue = 1;
    for (const double x : {-kEpsilon / 2, kEpsilon / 2})
      minValue = std::min(minValue, std::abs(meshes::windingNumberAt(open, {x, y, z}) - 0.5));
    return minValue;
  };
  meshes::Random random(1);
  constexpr int kPoints = 2000;
  int isOwed = 0, isLost = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double y = random.unit(), z = random.unit();
    if (doubt(y, z) < 0.2)
      continue;
    ++isOwed;
    isLost += z > kHeight + kEpsilon;
  }
  EXPECT_LT(isOwed, 0.99 * kPoints);
  EXPECT_GT(isLost, 0.1 * kPoints);
  EXPECT_NEAR(double(found.figures.lostPoints) / double(found.figures.owedPoints),
              4.0 * isLost / (4.0 * isOwed + kPoints), 0.02);
  std::size_t onWall = 0;
  for (const LostSurface::Point& point : found.lost) {
    if (point.at[0] != 0 || ++onWall % 20 != 0 || point.at[1] == 0 || point.at[1] == 1)
      continue;
    EXPECT_GT(doubt(point.at[1], point.at[2]), 0.2 - 0.01);
  }
  EXPECT_GT(onWall, 400u);
}

TEST(TwoSidedCheck, InputsAreComparedWithOneMeshAfterAnother) {
  // What one mesh loses does not change what is found of the next.
  const std::vector<TriangleMesh> inputs{meshes::box()};
  Progress progress;
  const InputSurface original(inputs, Boolean::Materials, kEpsilon, progress);
  const TetMesh half = grid(8, [](const Vec3d& p) { return p[0] < 0.5 ? 1 : 0; });
  const std::size_t owed = original.owedPoints();
  const LostSurface lost = original.lost(half, progress);
  EXPECT_GT(lost.points.size(), owed / 3);
  for (const LostSurface::Point& point : lost.points)
    EXPECT_GT(point.at[0], 0.5 + kEpsilon);
  EXPECT_NEAR(lost.inToOut, 0.5, 1e-12);
  EXPECT_NEAR(original.compare(half, progress).volume, 0.5, 1e-12);
  EXPECT_TRUE(original.lost(unitCube(), progress).points.empty());
  EXPECT_NEAR(original.compare(unitCube(), progress).windingVolume, 1, 1e-12);
  EXPECT_EQ(original.owedPoints(), owed);
  EXPECT_EQ(original.lost(half, progress).boundaryFaces, 8u * 8 * 2 * 2 + 4 * 8 * 4 * 2);
}

TEST(TwoSidedCheck, IsTheSameWhereTheInputIsSampledBesideOtherWork) {
  const std::vector<TriangleMesh> inputs{meshes::box()};
  const TetMesh half = grid(8, [](const Vec3d& p) { return p[0] < 0.5 ? 1 : 0; });
  Progress progress;
  const InputSurface alone(inputs, Boolean::Materials, kEpsilon, progress);
  InputSurfaceTask task(inputs, Boolean::Materials, kEpsilon, progress);
  task.begin();
  task.begin();
  const InputSurface& beside = task.get();
  EXPECT_EQ(&task.get(), &beside);
  EXPECT_EQ(beside.owedPoints(), alone.owedPoints());
  EXPECT_EQ(beside.lost(half, progress).points.size(), alone.lost(half, progress).points.size());
}

TEST(TwoSidedCheck, ThrowsWhatSamplingTheInputThrew) {
  const std::vector<TriangleMesh> inputs{meshes::box()};
  Progress progress;
  progress.cancel();
  InputSurfaceTask task(inputs, Boolean::Materials, kEpsilon, progress);
  InputSurfaceTask left(inputs, Boolean::Materials, kEpsilon, progress); // nobody asks for it
  task.begin();
  left.begin();
  try {
    task.get();
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Cancelled);
  }
}

TEST(TwoSidedCheck, IsTheSameWhateverItsPlace) {
  const TetMesh mesh = grid(8, [](const Vec3d& p) { return p[0] + p[1] < 1 ? 1 : 0; });
  const TriangleMesh cube = meshes::box();
  const double scale = 1024, shift = 4096; // nothing is rounded
  const TriangleMesh farCube = meshes::moved(cube, [&](const Vec3d& p) {
    return Vec3d{p[0] * scale + shift, p[1] * scale + shift, p[2] * scale + shift};
  });
  const Checked here = check(mesh, {cube});
  const Checked there = check(meshes::scaled(mesh, scale, {shift, shift, shift}), {farCube},
                              Boolean::Materials, kEpsilon * scale);
  EXPECT_NEAR(double(there.figures.lostPoints), double(here.figures.lostPoints), 5);
  EXPECT_NEAR(there.figures.windingVolume / (scale * scale * scale), here.figures.windingVolume,
              1e-3);
}

} // namespace
} // namespace tetvdb
