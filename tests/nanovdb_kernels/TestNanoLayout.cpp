// SPDX-License-Identifier: Apache-2.0
//
// Buffers against NanoVDB's own validator and statistics.
#include "Meshes.h"
#include "nanovdb_kernels/Crc32.h"
#include "nanovdb_kernels/DeviceVoxelizer.h"
#include "tetvdb/io/volume/NvdbLayout.h"

#include TETVDB_NANOVDB_TOOL(GridStats)
#include TETVDB_NANOVDB_TOOL(GridValidator)
#include <cstring>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace {

using namespace tetvdb;
using nano::GridType;

TEST(Crc32, OfPartsIsThatOfTheWhole) {
  const char* text = "123456789";
  const auto* bytes = reinterpret_cast<const nano::u8*>(text);
  nano::u32 crc = 0xFFFFFFFFu;
  crc = nano::crcMultiply(nano::crcPower(4), crc) ^ nano::crcOf(bytes, 4);
  crc = nano::crcMultiply(nano::crcPower(5), crc) ^ nano::crcOf(bytes + 4, 5);
  EXPECT_EQ(crc ^ 0xFFFFFFFFu, 0xCBF43926u); // the check value of CRC-32
}

// As NanoVDB's version spells them.
#if __has_include(<nanovdb/tools/GridValidator.h>) // OpenVDB 12 and later
template <typename T>
bool isValidGrid(const nanovdb::NanoGrid<T>& grid) {
  return nanotools::isValid(&grid, nanovdb::CheckMode::Full, true);
}
template <typename T>
void makeStatistics(nanovdb::NanoGrid<T>& grid) {
  nanotools::updateGridStats(&grid, nanotools::StatsMode::All);
}
#else
template <typename T>
bool isValidGrid(const nanovdb::NanoGrid<T>& grid) {
  return nanotools::isValid(grid, true, true);
}
template <typename T>
void makeStatistics(nanovdb::NanoGrid<T>& grid) {
  nanotools::gridStats(grid, nanotools::StatsMode::All);
}
#endif

// The buffer is valid for NanoVDB, checksum included, and its statistics are what NanoVDB's own
// pass over the nodes makes of them.
template <typename T>
void expectValid(const TetMesh& mesh, GridType type) {
  nano::HostTwin twin;
  nano::Job job;
  job.type = type;
  job.voxelSize[0] = job.voxelSize[1] = job.voxelSize[2] = 0.5;
  job.origin[0] = 3;
  const nano::Result result = twin.run(
      {mesh.points[0].data(), mesh.points.size(), mesh.tets.data(), mesh.tetCount(), nullptr}, job);
  auto* grid = reinterpret_cast<nanovdb::NanoGrid<T>*>(const_cast<unsigned char*>(result.bytes));
  EXPECT_TRUE(isValidGrid(*grid));
  EXPECT_EQ(grid->gridSize(), result.counts.bufferBytes);

  std::vector<unsigned char> copy(result.counts.bufferBytes + 64);
  auto* bytes = reinterpret_cast<unsigned char*>(
      (reinterpret_cast<std::uintptr_t>(copy.data()) + 63) / 64 * 64);
  std::memcpy(bytes, result.bytes, result.counts.bufferBytes);
  auto* other = reinterpret_cast<nanovdb::NanoGrid<T>*>(bytes);
  makeStatistics<T>(*other);
  EXPECT_EQ(flagsOf(*other->data()), flagsOf(*grid->data()));
  EXPECT_EQ(other->worldBBox()[0], grid->worldBBox()[0]);
  EXPECT_EQ(other->worldBBox()[1], grid->worldBBox()[1]);
  std::uint64_t voxels = 0;
  const auto compare = [&](const auto& a, const auto& b) {
    EXPECT_EQ(a.bbox().min(), b.bbox().min());
    EXPECT_EQ(a.bbox().max(), b.bbox().max());
    EXPECT_EQ(a.minimum(), b.minimum());
    EXPECT_EQ(a.maximum(), b.maximum());
    if constexpr (!std::is_same_v<T, bool> && !std::is_same_v<T, nanovdb::ValueMask>) {
      const auto near = [](double x, double y) {
        return std::abs(x - y) <= 1e-5 * (1 + std::abs(x));
      };
      EXPECT_TRUE(near(a.average(), b.average())) << a.average() << " " << b.average();
      EXPECT_TRUE(near(a.stdDeviation(), b.stdDeviation()))
          << a.stdDeviation() << " " << b.stdDeviation();
    }
  };
  compare(grid->tree().root(), other->tree().root());
  auto& tree = grid->tree();
  for (std::uint32_t i = 0; i < tree.nodeCount(2); ++i)
    compare(tree.template getFirstNode<2>()[i], other->tree().template getFirstNode<2>()[i]);
  for (std::uint32_t i = 0; i < tree.nodeCount(1); ++i)
    compare(tree.template getFirstNode<1>()[i], other->tree().template getFirstNode<1>()[i]);
  for (std::uint32_t i = 0; i < tree.nodeCount(0); ++i)
    compare(tree.template getFirstNode<0>()[i], other->tree().template getFirstNode<0>()[i]);
  for (auto it = tree.root().beginChild(); it; ++it)
    for (auto lower = it->beginChild(); lower; ++lower) {
      for (auto leaf = lower->beginChild(); leaf; ++leaf)
        voxels += leaf->valueMask().countOn();
      voxels += 512ull * lower->valueMask().countOn();
    }
  for (auto it = tree.root().beginChild(); it; ++it)
    voxels += 2097152ull * it->valueMask().countOn();
  EXPECT_EQ(tree.activeVoxelCount(), voxels);
}

TEST(NanoLayout, BuffersAreValidAndTheirStatisticsRight) {
  const TetMesh ball = meshes::ball(6, 150, {10, -20, 70});
  expectValid<float>(ball, GridType::Fog);
  expectValid<bool>(ball, GridType::Bool);
  expectValid<nanovdb::ValueMask>(ball, GridType::Mask);
  expectValid<std::int32_t>(meshes::ball(4, 40, {10, -20, 70}), GridType::Owner);
}

} // namespace
