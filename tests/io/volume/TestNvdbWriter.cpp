// SPDX-License-Identifier: Apache-2.0
//
// .nvdb files against NanoVDB's own converter and reader.
#define NANOVDB_USE_BLOSC
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "io/VolumeSamples.h"
#include "tetvdb/core/NanoVdb.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/volume/Grids.h"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <string>
#include <tbb/global_control.h>

#if __has_include(<nanovdb/util/OpenToNanoVDB.h>) && NANOVDB_MINOR_VERSION_NUMBER == 4
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

namespace tetvdb {
namespace {

template <class GridT>
typename GridT::Ptr newGrid(const std::string& name, typename GridT::ValueType background,
                            openvdb::GridClass gridClass = openvdb::GRID_UNKNOWN) {
  auto grid = GridT::create(background);
  grid->setName(name);
  grid->setGridClass(gridClass);
  grid->setTransform(makeTransform({{0.05, 0.1, 0.025}, {-3, 7.5, 1e-3}}));
  return grid;
}

// Voxels in several cubes, some of them inactive, and tiles of every level.
template <class GridT, class Make>
typename GridT::Ptr scattered(const std::string& name, const Make& make, int voxels,
                              openvdb::GridClass gridClass = openvdb::GRID_UNKNOWN) {
  auto grid = newGrid<GridT>(name, make(0.25), gridClass);
  auto& tree = grid->tree();
  test::scatterNodes(tree, make, voxels, 60, 11);
  tree.setValueOff({1000, 1000, 1000}, make(7)); // a leaf without active voxels
  return grid;
}

template <class Node>
void expectSameMeans(Node& a, Node& b) {
  const auto near = [](auto& x, auto& y) {
    EXPECT_LE(std::abs(double(x) - double(y)), 1e-6 * (1 + std::abs(double(y))));
    x = y = 0;
  };
  near(a.mAverage, b.mAverage);
  near(a.mStdDevi, b.mStdDevi);
}

// The converter leaves those of nodes without active values, and all but two flags, as it finds the
// memory.
template <class Node>
void expectSameStatistics(Node& a, Node& b) {
  EXPECT_EQ(a.mFlags, b.mFlags & 3);
  a.mFlags = b.mFlags = 0;
  if (!b.mBBox.empty())
    return expectSameMeans(a, b);
  for (Node* node : {&a, &b}) {
    node->mMinimum = node->mMaximum = decltype(node->mMinimum)(0);
    node->mAverage = node->mStdDevi = 0;
  }
}

// All but the last bits of means, and checksums, which follow from them.
template <class Build>
void expectSame(nanovdb::NanoGrid<Build>& grid, nanovdb::NanoGrid<Build>& expected,
                std::size_t size) {
  EXPECT_TRUE(nanovdb::validateChecksum(grid, nanovdb::ChecksumMode::Full));
  if constexpr (!std::is_same_v<Build, bool>) {
    auto &a = grid.tree(), &b = expected.tree();
    expectSameMeans(*a.root().data(), *b.root().data());
    for (std::uint32_t i = 0; i < b.nodeCount(2); ++i)
      expectSameStatistics(*a.getFirstUpper()[i].data(), *b.getFirstUpper()[i].data());
    for (std::uint32_t i = 0; i < b.nodeCount(1); ++i)
      expectSameStatistics(*a.getFirstLower()[i].data(), *b.getFirstLower()[i].data());
    for (std::uint32_t i = 0; i < b.nodeCount(0); ++i)
      expectSameMeans(*a.getFirstLeaf()[i].data(), *b.getFirstLeaf()[i].data());
  }
  const bool full = expected.data()->mChecksum >> 32 != 0xFFFFFFFF;
  EXPECT_EQ(grid.data()->mChecksum >> 32 != 0xFFFFFFFF, full);
  grid.data()->mChecksum = expected.data()->mChecksum = 0;
  const auto *x = reinterpret_cast<const char*>(&grid),
             *y = reinterpret_cast<const char*>(&expected);
  EXPECT_EQ(std::mismatch(x, x + size, y).first - x, static_cast<std::ptrdiff_t>(size));
}

class NvdbWriter : public ::testing::Test {
protected:
  void SetUp() override { initializeOpenVDB(); }

