// SPDX-License-Identifier: Apache-2.0
#include "TestScale.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/surface/SurfaceDefects.h"

#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

using namespace meshes;

SurfaceDefects defectsOf(const TriangleMesh& mesh, const DefectOptions& options = {}) {
  Progress progress;
  return surfaceDefects(mesh, options, progress);
}

// --- Measures and topology.

TEST(SurfaceDefects, CleanSolids) {
  struct Case {
    TriangleMesh mesh;
    std::int64_t genus;
    double volume, area;
  };
  for (const auto& [mesh, genus, volume, area] :
       {Case{box({1, 2, 3}, {3, 5, 7}, 4), 0, 24, 52},
        Case{sphere({5, 5, 5}, 2, 100), 0, 32 * kPi / 3, 16 * kPi},
        Case{torus(1, 0.4, 300, 200), 1, 2 * kPi * kPi * 0.16, 4 * kPi * kPi * 0.4},
        Case{joined({torus(1, 0.4, 300, 200), moved(torus(1, 0.4, 300, 200),
                                                    [](const Vec3d& p) {
                                                      return Vec3d{p[0] + 5, p[1], p[2]};
                                                    })}),
             2, 4 * kPi * kPi * 0.16, 8 * kPi * kPi * 0.4}}) {
    for (const TriangleMesh& given : {mesh, unwelded(mesh)}) {
      const SurfaceDefects defects = defectsOf(given);
      EXPECT_TRUE(defects.watertight);
      EXPECT_TRUE(defects.orientable);
      ASSERT_TRUE(defects.genus.has_value());
      EXPECT_EQ(*defects.genus, genus);
      EXPECT_EQ(defects.components, genus == 2 ? 2u : 1u);
      EXPECT_EQ(defects.vertices, given.points.size());
      EXPECT_EQ(defects.weldedVertices, mesh.points.size());
      EXPECT_EQ(defects.duplicateVertices, given.points.size() - mesh.points.size());
      EXPECT_EQ(defects.degenerateFaces + defects.sliverFaces + defects.duplicateFaces +
                    defects.boundaryEdges + defects.nonManifoldEdges + defects.misorientedEdges +
                    defects.nonManifoldVertices + defects.holes + defects.selfIntersections +
                    defects.unreferencedVertices,
                0u);
      EXPECT_NEAR(defects.volume, volume, 1e-3 * volume);
      EXPECT_NEAR(defects.area, area, 1e-3 * area);
      EXPECT_EQ(verdict(defects), "watertight");
    }
  }
}

TEST(SurfaceDefects, BoxOfTheFacesAndVerticesWithoutFaces) {
  TriangleMesh mesh = box({1, 2, 3}, {3, 5, 7});
  mesh.points.push_back({100, 100, 100});
  mesh.points.push_back({1, 2, 3});
  const SurfaceDefects defects = defectsOf(mesh);
  EXPECT_EQ(defects.boxMin, (Vec3d{1, 2, 3}));
  EXPECT_EQ(defects.boxMax, (Vec3d{3, 5, 7}));
  EXPECT_EQ(defects.unreferencedVertices, 2u);
  EXPECT_EQ(defects.duplicateVertices, 1u);
  EXPECT_EQ(defects.weldedVertices, 8u);
}

TEST(SurfaceDefects, HolesAreLoopsOfOpenEdges) {
  const TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1}, 6);
  // One triangle; a square; all six sides of a box of one square each have 2 faces.
  EXPECT_EQ(defectsOf(without(mesh, [](std::size_t f) { return f == 14; })).boundaryEdges, 3u);
  const SurfaceDefects square =
      defectsOf(without(mesh, [](std::size_t f) { return f == 28 || f == 29 || f == 200; }));
  EXPECT_EQ(square.boundaryEdges, 7u);
  EXPECT_EQ(square.holes, 2u);
  EXPECT_FALSE(square.watertight);
  EXPECT_FALSE(square.genus.has_value());
  EXPECT_EQ(verdict(square),
            "not watertight: 7 open edges in 2 holes; the solid is closed by winding number");
  EXPECT_EQ(defectsOf(cylinder(1, 1, 20, false)).holes, 2u);
  EXPECT_EQ(defectsOf(sheet()).holes, 1u);
  EXPECT_EQ(defectsOf(moebius()).holes, 1u);
}

