// SPDX-License-Identifier: Apache-2.0
//
// What can be asked of the mesher: lengths, materials and Booleans, quality, an
// end before the end.
#include "tetrahedralize/MadeTets.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <set>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

using meshes::box;
using meshes::joined;
using meshes::signedVolume;
using meshes::sphere;

TetrahedralizeOptions withEpsilon(double epsilon) {
  TetrahedralizeOptions options;
  options.epsilon = epsilon;
  return options;
}

double volumeOf(const TetMesh& mesh, std::int32_t region) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    if (mesh.regions[t] != region)
      continue;
    const Vec3d& a = mesh.points[mesh.tets[4 * t]];
    const auto to = [&](std::size_t k) { return minus(mesh.points[mesh.tets[4 * t + k]], a); };
    sum += dot(cross(to(1), to(2)), to(3)) / 6;
  }
  return sum;
}

// Equal bytes are equal meshes: no number is -0 or NaN in one of them alone.
std::string bytesOf(const Tetrahedralization& made) {
  const auto bytes = [](const auto& values) {
    return std::string(reinterpret_cast<const char*>(values.data()),
                       values.size() * sizeof(values[0]));
  };
  return bytes(made.mesh.points) + bytes(made.mesh.tets) + bytes(made.mesh.regions);
}

TEST(TetrahedralizeOptions, LengthsThatMakeNoSense) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double wrong : {-1.0, -1e-300, kNan, kInfinity, 1.0, 1e300, 1e-300, 1e-12}) {
    const MadeTets made = madeTets({box()}, withEpsilon(wrong));
    EXPECT_EQ(made.error, Status::Usage) << wrong << made.message;
  }
  for (const double wrong : {-1.0, kNan, kInfinity}) {
    TetrahedralizeOptions options;
    options.edgeLength = wrong;
    EXPECT_EQ(madeTets({box()}, options).error, Status::Usage) << wrong;
  }
}

TEST(TetrahedralizeOptions, EpsilonFromTheDiagonal) {
  const MadeTets made = expectSolid(box({0, 0, 0}, {1, 2, 2}), 4);
  EXPECT_NEAR(made.result.epsilonAsked, 3e-3, 1e-15);
  EXPECT_NEAR(made.result.edgeLength, 0.15, 1e-15);
}

std::size_t facesOfOneTet(const TetMesh& mesh) {
  std::map<std::set<std::uint32_t>, int> tets;
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    std::set<std::uint32_t> face;
    for (std::size_t k = 0; k < 4; ++k)
      if (k != i % 4)
        face.insert(mesh.tets[i - i % 4 + k]);
    ++tets[face];
  }
  return static_cast<std::size_t>(
      std::count_if(tets.begin(), tets.end(), [](const auto& face) { return face.second == 1; }));
}

TEST(TetrahedralizeOptions, SmallAndLargeEpsilon) {
  const TriangleMesh mesh = sphere({0, 0, 0}, 1, 10);
  std::size_t finest = 0;
  for (const double epsilon : {1e-6, 1e-4, 1e-2, 0.1}) {
    const MadeTets made = expectSolid(mesh, signedVolume(mesh), withEpsilon(epsilon));
    EXPECT_EQ(made.result.boundaryFaces, facesOfOneTet(made.result.mesh)) << epsilon;
    if (epsilon == 1e-6) {
      finest = made.result.boundaryFaces;
    } else if (epsilon == 0.1) {
      EXPECT_LT(2 * made.result.boundaryFaces, finest);
    }
  }
}

TEST(TetrahedralizeOptions, InputsThatAreNone) {
  EXPECT_EQ(madeTets({}, {}).error, Status::Usage);
  EXPECT_EQ(madeTets({TriangleMesh{}}, {}).error, Status::Invalid);
  EXPECT_EQ(madeTets(std::vector<TriangleMesh>(11, box()), {}).error, Status::Usage);
  // All in one point, all on one line.
  for (const double length : {0.0, 1.0}) {
    TriangleMesh mesh = sphere();
    for (Vec3d& p : mesh.points)
      p = {length * p[0], length * p[0], 2 * length * p[0]};
    EXPECT_EQ(madeTets({mesh}, {}).error, Status::Invalid);
  }
  TetrahedralizeOptions little;
  little.maxMemory = 1000;
  EXPECT_EQ(madeTets({box()}, little).error, Status::Limit);
}