  std::string write(const openvdb::GridPtrVec& grids, const std::string& name = "a.nvdb") {
    Volume volume;
    volume.grids().all = grids;
    writeVolume(folder_ / name, volume, progress_);
    return folder_ / name;
  }

  template <class Build = void, class GridT>
  void expectConverted(const std::shared_ptr<GridT>& grid) {
    using Type = std::conditional_t<std::is_void_v<Build>, typename GridT::ValueType, Build>;
    auto handles = nanovdb::io::readGrids(write({grid}));
    ASSERT_EQ(handles.size(), 1u);
    auto expected =
        nanovdb::openToNanoVDB(*grid, nanovdb::StatsMode::All, nanovdb::ChecksumMode::Full);
    ASSERT_EQ(handles[0].size(), expected.size());
    expectSame(*handles[0].template grid<Type>(), *expected.template grid<Type>(), expected.size());
  }

  TemporaryFolder folder_;
  Progress progress_;
};

TEST_F(NvdbWriter, BytesAreThoseOfNanoVDBsConverter) {
  const auto number = [](double v) { return static_cast<float>(v); };
  const auto whole = [](double v) { return static_cast<std::int32_t>(1000 * v); };
  expectConverted(scattered<openvdb::FloatGrid>("density", number, 20000));
  expectConverted(scattered<openvdb::FloatGrid>("surface", number, 3000, openvdb::GRID_LEVEL_SET));
  expectConverted(scattered<openvdb::BoolGrid>(
      "mask", [](double v) { return v > 1; }, 20000, openvdb::GRID_FOG_VOLUME));
  expectConverted(scattered<openvdb::Int32Grid>("tet_id", whole, 5000));
  expectConverted(scattered<openvdb::Int64Grid>(
      "count", [](double v) { return static_cast<std::int64_t>(v * 1e15); }, 3000));
  expectConverted(scattered<openvdb::DoubleGrid>(
      "wide", [](double v) { return v * 1e100; }, 3000));
  expectConverted<nanovdb::Vec3f>(scattered<openvdb::Vec3SGrid>(
      "vel", [](double v) { return openvdb::Vec3s(float(v), float(1 - v), float(v * v)); }, 5000));
}

TEST_F(NvdbWriter, OfFewNodes) {
  expectConverted(newGrid<openvdb::FloatGrid>("empty", -2));
  auto tile = newGrid<openvdb::FloatGrid>("tile", 0);
  tile->tree().addTile(3, openvdb::Coord(-4096, 0, 4096), 5, true);
  expectConverted(tile);
  auto voxel = newGrid<openvdb::BoolGrid>("voxel", false);
  voxel->tree().setValueOn({-1, -1, -1}, true);
  voxel->setTransform(openvdb::math::Transform::createLinearTransform(0.3));
  expectConverted(voxel);
  auto dense = newGrid<openvdb::FloatGrid>("dense", 0); // leaves without a gap, through many blocks
  for (int x = 0; x < 128; ++x)
    for (int y = 0; y < 64; ++y)
      for (int z = 0; z < 64; ++z)
        dense->tree().setValueOn({x, y, z}, float(x * y) - float(z) / 3);
  expectConverted(dense);
}

TEST_F(NvdbWriter, BytesDoNotDependOnThreads) {
  const auto grid = scattered<openvdb::FloatGrid>(
      "density", [](double v) { return static_cast<float>(v); }, 20000);
  const std::string all = test::fileBytes(write({grid}));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(test::fileBytes(write({grid}, "b.nvdb")) == all);
}

} // namespace
} // namespace tetvdb
#endif
