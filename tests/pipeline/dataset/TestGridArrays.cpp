// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/core/MixBits.h"
#include "tetvdb/pipeline/dataset/GridArrays.h"
#include "tetvdb/volume/Grids.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

constexpr int kReach = 40;

// Single voxels, a box that becomes tiles, and voxels outside of the cube.
Volume sample(int size) {
  initializeOpenVDB();
  auto grid = openvdb::BoolGrid::create(false);
  grid->setName("mask");
  for (std::uint64_t i = 0; i < 500; ++i) {
    const std::uint64_t h = hashOfIndex(i);
    const auto at = [&](int shift) { return static_cast<int>(h >> shift & 63) - 10; };
    grid->tree().setValueOn({at(0), at(6), at(12)}, true);
  }
  grid->tree().fill(openvdb::CoordBBox({-8, 3, 8}, {size / 2, 17, 31}), true, true);
  grid->tree().prune();
  Volume volume;
  volume.grids().all.push_back(grid);
  return volume;
}

TEST(GridArrays, BitsAreTheActiveVoxels) {
  for (const int size : {1, 7, 8, 12, 16, 24, kReach}) {
    const Volume volume = sample(size);
    const auto& grid = static_cast<const openvdb::BoolGrid&>(*volume.grids().all.front());
    const NamedArray packed = activeArray(volume, "mask", size, "a");
    const NamedArray plain = unpacked(packed);
    const auto side = static_cast<std::size_t>(size), cubed = side * side * side;
    ASSERT_EQ(packed.bytes.size(), (cubed + 7) / 8);
    ASSERT_EQ(plain.bytes.size(), cubed);
    std::size_t at = 0, count = 0;
    for (int x = 0; x < size; ++x)
      for (int y = 0; y < size; ++y)
        for (int z = 0; z < size; ++z, ++at) {
          const bool on = grid.tree().isValueOn({x, y, z});
          const auto byte = static_cast<unsigned char>(packed.bytes[at / 8]);
          ASSERT_EQ((byte >> (7 - at % 8) & 1) != 0, on) << size << " " << at;
          ASSERT_EQ(plain.bytes[at] != 0, on) << size << " " << at;
          count += on;
        }
    EXPECT_EQ(coordinateArray(volume, "mask", size, "c").shape[0], count);
  }
  EXPECT_THROW(activeArray(sample(8), "other", 8, "a"), Error);
}

} // namespace
} // namespace tetvdb
