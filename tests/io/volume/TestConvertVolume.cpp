// SPDX-License-Identifier: Apache-2.0
//
// Conversion part by part against reading and writing whole trees, of files that other programs
// write.
#define NANOVDB_USE_BLOSC
#define NANOVDB_USE_ZIP
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "io/VolumeSamples.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/NanoVdb.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/VolumeStream.h"
#include "tetvdb/volume/Grids.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <string>

#if __has_include(<nanovdb/util/OpenToNanoVDB.h>) && NANOVDB_MINOR_VERSION_NUMBER == 4
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#define TETVDB_NANOVDB_WRITES
#endif

namespace tetvdb {
namespace {

constexpr std::size_t kOneNode = 1; // bytes: every lower node is a part of its own
constexpr std::size_t kRoom = std::size_t(1) << 30;

// Nodes that are not pruned, and tiles of every level and of odd values.
template <class GridT, class Make>
openvdb::GridBase::Ptr oddNodes(const std::string& name, const Make& make) {
  auto grid = GridT::create(make(0.25));
  grid->setName(name);
  grid->setTransform(makeTransform({{0.05, 0.1, 0.025}, {-3, 7.5, 1e-3}}));
  grid->insertMeta("author", openvdb::StringMetadata("somebody"));
  auto& tree = grid->tree();
  test::scatterNodes(tree, make, 2000, 25, 5);
  tree.setValueOff({20000, 1000, 1000}, make(0.25)); // a branch without anything
  for (int i = 0; i < 512; ++i)                      // a leaf of one value
    tree.setValueOn({800 + i / 64, 704 + i / 8 % 8, 8 + i % 8}, make(2));
  tree.addTile(2, {40000, 0, 0}, make(2), false); // an upper node without children
  tree.addTile(3, {-16384, 0, 0}, make(0.25), false);
  return grid;
}

openvdb::GridPtrVec oddGrids(bool forNano) {
  initializeOpenVDB();
  const auto number = [](double v) { return static_cast<float>(v); };
  const auto bit = [](double v) { return v > 1; };
  openvdb::GridPtrVec grids = {
      oddNodes<openvdb::FloatGrid>("number", number),
      oddNodes<openvdb::BoolGrid>("bit", bit),
      oddNodes<openvdb::Int32Grid>("whole", [](double v) { return std::int32_t(1000 * v); }),
      oddNodes<openvdb::Int64Grid>("long", [](double v) { return std::int64_t(v * 1e15); }),
      oddNodes<openvdb::DoubleGrid>("wide", [](double v) { return v * 1e100; }),
      oddNodes<openvdb::Vec3SGrid>(
          "vector", [](double v) { return openvdb::Vec3s(float(v), float(1 - v), float(v * v)); }),
      openvdb::FloatGrid::create(-2)};
  grids.front()->setGridClass(openvdb::GRID_LEVEL_SET);
  grids.back()->setName("empty");
  if (forNano)
    return grids;
  grids.push_back(oddNodes<openvdb::FloatGrid>("half", number));
  grids.back()->setSaveFloatAsHalf(true);
  grids.push_back(oddNodes<openvdb::MaskGrid>("topology", bit));
  grids.push_back(
      oddNodes<openvdb::Vec3DGrid>("wide vector", [](double v) { return openvdb::Vec3d(v); }));
  grids.push_back(oddNodes<openvdb::Vec3IGrid>(
      "whole vector", [](double v) { return openvdb::Vec3i(int(v), 1, -int(v)); }));
  return grids;
}

class ConvertVolume : public ::testing::Test {
protected:
  std::string path(const std::string& name) const { return folder_ / name; }

  std::string bytes(const std::string& name) const { return test::fileBytes(path(name)); }

  std::vector<GridInfo> convert(const std::string& from, const std::string& to, std::size_t memory,
                                const std::vector<std::string>& grids = {}) {
    return convertVolumeFile({path(from), path(to), grids, memory}, progress_);
  }

  // The file as a whole into another, and part by part.
  void expectSame(const std::string& from, const std::string& to) {
    ASSERT_TRUE(canConvertVolume(path(from)));
    const Volume whole = readVolume(path(from), progress_);
    writeVolume(path("whole" + to), whole, progress_);
    const std::vector<GridInfo> expected = describe(whole);
    const std::string wanted = bytes("whole" + to);
    for (const std::size_t memory : {kOneNode, kRoom}) {
      const std::vector<GridInfo> infos = convert(from, "parts" + to, memory);
      EXPECT_TRUE(bytes("parts" + to) == wanted) << from << to << memory;
      ASSERT_EQ(infos.size(), expected.size());
      for (std::size_t g = 0; g < infos.size(); ++g) {
        const GridInfo &a = infos[g], &b = expected[g];
        EXPECT_EQ(a.name, b.name);
        test::expectSameCounts(a, b);
      }
    }
  }