TEST(TetrahedralizeOptions, TheSameTetsForAnyNumberOfThreadsAndEveryTime) {
  const std::vector<TriangleMesh> inputs = {
      joined({sphere({0, 0, 0}, 1, 16), meshes::torus()}),
      meshes::without(sphere({0.5, 0.5, 0}, 1, 12), [](std::size_t f) { return f < 20; })};
  for (const double stop : {0.0, 30.0}) {
    TetrahedralizeOptions options;
    options.stopEnergy = stop;
    options.maxPasses = 4;
    std::string first;
    for (const int threads : {1, 1, 2, 8}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(threads));
      tbb::task_arena arena(threads);
      const std::string bytes =
          arena.execute([&] { return bytesOf(madeTets(inputs, options).result); });
      EXPECT_FALSE(bytes.empty());
      if (first.empty())
        first = bytes;
      EXPECT_TRUE(bytes == first) << threads << " threads, stop energy " << stop;
    }
  }
}

TEST(TetrahedralizeOptions, BooleansOfTwo) {
  const std::vector<TriangleMesh> inputs = {box({0, 0, 0}, {1, 1, 1}, 2),
                                            box({0.5, 0.25, 0.125}, {1.5, 1.25, 1.125}, 3)};
  const double common = 0.5 * 0.75 * 0.875, slack = 12 * 3e-3;
  TetrahedralizeOptions options;
  const auto made = [&](Boolean rule) {
    options.boolean = rule;
    MadeTets result = madeTets(inputs, options);
    EXPECT_FALSE(result.error) << result.message;
    EXPECT_TRUE(result.report.warnings.empty());
    return result.result.mesh;
  };
  const TetMesh materials = made(Boolean::Materials);
  EXPECT_NEAR(volumeOf(materials, 1), 1, slack);
  EXPECT_NEAR(volumeOf(materials, 2), 1 - common, slack);
  EXPECT_NEAR(volumeOf(made(Boolean::Union), 1), 2 - common, slack);
  EXPECT_NEAR(volumeOf(made(Boolean::Difference), 1), 1 - common, slack);
  EXPECT_NEAR(volumeOf(made(Boolean::Intersection), 1), common, slack);
}

TEST(TetrahedralizeOptions, BooleansOfThree) {
  const std::vector<TriangleMesh> inputs = {sphere({0, 0, 0}, 1, 8), box({0, 0, 0}, {2, 2, 2}, 2),
                                            sphere({0.5, 0, 0}, 0.9, 8)};
  TetrahedralizeOptions options;
  std::map<Boolean, TetMesh> made;
  for (const Boolean rule :
       {Boolean::Materials, Boolean::Union, Boolean::Difference, Boolean::Intersection}) {
    options.boolean = rule;
    MadeTets result = madeTets(inputs, options);
    EXPECT_FALSE(result.error) << result.message;
    made[rule] = result.result.mesh;
  }
  // Against points at random.
  meshes::Random random(1);
  constexpr int kPoints = 4000;
  std::map<std::pair<Boolean, int>, double> expected;
  const Vec3d low{-1, -1, -1}, size{3, 3, 3};
  for (int i = 0; i < kPoints; ++i) {
    Vec3d p{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] = low[axis] + size[axis] * random.unit();
    std::array<bool, 3> in{};
    for (std::size_t k = 0; k < 3; ++k)
      in[k] = meshes::windingNumberAt(inputs[k], p) > 0.5;
    const double share = 27.0 / kPoints;
    if (in[0] || in[1] || in[2]) {
      expected[{Boolean::Materials, in[0] ? 1 : in[1] ? 2 : 3}] += share;
      expected[{Boolean::Union, 1}] += share;
    }
    if (in[0] && !in[1] && !in[2])
      expected[{Boolean::Difference, 1}] += share;
    if (in[0] && in[1] && in[2])
      expected[{Boolean::Intersection, 1}] += share;
  }
  EXPECT_EQ(expected.size(), 6u);
  for (const auto& [which, volume] : expected) // four standard deviations
    EXPECT_NEAR(volumeOf(made[which.first], which.second), volume,
                4 * std::sqrt(27.0 / kPoints * volume) + 0.05);
  // Materials fill what the union does.
  double sum = 0;
  for (const std::int32_t region : {1, 2, 3})
    sum += volumeOf(made[Boolean::Materials], region);
  EXPECT_NEAR(sum, volumeOf(made[Boolean::Union], 1), 1e-9);
}

