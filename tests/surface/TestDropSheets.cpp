// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/DropSheets.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using namespace tetvdb::meshes;

std::size_t dropped(const TriangleMesh& given) {
  TriangleMesh mesh = given;
  Progress progress;
  const SheetCounts counts = dropSheets(mesh, progress);
  EXPECT_TRUE(counts.complete);
  EXPECT_EQ(mesh.triangleCount() + counts.faces, given.triangleCount());
  return counts.faces;
}

TriangleMesh lidless(const Vec3d& low, const Vec3d& high) {
  return without(box(low, high, 2), [](std::size_t f) { return f >= 40; });
}

TEST(DropSheets, PlanesAreSheets) {
  EXPECT_EQ(dropped(sheet()), 32u);
  EXPECT_EQ(dropped(flipped(sheet())), 32u);
}

TEST(DropSheets, OpenSolidsStay) {
  EXPECT_EQ(dropped(lidless({0, 0, 0}, {1, 1, 1})), 0u);
  EXPECT_EQ(dropped(cylinder(1, 3, 32, false)), 0u);
  EXPECT_EQ(dropped(without(sphere(), [](std::size_t f) { return f % 9 == 0; })), 0u);
}

TEST(DropSheets, ClosedPartsAreNotLookedAt) {
  EXPECT_EQ(dropped(flipped(box())), 0u);
  EXPECT_EQ(dropped(joined({box({0, 0, 0}, {1, 1, 1}), sheet(4, 3)})), 32u);
}

TEST(DropSheets, WallsWithinASolidGo) {
  EXPECT_EQ(dropped(joined({box({-1, -1, -1}, {2, 2, 2}), sheet(4, 0.5)})), 32u);
  // An open solid that lies half within another stays.
  EXPECT_EQ(dropped(joined({box({0, 0, 0}, {1, 1, 1}), lidless({0.5, 0.2, 0.2}, {3, 0.8, 0.8})})),
            0u);
}

TEST(CountSheets, WhatBoundsNothingIsCounted) {
  const auto counted = [](const TriangleMesh& mesh) {
    Progress progress;
    return countSheets(mesh, progress);
  };
  EXPECT_EQ(counted(box()).count, 0u);
  const TriangleMesh house = joined({box(), lidless({2, 0, 0}, {3, 1, 1}), sheet(4, 5)});
  const OpenComponents ofHouse = counted(house);
  EXPECT_EQ(ofHouse.count, 2u);
  EXPECT_EQ(ofHouse.sheets, 1u);
  EXPECT_TRUE(ofHouse.exact);
  // Nothing is lost of a wall within a solid.
  const OpenComponents ofWall = counted(joined({box({-1, -1, -1}, {2, 2, 2}), sheet(4, 0.5)}));
  EXPECT_EQ(ofWall.count, 1u);
  EXPECT_EQ(ofWall.sheets, 0u);
  TriangleMesh many;
  for (int i = 0; i < 300; ++i)
    append(many, i % 3 == 0 ? lidless({10.0 * i, 0, 0}, {10.0 * i + 1 + 0.001 * i, 1, 1})
                            : moved(sheet(1), [&](const Vec3d& p) {
                                return Vec3d{p[0] + 10 * i, p[1], p[2] * (1 + 0.001 * i)};
                              }));
  const OpenComponents ofMany = counted(many);
  EXPECT_EQ(ofMany.count, 300u);
  EXPECT_FALSE(ofMany.exact);
  EXPECT_NEAR(double(ofMany.sheets), 200, 10);
}

} // namespace
} // namespace tetvdb