  TemporaryFolder folder_;
  Progress progress_;
};

TEST_F(ConvertVolume, FilesOfOpenVDB) {
  namespace io = openvdb::io;
  for (const std::uint32_t compression :
       {std::uint32_t(io::COMPRESS_NONE), std::uint32_t(io::COMPRESS_ACTIVE_MASK),
        std::uint32_t(io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK),
        std::uint32_t(io::COMPRESS_BLOSC | io::COMPRESS_ACTIVE_MASK)}) {
    openvdb::MetaMap metadata;
    metadata.insertMeta("source", openvdb::StringMetadata("a test"));
    for (const bool forNano : {false, true}) {
      io::File file(path("a.vdb"));
      file.setCompression(compression);
      file.write(oddGrids(forNano), metadata);
      file.close();
      expectSame("a.vdb", forNano ? ".nvdb" : ".vdb");
    }
  }
}

#ifdef TETVDB_NANOVDB_WRITES
TEST_F(ConvertVolume, FilesOfNanoVDB) {
  using nanovdb::io::Codec;
  for (const Codec codec : {Codec::NONE, Codec::ZIP, Codec::BLOSC}) {
    std::vector<nanovdb::GridHandle<>> handles;
    for (const auto& grid : oddGrids(true))
      handles.push_back(
          nanovdb::openToNanoVDB(grid, nanovdb::StatsMode::All, nanovdb::ChecksumMode::Full));
    nanovdb::io::writeGrids<nanovdb::HostBuffer, std::vector>(path("a.nvdb"), handles, codec);
    expectSame("a.nvdb", ".vdb");
    expectSame("a.nvdb", ".nvdb");
  }
}
#endif

TEST_F(ConvertVolume, GridsByName) {
  openvdb::io::File(path("a.vdb")).write(oddGrids(true));
  Volume volume = readVolume(path("a.vdb"), progress_);
  writeVolume(path("all.nvdb"), volume, progress_);
  openvdb::GridPtrVec& grids = volume.grids().all;
  const auto named = [&](const std::string& name) {
    for (const auto& grid : grids)
      if (grid->getName() == name)
        return grid;
    return openvdb::GridBase::Ptr();
  };
  grids = {named("whole"), named("bit")};
  writeVolume(path("whole.vdb"), volume, progress_);
  convert("a.vdb", "parts.vdb", kRoom, {"whole", "bit"});
  EXPECT_TRUE(bytes("parts.vdb") == bytes("whole.vdb"));
  writeVolume(path("whole.nvdb"), volume, progress_);
  convert("all.nvdb", "parts.nvdb", kRoom, {"whole", "bit"});
  EXPECT_TRUE(bytes("parts.nvdb") == bytes("whole.nvdb"));
  for (const std::string from : {"a.vdb", "all.nvdb"})
    for (const std::vector<std::string>& names :
         {std::vector<std::string>{"none"}, std::vector<std::string>{"bit", "bit"}})
      EXPECT_THROW(convert(from, "new.vdb", kRoom, names), Error);
  EXPECT_FALSE(std::filesystem::exists(path("new.vdb")));
}

TEST_F(ConvertVolume, WhatCannotBeWrittenLeavesNothing) {
  openvdb::io::File(path("a.vdb")).write(oddGrids(false));
  EXPECT_THROW(convert("a.vdb", "new.nvdb", kRoom), Error); // a MaskGrid and others
  openvdb::GridPtrVec same(2, oddGrids(true).front());
  same.back() = same.back()->deepCopyGrid();
  openvdb::io::File(path("same.vdb")).write(same);
  EXPECT_THROW(convert("same.vdb", "new.vdb", kRoom), Error);
  const std::string whole = bytes("a.vdb");
  std::ofstream(path("cut.vdb"), std::ios::binary)
      .write(whole.data(), static_cast<std::streamsize>(whole.size() - 9));
  EXPECT_FALSE(canConvertVolume(path("cut.vdb")));
  EXPECT_THROW(convert("cut.vdb", "new.vdb", kRoom), Error);
  EXPECT_FALSE(std::filesystem::exists(path("new.vdb")));
  EXPECT_FALSE(std::filesystem::exists(path("new.nvdb")));
}

} // namespace
} // namespace tetvdb