TEST(TetrahedralizeOptions, MaterialsThatShareAWall) {
  const std::vector<TriangleMesh> inputs = {
      box({0, 0, 0}, {1, 1, 1}, 2), box({1, 0, 0}, {2, 1, 1}, 2), sphere({1, 0.5, 0.5}, 0.3)};
  const MadeTets made = madeTets(inputs, {});
  ASSERT_FALSE(made.error) << made.message;
  EXPECT_NEAR(volumeOf(made.result.mesh, 1), 1, 0.02);
  EXPECT_NEAR(volumeOf(made.result.mesh, 2), 1, 0.02);
  // Owned by the earlier ones: nothing but what epsilon lets through.
  EXPECT_LT(volumeOf(made.result.mesh, 3), 0.02);
  EXPECT_NEAR(volumeOf(made.result.mesh, 1) + volumeOf(made.result.mesh, 2) +
                  volumeOf(made.result.mesh, 3),
              2, 0.03);
}

TEST(TetrahedralizeOptions, BooleansThatLeaveNothing) {
  TetrahedralizeOptions options;
  options.boolean = Boolean::Intersection;
  EXPECT_EQ(madeTets({box(), box({2, 0, 0}, {3, 1, 1})}, options).error, Status::Invalid);
  options.boolean = Boolean::Difference;
  EXPECT_EQ(madeTets({box(), box({-1, -1, -1}, {2, 2, 2})}, options).error, Status::Invalid);
}

TEST(TetrahedralizeOptions, WhatIsOutsideFillsABox) {
  TetrahedralizeOptions options;
  options.keepOutside = true;
  const TriangleMesh mesh = sphere({0, 0, 0}, 1, 8);
  const MadeTets made = madeTets({mesh}, options);
  ASSERT_FALSE(made.error) << made.message;
  expectNoFaults(checkOf(made));
  const TetMesh& tets = made.result.mesh;
  EXPECT_EQ(std::set<std::int32_t>(tets.regions.begin(), tets.regions.end()),
            (std::set<std::int32_t>{-1, 1}));
  Vec3d low{9, 9, 9}, high{-9, -9, -9};
  for (const Vec3d& p : tets.points)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  const double whole = (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
  EXPECT_NEAR(volumeOf(tets, 1) + volumeOf(tets, -1), whole, 1e-9 * whole);
  EXPECT_LT(low[0], -1);
  EXPECT_GT(high[2], 1);
}

TEST(TetrahedralizeOptions, StopEnergyIsReached) {
  for (const TriangleMesh& mesh :
       {box(), sphere({0, 0, 0}, 1, 8), meshes::torus(), meshes::cylinder(1, 2, 24)}) {
    TetrahedralizeOptions options;
    options.stopEnergy = 10;
    const MadeTets made = expectSolid(mesh, signedVolume(mesh), options);
    EXPECT_LE(made.result.worstEnergy, 10);
    EXPECT_LE(checkOf(made).worstEnergy, 10 * (1 + 1e-6));
  }
}

// AMIPS energy by the map from the regular tet, |J|^2 / det(J)^(2/3).
double amips(const TetMesh& mesh, std::size_t tet) {
  const auto edge = [&](std::size_t k) {
    return minus(mesh.points[mesh.tets[4 * tet + k]], mesh.points[mesh.tets[4 * tet]]);
  };
  const Vec3d x = edge(1);
  const Vec3d y = times(minus(edge(2), times(x, 0.5)), 2 / std::sqrt(3.0));
  const Vec3d z = times(minus(edge(3), times(plus(edge(1), edge(2)), 1.0 / 3)), std::sqrt(1.5));
  return (dot(x, x) + dot(y, y) + dot(z, z)) / std::cbrt(std::pow(dot(cross(x, y), z), 2));
}

// A wedge whose faces meet at one degree has tets of that angle however small they are.
TEST(TetrahedralizeOptions, EndsWhereTheInputForbidsTheStopEnergy) {
  const double thin = std::tan(3.14159265358979 / 180);
  TriangleMesh wedge = box();
  for (auto& p : wedge.points)
    p[2] *= thin * p[0];
  TetrahedralizeOptions options = withEpsilon(1e-4);
  options.stopEnergy = 10;
  const MadeTets made = madeTets({wedge}, options);
  ASSERT_FALSE(made.error) << made.message;
  EXPECT_LT(made.result.passes, options.maxPasses);
  const TetMesh& mesh = made.result.mesh;
  std::size_t above = 0;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t)
    above += amips(mesh, t) > 10.01 ? 1 : 0;
  ASSERT_GT(above, 0u);
  EXPECT_EQ(made.result.badTets.size(), above);
  const BadTet& worst = made.result.badTets.front();
  EXPECT_EQ(worst.energy, made.result.worstEnergy);
  EXPECT_NEAR(amips(mesh, worst.tet), worst.energy, 1e-6 * worst.energy);
  EXPECT_LT(worst.centre[0], 0.2); // at the sharp edge
}

