// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/TileFolder.h"
#include "tetvdb/volume/Grids.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <string>

namespace tetvdb {
namespace {

// Children of the root node in a row, all of their voxels inside.
class FullChildren : public BitSource {
public:
  explicit FullChildren(int count) {
    for (int i = 0; i < count; ++i)
      cubes_.push_back({{4096 * i, 0, 0}, true});
  }
  const std::vector<RootCube>& cubes() const override { return cubes_; }
  std::vector<int> begin(std::size_t) override { return {}; }
  void fill(int, BitStack&) override {}

private:
  std::vector<RootCube> cubes_;
};

// 200 children are 102,400 cubes of 512^3 voxels: that is known before the first file is made.
TEST(TileFolder, TooManyFilesAreRefusedAtOnce) {
  initializeOpenVDB();
  const TemporaryFolder folder;
  const auto mask = openvdb::BoolGrid::create(false);
  mask->setName("mask");
  Progress progress;
  try {
    TileFolder tiles(folder / "tiles", 512, {}, {mask});
    FullChildren source(200);
    tiles.add(source, {}, progress);
    FAIL() << "102,400 files";
  } catch (const Error& e) {
    EXPECT_EQ(e.status(), Status::Limit) << e.what();
    EXPECT_NE(std::string(e.what()).find("tile_size"), std::string::npos) << e.what();
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  TileFolder tiles(folder / "tiles", 4096, {}, {mask});
  FullChildren source(3);
  tiles.add(source, {}, progress);
  tiles.commit(progress);
  EXPECT_EQ(tiles.grids().front().activeVoxels, 3ull << 36);
}

} // namespace
} // namespace tetvdb
