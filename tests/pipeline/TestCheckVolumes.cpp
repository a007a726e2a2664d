// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/CheckVolumes.h"
#include "tetvdb/volume/Grids.h"

#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/LevelSetSphere.h>

namespace {

using namespace tetvdb;

// Files as OpenVDB's own writer makes them.
class CheckVolumes : public testing::Test {
protected:
  void SetUp() override { initializeOpenVDB(); }

  std::string save(const std::string& name, const openvdb::GridPtrVec& grids,
                   const openvdb::MetaMap& metadata = {}) const {
    const std::string path = folder_ / name;
    openvdb::io::File file(path);
    file.write(grids, metadata);
    file.close();
    return path;
  }

  template <typename Grid = openvdb::FloatGrid>
  static typename Grid::Ptr box(const std::string& name, typename Grid::ValueType value, int size,
                                double voxel = 0.1) {
    auto grid = Grid::create();
    grid->setName(name);
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    grid->denseFill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(size - 1)), value, true);
    return grid;
  }

  // "error:tiles-alone density" and so on, without notes.
  static std::set<std::string> found(const std::vector<std::string>& files,
                                     const CheckOptions& options = {}) {
    Progress progress;
    std::set<std::string> all;
    for (const Finding& finding : checkVolumes(files, options, progress)) {
      EXPECT_FALSE(finding.cure.empty());
      if (finding.weight != Finding::Weight::Note)
        all.insert((finding.weight == Finding::Weight::Error ? "error:" : "warning:") +
                   finding.code + (finding.grid.empty() ? "" : " " + finding.grid));
    }
    return all;
  }
  using Set = std::set<std::string>;

private:
  TemporaryFolder folder_;
};

TEST_F(CheckVolumes, NothingWrong) {
  const auto sphere =
      openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1.0f, openvdb::Vec3f(0), 0.1f, 3.0f);
  sphere->setName("surface");
  EXPECT_EQ(found({save("a.vdb", {box("density", 1, 12), sphere,
                                  box<openvdb::Vec3SGrid>("vel", openvdb::Vec3s(-9e4f), 12)})}),
            Set{});
}

TEST_F(CheckVolumes, WhatIsNotDrawn) {
  auto empty = openvdb::FloatGrid::create();
  empty->setName("empty");
  empty->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
  auto tiles = openvdb::FloatGrid::create();
  tiles->setName("tiles");
  tiles->setGridClass(openvdb::GRID_FOG_VOLUME);
  tiles->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
  tiles->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(15)), 1.0f);
  ASSERT_EQ(tiles->tree().leafCount(), 0u);
  const std::string file = save("a.vdb", {empty, tiles, box<openvdb::MaskGrid>("mask", true, 12)});
  EXPECT_EQ(found({file}),
            (Set{"error:no-voxels empty", "error:tiles-alone tiles", "error:type mask"}));
  CheckOptions houdini;
  houdini.target = CheckTarget::Houdini;
  EXPECT_EQ(found({file}, houdini), (Set{"error:no-voxels empty", "error:type mask"}));
}

TEST_F(CheckVolumes, ValuesClassesAndTransforms) {
  auto noClass = box("noClass", 1, 12);
  noClass->setGridClass(openvdb::GRID_UNKNOWN);
  auto noInside = box("noInside", 1, 12);
  noInside->setGridClass(openvdb::GRID_LEVEL_SET);
  const std::string file =
      save("a.vdb", {box("density", 1, 12), box("faint", 5e-4f, 12), box("negative", -1, 12),
                     box("pascals", 1e5f, 12), noClass, noInside, box("shifted", 1, 12, 0.2)});
  EXPECT_EQ(found({file}), (Set{"warning:hidden-values faint", "warning:hidden-values negative",
                                "warning:hidden-values pascals", "warning:class noClass",
                                "warning:class noInside", "warning:transform shifted"}));
}

TEST_F(CheckVolumes, FrustumsAndSizes) {
  auto frustum = box("density", 1, 12);
  frustum->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(100)), 0.5, 10, 0.1));
  EXPECT_EQ(found({save("frustum.vdb", {frustum})}), (Set{"error:transform density"}));
  EXPECT_EQ(found({save("tiny.vdb", {box("density", 1, 12, 2e-5)})}),
            (Set{"warning:extent", "warning:voxel-size density"}));
  EXPECT_EQ(found({save("huge.vdb", {box("density", 1, 12, 200)})}), (Set{"warning:extent"}));
  CheckOptions small;
  small.denseBytes = 12 * 12 * 12 * 4 - 1;
  EXPECT_EQ(found({save("dense.vdb", {box("density", 1, 12)})}, small),
            (Set{"warning:memory density"}));
  small.denseBytes += 1;
  EXPECT_EQ(found({save("dense.vdb", {box("density", 1, 12)})}, small), Set{});
}