// Around the point where they touch each fan of faces leads from one hole boundary to the other.
TEST(SurfaceDefects, HolesThatTouchInAPointAreOneLoop) {
  const TriangleMesh mesh = sheet(8);
  const auto square = [&](std::size_t i, std::size_t j) { return 2 * (8 * i + j); };
  const SurfaceDefects defects = defectsOf(without(
      mesh, [&](std::size_t f) { return f / 2 * 2 == square(3, 3) || f / 2 * 2 == square(4, 4); }));
  EXPECT_EQ(defects.nonManifoldVertices, 1u);
  EXPECT_EQ(defects.holes, 2u); // with the sheet's boundary
}

TEST(SurfaceDefects, NonManifoldEdgesAndVertices) {
  const SurfaceDefects edge = defectsOf(unwelded(joined({box(), box({1, 1, 0}, {2, 2, 1})})));
  EXPECT_EQ(edge.nonManifoldEdges, 1u);
  EXPECT_EQ(edge.components, 1u);
  EXPECT_EQ(edge.nonManifoldVertices, 0u);
  EXPECT_TRUE(edge.watertight);
  EXPECT_FALSE(edge.genus.has_value());
  EXPECT_EQ(edge.selfIntersections, 0u);
  const SurfaceDefects tips = defectsOf(unwelded(joined({box(), box({1, 1, 1}, {2, 2, 2})})));
  EXPECT_EQ(tips.nonManifoldEdges, 0u);
  EXPECT_EQ(tips.nonManifoldVertices, 1u);
  EXPECT_EQ(tips.components, 2u);
  EXPECT_TRUE(tips.watertight);
  EXPECT_FALSE(tips.genus.has_value());
}

TEST(SurfaceDefects, FlippedFaces) {
  TriangleMesh mesh = box({0, 0, 0}, {1, 1, 1}, 3);
  flipFace(mesh, 20);
  const SurfaceDefects defects = defectsOf(mesh);
  EXPECT_EQ(defects.misorientedEdges, 3u);
  EXPECT_TRUE(defects.orientable);
  EXPECT_FALSE(defects.watertight);
  EXPECT_EQ(defects.boundaryEdges, 0u);
  EXPECT_EQ(verdict(defects), "closed, but with flipped faces: 3 edges between opposite faces; "
                              "faces are reversed when it is voxelized");
  EXPECT_FALSE(defectsOf(moebius()).orientable);
  const SurfaceDefects insideOut = defectsOf(flipped(torus()));
  EXPECT_TRUE(insideOut.watertight);
  EXPECT_LT(insideOut.volume, 0);
  EXPECT_EQ(verdict(insideOut), "watertight, but inside out; it is reversed when it is voxelized");
}

// --- Faces by themselves.

TEST(SurfaceDefects, DegenerateFacesAndSlivers) {
  TriangleMesh mesh;
  const auto add = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), {a, b, c});
    addTriangle(mesh, first, first + 1, first + 2);
  };
  add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(defectsOf(mesh).degenerateFaces, 0u);
  add({0, 0, 5}, {0, 0, 5}, {0, 1, 5});
  add({0, 0, 6}, {0.1, 0.1, 6.1}, {0.2, 0.2, 6.2}); // not collinear: doubles are not decimals
  add({0, 0, 7}, {1, 2, 8}, {2, 4, 9});
  const SurfaceDefects defects = defectsOf(mesh);
  EXPECT_EQ(defects.degenerateFaces, 2u);
  EXPECT_EQ(defects.sliverFaces, 1u);
  EXPECT_EQ(defects.unreferencedVertices, 0u);
  const auto sliversOf = [&](const Vec3d& apex) {
    mesh = {};
    add({0, 0, 0}, {1, 0, 0}, apex);
    return defectsOf(mesh).sliverFaces;
  };
  const double degree = kPi / 180;
  EXPECT_EQ(sliversOf({1, std::tan(1.01 * degree), 0}), 0u);
  EXPECT_EQ(sliversOf({1, std::tan(0.99 * degree), 0}), 1u);
  EXPECT_EQ(sliversOf({0.5, 0.5 * std::tan(1.01 * degree), 0}), 0u); // 177.98 degrees at the apex
  EXPECT_EQ(sliversOf({0.5, 0.5 * std::tan(0.49 * degree), 0}), 1u); // 179.02
  EXPECT_EQ(sliversOf({0.5, 1e-12, 0}), 1u);
}

