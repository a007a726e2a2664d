// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/volume/GridKinds.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

TEST(GridKinds, RowsStandInTheOrderOfTheEnumeration) {
  for (std::size_t i = 0; i < kGridKinds.size(); ++i)
    EXPECT_EQ(static_cast<std::size_t>(kGridKinds[i].kind), i);
}

TEST(GridKinds, NamesFindTheirKinds) {
  for (const GridKindInfo& info : kGridKinds)
    EXPECT_EQ(gridKindOf(info.name), info.kind);
  EXPECT_EQ(gridKindOf("Density"), std::nullopt);
  EXPECT_EQ(listGridKinds(), "density, mask, surface, fog, coverage, tet_id and material");
}

TEST(GridKinds, MadeByKeepsTheOrder) {
  const std::vector<GridKind> kinds{GridKind::Fog, GridKind::TetId, GridKind::Mask,
                                    GridKind::Coverage};
  EXPECT_EQ(madeBy(kinds, {GridMaker::Occupancy, GridMaker::Owner}),
            (std::vector<GridKind>{GridKind::TetId, GridKind::Mask}));
  EXPECT_EQ(madeBy(kinds, {GridMaker::Share}), std::vector<GridKind>{GridKind::Coverage});
}

TEST(GridKinds, RefusesNoneTwoAndForeignKinds) {
  const auto check = [](std::vector<GridKind> kinds) {
    checkGridKinds(kinds, {GridMaker::Occupancy});
  };
  EXPECT_THROW(check({}), Error);
  EXPECT_THROW(check({GridKind::Mask, GridKind::Density, GridKind::Mask}), Error);
  EXPECT_THROW(check({GridKind::Surface}), Error);
  EXPECT_NO_THROW(check({GridKind::Mask, GridKind::Density}));
}

// What the table says of a grid is what voxelize() makes.
TEST(GridKinds, GridsAreAsTheTableSays) {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 0, 8}};
  mesh.tets = {0, 1, 2, 3};
  mesh.cellCount = 1;
  VoxelizeOptions options;
  options.voxelSize = {1, 1, 1};
  options.grids = {GridKind::Density, GridKind::Mask, GridKind::TetId, GridKind::Material};
  Report report;
  Progress progress;
  const Voxelization made = voxelize(mesh, options, report, progress);
  const auto& grids = made.volume.grids().all;
  ASSERT_EQ(grids.size(), options.grids.size());
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const GridKindInfo& info = infoOf(options.grids[i]);
    EXPECT_EQ(grids[i]->getName(), info.name);
    EXPECT_EQ(grids[i]->valueType(), info.type);
    EXPECT_EQ(openvdb::GridBase::gridClassToString(grids[i]->getGridClass()), info.gridClass);
  }
}

} // namespace
} // namespace tetvdb