TEST_F(CheckVolumes, Backgrounds) {
  const auto with = [&](const std::string& name, float background) {
    auto grid = box(name, 1, 12);
    openvdb::tools::changeBackground(grid->tree(), background);
    return grid;
  };
  auto numbers = openvdb::Int32Grid::create(-1);
  numbers->setName("numbers");
  numbers->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
  numbers->tree().setValue(openvdb::Coord(0), 1);
  const std::string file = save("a.vdb", {with("zero", 0), with("one", 1), numbers});
  EXPECT_EQ(found({file}), (Set{"warning:background one"})); // of `numbers` a note
  CheckOptions houdini;
  houdini.target = CheckTarget::Houdini;
  EXPECT_EQ(found({file}, houdini), Set{});
}

TEST_F(CheckVolumes, UpAxis) {
  openvdb::MetaMap yUp;
  yUp.insertMeta("up_axis", openvdb::StringMetadata("y"));
  const std::string file = save("a.vdb", {box("density", 1, 12)}, yUp);
  EXPECT_EQ(found({file}), (Set{"warning:up-axis"}));
  CheckOptions houdini;
  houdini.target = CheckTarget::Houdini;
  EXPECT_EQ(found({file}, houdini), Set{});
}

TEST_F(CheckVolumes, Sequences) {
  const auto density = [&] { return openvdb::GridPtrVec{box("density", 1, 12)}; };
  const std::string a1 = save("a.0001.vdb", density()), a2 = save("a.0002.vdb", density());
  EXPECT_EQ(found({a1, a2}), Set{});
  EXPECT_EQ(found({a1, save("a.0004.vdb", density())}), (Set{"error:sequence-gap"}));
  EXPECT_EQ(found({a1, save("b.0002.vdb", density())}), (Set{"error:sequence-name"}));
  EXPECT_EQ(found({save("plain.vdb", density()), save("other.vdb", density())}),
            (Set{"error:sequence-name"}));
  EXPECT_EQ(found({save("c.1_low.vdb", density()), save("c.2_low.vdb", density())}),
            (Set{"error:sequence-name"}));
  EXPECT_EQ(found({save("d.9.vdb", density()), save("d.10.vdb", density())}), Set{});
  EXPECT_EQ(found({save("e.1.vdb", density()), save("e.02.vdb", density())}),
            (Set{"error:sequence-name"}));
  EXPECT_EQ(found({a1, save("a.0002.vdb", {box("density", 1, 12, 0.3)})}),
            (Set{"warning:sequence-transform density"}));
  EXPECT_EQ(found({a1, save("a.0002.vdb", {box("density", 1, 12), box("T", 1, 12)})}),
            (Set{"error:sequence-grids"}));
  EXPECT_EQ(found({a1, save("a.0002.vdb", {box<openvdb::Int32Grid>("density", 1, 12)})}),
            (Set{"error:sequence-grids"}));
}

TEST_F(CheckVolumes, WhatCannotBeReadIsAnError) {
  Progress progress;
  try {
    checkVolumes({"/nowhere/none.vdb"}, {}, progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Invalid);
  }
}

TEST_F(CheckVolumes, FramesAreJudgedTogether) {
  auto nothing = box("density", 0, 12), empty = openvdb::FloatGrid::create();
  empty->setName("density");
  empty->setGridClass(openvdb::GRID_FOG_VOLUME);
  empty->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
  const std::string zeros = save("a.0001.vdb", {nothing}), none = save("a.0002.vdb", {empty}),
                    full = save("a.0003.vdb", {box("density", 1, 12)});
  EXPECT_EQ(found({zeros}), (Set{"warning:hidden-values density"}));
  EXPECT_EQ(found({none}), (Set{"error:no-voxels density"}));
  EXPECT_EQ(found({zeros, none, full}), Set{});
  const std::string stillNone = save("a.0003.vdb", {empty});
  EXPECT_EQ(found({zeros, none, stillNone}), (Set{"warning:hidden-values density"}));
  EXPECT_EQ(found({none, stillNone}), (Set{"error:no-voxels density"}));
}

} // namespace