TEST(SurfaceDefects, DuplicateFaces) {
  const TriangleMesh mesh = torus();
  const SurfaceDefects thrice = defectsOf(joined({mesh, flipped(mesh), mesh}));
  EXPECT_EQ(thrice.duplicateFaces, 2 * mesh.triangleCount());
  EXPECT_EQ(thrice.selfIntersections, 0u);
  const SurfaceDefects cancelled = defectsOf(joined({mesh, flipped(mesh)}));
  EXPECT_TRUE(cancelled.watertight);
  EXPECT_EQ(verdict(cancelled), "watertight, but every face is duplicated; one of each is kept");
}

// --- Self-intersections.

std::size_t intersectionsOf(const TriangleMesh& mesh) {
  return defectsOf(mesh).selfIntersections;
}

TEST(SurfaceDefects, PairsThatMeet) {
  const TriangleMesh face = without(sheet(1), [](std::size_t f) { return f == 1; }); // y <= x
  const auto with = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    TriangleMesh other;
    other.points = {a, b, c};
    addTriangle(other, 0, 1, 2);
    return intersectionsOf(joined({face, other}));
  };
  EXPECT_EQ(with({0.5, 0.2, -1}, {0.6, 0.2, 1}, {0.5, 0.3, 1}), 1u);     // through
  EXPECT_EQ(with({0.5, 0.2, 0}, {0.6, 0.2, 1}, {0.5, 0.3, 1}), 1u);      // a tip on it
  EXPECT_EQ(with({0.5, 0, 0}, {0.6, -1, 1}, {0.5, -1, 1}), 1u);          // a tip on its edge
  EXPECT_EQ(with({0.2, 0, 0}, {0.8, 0, 0}, {0.5, -1, 0}), 1u);           // a T-junction
  EXPECT_EQ(with({0.4, 0.1, 0}, {0.6, 0.1, 0}, {0.5, 0.2, 0}), 1u);      // within its plane
  EXPECT_EQ(with({0.5, 0.2, 1e-300}, {0.6, 0.2, 1}, {0.5, 0.3, 1}), 0u); // hardly above
  EXPECT_EQ(with({0, 0, 0}, {1, 0, 0}, {0.5, -1, 0}), 0u);               // an edge in common
  EXPECT_EQ(with({0, 0, 0}, {1, 0, 0}, {0.9, 0.1, 0}), 1u);              // and folded onto it
  EXPECT_EQ(with({0, 0, 0}, {1, 0, 0}, {0.9, 0.1, 1e-9}), 0u);           // nearly
  EXPECT_EQ(with({0, 0, 0}, {-1, 0, 0}, {-1, -1, 0}), 0u);               // a point in common
  EXPECT_EQ(with({0, 0, 0}, {0.9, 0.5, 1}, {0.9, 0.5, -1}), 1u);         // and through
  EXPECT_EQ(with({0, 0, 0}, {2, 0, 0}, {2, -1, 0}), 1u);                 // and along its edge
  EXPECT_EQ(with({0, 0, 0}, {1, 0, 0}, {1, 1, 0}), 0u);                  // equal: a duplicate
  EXPECT_EQ(with({0.5, 0.2, 0}, {0.5, 0.2, 1}, {0.5, 0.2, 2}), 0u);      // without area
}