// The callback cancels when that stage begins; nothing goes on for long after.
// Also where a hole was refined after improvement.
TEST(TetrahedralizeOptions, EnergiesAreThoseOfTheTetsMade) {
  TriangleMesh open = box({0, 0, 0}, {1, 1, 1}, 3);
  open.triangles.resize(open.triangles.size() - 3);
  for (const TriangleMesh& mesh : {sphere({0, 0, 0}, 1, 8), open})
    for (const double stop : {0.0, 10.0}) {
      TetrahedralizeOptions options;
      options.stopEnergy = stop;
      const MadeTets made = madeTets({mesh}, options);
      ASSERT_FALSE(made.error) << made.message;
      const TetMeshCheck check = checkOf(made);
      EXPECT_NEAR(made.result.worstEnergy, check.worstEnergy, 1e-6 * check.worstEnergy);
      EXPECT_NEAR(made.result.meanEnergy, check.meanEnergy, 1e-6 * check.meanEnergy);
    }
}

// Walls inside of what is kept need not be: with quality as without, Booleans are what they are.
TEST(TetrahedralizeOptions, StopEnergyWithWallsInside) {
  const TriangleMesh a = box(), b = box({0.5, 0.25, 0.125}, {1.5, 1.25, 1.125});
  const double both = 0.5 * 0.75 * 0.875;
  TetrahedralizeOptions options = withEpsilon(2e-3);
  options.stopEnergy = 10;
  options.edgeLength = 0.2;
  const auto expect = [&](const std::vector<TriangleMesh>& inputs, Boolean rule, double first,
                          double second) {
    options.boolean = rule;
    const MadeTets made = madeTets(inputs, options);
    ASSERT_FALSE(made.error) << made.message;
    EXPECT_LE(made.result.worstEnergy, 10 * (1 + 1e-6));
    EXPECT_EQ(made.result.check.lostPoints, 0u);
    EXPECT_NEAR(volumeOf(made.result.mesh, 1), first, 0.02);
    EXPECT_NEAR(volumeOf(made.result.mesh, 2), second, 0.02);
  };
  expect({joined({a, b})}, Boolean::Materials, 2 - both, 0);
  expect({a, b}, Boolean::Materials, 1, 1 - both);
  expect({a, b}, Boolean::Union, 2 - both, 0);
  expect({a, b}, Boolean::Difference, 1 - both, 0);
  expect({a, b}, Boolean::Intersection, both, 0);
}

TEST(TetrahedralizeOptions, CancelledAtEachStage) {
  TriangleMesh mesh = sphere({0, 0, 0}, 1, 20);
  Progress cleaning;
  cleanTriangles(mesh, {}, cleaning);
  TetrahedralizeOptions options;
  options.stopEnergy = 10;
  std::vector<std::string> stages;
  {
    Progress progress;
    Report report;
    progress.onReport([&](std::string_view stage, double) {
      if (stages.empty() || stages.back() != stage)
        stages.emplace_back(stage);
    });
    (void)tetrahedralize({mesh}, options, report, progress);
  }
  EXPECT_GE(stages.size(), 8u);
  for (const std::string& at : stages) {
    Progress progress;
    Report report;
    std::set<std::string> later;
    progress.onReport([&](std::string_view stage, double) {
      if (progress.cancelled() && stage != at)
        later.emplace(stage);
      if (stage == at)
        progress.cancel();
    });
    try {
      (void)tetrahedralize({mesh}, options, report, progress);
      ADD_FAILURE() << "cancelled in " << at << ", and made";
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Cancelled) << at;
    }
    // Stages of a moment do not look.
    EXPECT_LE(later.size(), 1u) << "cancelled in " << at << ", went on to " << *later.begin();
    EXPECT_FALSE(report.partial);
  }
}

TEST(TetrahedralizeOptions, PastTheDeadline) {
  Progress progress;
  Report report;
  progress.setDeadline(Progress::Clock::now());
  try {
    (void)tetrahedralize({sphere()}, {}, report, progress);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Cancelled);
  }
}

} // namespace
} // namespace tetvdb
