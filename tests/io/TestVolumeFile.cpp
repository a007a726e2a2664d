// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/volume/Grids.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <openvdb/io/File.h>
#include <random>
#include <sys/resource.h>
#include <unistd.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test, removed at its end.
class VolumeFile : public ::testing::Test {
protected:
  void SetUp() override {
    initializeOpenVDB();
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder =
        fs::temp_directory_path() / ("tetvdb-" + std::to_string(::getpid()) + "-" + test->name());
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::size_t filesInFolder() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }

  fs::path folder;
  Progress progress;
};

std::string bytesOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void writeBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
}

openvdb::math::Transform::Ptr anisotropic() {
  return makeTransform({{0.05, 0.1, 0.025}, {-3, 7.5, 1e-3}});
}

template <class GridT>
typename GridT::Ptr newGrid(const char* name, typename GridT::ValueType background,
                            openvdb::GridClass gridClass = openvdb::GRID_UNKNOWN) {
  auto grid = GridT::create(background);
  grid->setName(name);
  grid->setGridClass(gridClass);
  grid->setTransform(anisotropic());
  grid->setCreator("test");
  return grid;
}

/// A fog of ones with tiles on every level, half-full leaves, and a few odd values.
openvdb::FloatGrid::Ptr fog() {
  auto grid = newGrid<openvdb::FloatGrid>("density", 0.0F, openvdb::GRID_FOG_VOLUME);
  grid->sparseFill({openvdb::Coord(-300, -9, -70), openvdb::Coord(171, 140, 133)}, 1.0F, true);
  for (int i = 0; i < 3000; ++i)
    grid->tree().setValueOn(openvdb::Coord(i, (i * 7) % 501, -i), float(i % 3));
  grid->tree().addTile(3, openvdb::Coord(8192, 0, 0), 1.0F, true);
  grid->tree().addTile(3, openvdb::Coord(-8192, 0, 0), 2.5F, false);
  grid->tree().addTile(2, openvdb::Coord(256, 1024, 0), 1.0F, true);
  return grid;
}

/// Values that differ everywhere, inactive ones of both signs: nothing to share.
openvdb::FloatGrid::Ptr levelSet() {
  auto grid = newGrid<openvdb::FloatGrid>("surface", 3.0F, openvdb::GRID_LEVEL_SET);
  auto accessor = grid->getAccessor();
  for (int x = -30; x < 30; ++x)
    for (int y = -30; y < 30; ++y)
      for (int z = -30; z < 30; ++z) {
        const float d = std::sqrt(float(x * x + y * y + z * z)) - 20.0F;
        if (std::abs(d) < 3)
          accessor.setValue({x, y, z}, d);
        else if (d < 0)
          accessor.setValueOff({x, y, z}, -3.0F);
      }
  return grid;
}

openvdb::GridPtrVec manyGrids() {
  auto mask = newGrid<openvdb::BoolGrid>("mask", false);
  mask->sparseFill({openvdb::Coord(-20), openvdb::Coord(99)}, true, true);
  auto id = newGrid<openvdb::Int32Grid>("tet_id", -1);
  id->sparseFill({openvdb::Coord(0), openvdb::Coord(60)}, 7, true);
  for (int i = 0; i < 4000; ++i)
    id->tree().setValueOn({i % 90, i % 77, i % 13}, i);
  auto velocity = newGrid<openvdb::Vec3SGrid>("vel", openvdb::Vec3s(0));
  velocity->sparseFill({openvdb::Coord(-5), openvdb::Coord(30)}, openvdb::Vec3s(1, 2, 3), true);
  velocity->tree().setValueOn({100, 2, 3}, openvdb::Vec3s(-1, 0, 5));
  auto wide = newGrid<openvdb::DoubleGrid>("wide", 0.25);
  wide->sparseFill({openvdb::Coord(-5), openvdb::Coord(30)}, 1e300, true);
  auto count = newGrid<openvdb::Int64Grid>("count", 0);
  count->sparseFill({openvdb::Coord(-5), openvdb::Coord(30)}, std::int64_t(1) << 60, true);
  return {fog(), levelSet(), mask, id, velocity, wide, count};
}

Volume volumeOf(const openvdb::GridPtrVec& grids) {
  Volume volume;
  volume.grids().all = grids;
  return volume;
}

/// What openvdb::io::File makes of the same grids.
std::string bytesOfFile(const std::string& path, const openvdb::GridPtrVec& grids,
                        const openvdb::MetaMap& metadata = {}) {
  openvdb::io::File file(path);
  file.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
  file.write(grids, metadata);
  file.close();
  return bytesOf(path);
}

/// All but the UUID, which is random in one file and derived from the content in ours.
std::string withoutUuid(std::string bytes) {
  if (bytes.size() > 57)
    bytes.replace(21, 36, 36, '0');
  return bytes;
}

template <class Action>
void expectError(Status status, const Action& action) {
  try {
    action();
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), status) << error.what();
  }
}

TEST_F(VolumeFile, SameBytesAsOpenVdbsOwnFile) {
  for (const auto& grid : manyGrids()) {
    const openvdb::GridPtrVec one{grid};
    writeVolume(path("a.vdb"), volumeOf(one), progress);
    EXPECT_TRUE(withoutUuid(bytesOf(path("a.vdb"))) == withoutUuid(bytesOfFile(path("b.vdb"), one)))
        << grid->getName();
  }
}

TEST_F(VolumeFile, SameBytesForSeveralGridsHalfFloatsSharedTreesAndMetadata) {
  auto grids = manyGrids();
  grids[0]->setSaveFloatAsHalf(true);
  grids[1]->setSaveFloatAsHalf(true);
  grids.push_back(grids[3]->copyGrid());
  grids.back()->setName("shared");
  grids.push_back(newGrid<openvdb::FloatGrid>("empty", 0.0F));
  grids.push_back(newGrid<openvdb::MaskGrid>("topology", false));
  Volume volume = volumeOf(grids);
  volume.metadata = {{"creator", "TetVDB"}, {"source", "a.vtu"}, {"units", "mm"}};
  openvdb::MetaMap metadata;
  for (const auto& [key, text] : volume.metadata)
    metadata.insertMeta(key, openvdb::StringMetadata(text));
  writeVolume(path("a.vdb"), volume, progress);
  EXPECT_TRUE(withoutUuid(bytesOf(path("a.vdb"))) ==
              withoutUuid(bytesOfFile(path("b.vdb"), grids, metadata)));
}

} // namespace
} // namespace tetvdb