TEST(SurfaceDefects, OverlappingBoxes) {
  const SurfaceDefects defects = defectsOf(joined({box(), box({0.5, 0.5, 0.5}, {1.5, 1.5, 1.5})}));
  EXPECT_GE(defects.selfIntersections, 6u);
  EXPECT_LE(defects.selfIntersections, 36u);
  EXPECT_TRUE(defects.watertight);
  EXPECT_NE(verdict(defects).find("watertight, but self-intersecting"), std::string::npos);
  // Facets 1e-9 apart do not meet, facets in one plane do.
  EXPECT_EQ(intersectionsOf(joined({box(), box({1 + 1e-9, 0.25, 0.25}, {2, 0.75, 0.75})})), 0u);
  EXPECT_GT(intersectionsOf(joined({box(), box({1, 0.25, 0.25}, {2, 0.75, 0.75})})), 0u);
}

TEST(SurfaceDefects, CountStopsAtTheLimit) {
  TriangleMesh mesh;
  Random random(3);
  for (int i = 0; i < 20; ++i)
    append(mesh, sphere({random.unit(), random.unit(), random.unit()}, 1, 8));
  const SurfaceDefects all = defectsOf(mesh);
  ASSERT_TRUE(all.selfIntersectionsComplete);
  ASSERT_GT(all.selfIntersections, 1000u);
  DefectOptions options;
  for (const auto& [limit, counted] :
       {std::pair(all.selfIntersections, all.selfIntersections),
        std::pair(all.selfIntersections - 1, all.selfIntersections - 1),
        std::pair(std::size_t(10), std::size_t(10)), std::pair(std::size_t(0), std::size_t(0))}) {
    options.maxIntersections = limit;
    for (const int threads : {1, 3})
      tbb::task_arena(threads).execute([&, limit = limit, counted = counted] {
        const SurfaceDefects some = defectsOf(mesh, options);
        EXPECT_EQ(some.selfIntersections, counted);
        EXPECT_EQ(some.selfIntersectionsComplete, limit == 0 || limit >= all.selfIntersections);
      });
  }
  options.maxIntersections = 10;
  EXPECT_NE(verdict(defectsOf(mesh, options)).find("more than 10 pairs of faces"),
            std::string::npos);
}

// Scaled by powers of ten, counts stay: near the ends of the range of doubles too.
TEST(SurfaceDefects, CountDoesNotDependOnScale) {
  const TriangleMesh mesh = joined({sphere(), torus(0.8, 0.3), box()});
  const std::size_t expected = intersectionsOf(mesh);
  ASSERT_GT(expected, 100u);
  for (const double scale : {0x1p-400, 0x1p-20, 0x1p300})
    EXPECT_EQ(intersectionsOf(moved(mesh,
                                    [&](const Vec3d& p) {
                                      return Vec3d{p[0] * scale, p[1] * scale, p[2] * scale};
                                    })),
              expected);
}

// --- Winding numbers.

void expectShares(const TriangleMesh& mesh, double tolerance) {
  DefectOptions options;
  options.maxIntersections = 0;
  const SurfaceDefects defects = defectsOf(mesh, options);
  std::array<double, 4> expected{0, 0, 0, 0};
  Random random(8);
  constexpr int kPoints = 3000;
  for (int i = 0; i < kPoints; ++i) {
    Vec3d p;
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] = random.between(defects.boxMin[axis], defects.boxMax[axis]);
    const double w = windingNumberAt(mesh, p);
    expected[w < -0.5 ? 0 : w <= 0.5 ? 1 : w <= 1.5 ? 2 : 3] += 1.0 / kPoints;
  }
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_NEAR(defects.windingShares[k], expected[k], tolerance) << k;
}

TEST(SurfaceDefects, WindingShares) {
  EXPECT_EQ(defectsOf(box()).windingShares, (std::array<double, 4>{0, 0, 1, 0}));
  EXPECT_EQ(defectsOf(flipped(box())).windingShares, (std::array<double, 4>{1, 0, 0, 0}));
  EXPECT_NEAR(defectsOf(sphere({3, 4, 5}, 2, 60)).windingShares[2], kPi / 6, 0.01);
  expectShares(joined({sphere(), sphere({0.5, 0, 0}, 0.8)}), 0.04);
  expectShares(joined({sphere(), flipped(sphere({1.5, 0, 0}, 0.6))}), 0.04);
  // Open ones, one with a face flipped and faces there twice.
  expectShares(without(sphere(), [](std::size_t f) { return f < 64; }), 0.04);
  expectShares(without(sphere(), [](std::size_t f) { return f % 3 == 0; }), 0.04);
  expectShares(withFacesFlipped(torus(), 0.3), 0.04);
  expectShares(joined({cylinder(1, 3, 20, false), box(), box()}), 0.04);
  expectShares(moebius(), 0.04);
  // Nothing is inside a plane, however often it is there.
  const auto lid = [](std::size_t f) { return f >= 2; };
  EXPECT_EQ(defectsOf(joined({without(box(), lid), without(box(), lid), without(box(), lid)}))
                .windingShares,
            (std::array<double, 4>{0, 1, 0, 0}));
  DefectOptions none;
  none.windingSamples = 0;
  EXPECT_EQ(defectsOf(box(), none).windingShares, (std::array<double, 4>{0, 0, 0, 0}));
}

// --- The rest.

TEST(SurfaceDefects, EmptyAndFlatMeshes) {
  EXPECT_EQ(verdict(defectsOf({})), "empty: no triangles");
  EXPECT_FALSE(defectsOf({}).watertight);
  TriangleMesh point;
  point.points = {{1, 2, 3}};
  point.triangles = {0, 0, 0};
  EXPECT_EQ(verdict(defectsOf(point)), "nothing to voxelize: no face has an area");
  EXPECT_EQ(defectsOf(point).degenerateFaces, 1u);
  EXPECT_FALSE(defectsOf(point).watertight);
  EXPECT_EQ(verdict(defectsOf(sheet())),
            "a sheet without inside (16 open edges in 1 hole); give it thickness with `shell`");
  EXPECT_EQ(verdict(defectsOf(moebius())).substr(0, 23), "open and not orientable");
  Random random(2);
  EXPECT_EQ(verdict(defectsOf(moved(unwelded(sphere()),
                                    [&](Vec3d p) {
                                      p[0] += random.between(-1e-6, 1e-6);
                                      return p;
                                    })))
                .substr(0, 15),
            "loose triangles");
}

TEST(SurfaceDefects, LikelyUnit) {
  const auto unitFor = [](double size) {
    return defectsOf(box({0, 0, 0}, {size, size, size})).likelyUnit;
  };
  EXPECT_EQ(unitFor(0.05), "metres");
  EXPECT_EQ(unitFor(1), "metres or a normalised model");
  EXPECT_EQ(unitFor(80), "millimetres");
  EXPECT_EQ(defectsOf({}).likelyUnit, "");
}

TEST(SurfaceDefects, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh =
      withFacesFlipped(joined({sphere({0, 0, 0}, 1, 60), torus(0.8, 0.3, 100, 60), box()}), 0.1);
  SurfaceDefects one, four;
  tbb::task_arena(1).execute([&] { one = defectsOf(mesh); });
  tbb::task_arena(4).execute([&] { four = defectsOf(mesh); });
  EXPECT_EQ(one.selfIntersections, four.selfIntersections);
  EXPECT_EQ(one.volume, four.volume);
  EXPECT_EQ(one.area, four.area);
  EXPECT_EQ(one.windingShares, four.windingShares);
}

TEST(SurfaceDefects, PointOfManyFacesAndASoup) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(defectsOf(cylinder(1, 1, 4000)).nonManifoldVertices, 0u);
  TriangleMesh soup; // everything meets everything
  Random random(1);
  for (std::uint32_t i = 0; i < 60000; ++i) {
    soup.points.push_back({random.unit(), random.unit(), random.unit()});
    soup.triangles.push_back(i);
  }
  const SurfaceDefects defects = defectsOf(soup);
  EXPECT_FALSE(defects.selfIntersectionsComplete);
  EXPECT_EQ(defects.boundaryEdges, 60000u);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
            60 * test::kSlower);
}

TEST(SurfaceDefects, CanBeCancelled) {
  Progress progress;
  progress.cancel();
  EXPECT_THROW(surfaceDefects(torus(), {}, progress), Error);
}

} // namespace
} // namespace tetvdb
