// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"
#include "tetvdb/io/volume/VdbPieces.h"
#include "tetvdb/volume/Grids.h"

#include <gtest/gtest.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/tree/LeafManager.h>
#include <sstream>
#include <string>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

// 12 pieces, of more bytes than a store keeps at the least: leaves of one value, of inactive values
// besides, and of values without order.
openvdb::FloatGrid::Ptr someLeaves(bool asHalf) {
  const auto grid = openvdb::FloatGrid::create(0.5f);
  grid->setSaveFloatAsHalf(asHalf);
  for (int i = 0; i < 6000; ++i)
    grid->tree().addLeaf(new openvdb::FloatTree::LeafNodeType(openvdb::Coord(8 * i, 0, 0)));
  openvdb::tree::LeafManager<openvdb::FloatTree> manager(grid->tree());
  manager.foreach ([](openvdb::FloatTree::LeafNodeType& leaf, std::size_t l) {
    const auto number = static_cast<openvdb::Index>(l);
    for (openvdb::Index i = 0; i < leaf.SIZE; ++i) {
      leaf.setValueOff(i, l % 5 == 1 ? -2.0f : 0.5f);
      if (i % (2 + number % 7) != 0)
        leaf.setValueOn(i, l % 3 == 0 ? 1.0f
                                      : static_cast<float>((i * 2654435761u + number) >> 9 & 8191));
    }
  });
  return grid;
}

// OpenVDB's own.
std::string buffersOf(const openvdb::FloatGrid& grid) {
  std::ostringstream out(std::ios::binary);
  openvdb::io::setDataCompression(out, vdbCompression());
  const float background = grid.background();
  openvdb::io::setGridBackgroundValuePtr(out, &background);
  grid.tree().writeBuffers(out, grid.saveFloatAsHalf());
  return out.str();
}

std::string entriesOf(const BufferPieces<openvdb::FloatTree>& pieces) {
  openvdb::io::DelayedLoadMetadata entries;
  pieces.describe(entries);
  std::string all;
  for (std::size_t l = 0; l < pieces.leafCount(); ++l)
    all += std::to_string(entries.getMask(l)) + ' ' + std::to_string(entries.getCompressedSize(l)) +
           '\n';
  return all;
}

class VdbPieces : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Half, VdbPieces, testing::Bool());

TEST_P(VdbPieces, OneStepAndTwoGiveOpenVdbsBuffers) {
  initializeOpenVDB();
  const TemporaryFolder folder;
  const openvdb::FloatGrid::Ptr grid = someLeaves(GetParam());
  const std::string expected = buffersOf(*grid);
  ASSERT_GT(expected.size(), 2 * TailStore::kChunk);
  const auto make = [&](TailStore* store) {
    BufferPieces<openvdb::FloatTree> pieces(grid->tree(), GetParam(), vdbCompression());
    EXPECT_EQ(pieces.size(), 12u);
    std::string planned;
    if (store != nullptr) {
      tbb::parallel_for(std::size_t(0), pieces.size(),
                        [&](std::size_t i) { pieces.plan(i, *store); });
      planned = entriesOf(pieces);
    }
    std::string bytes;
    for (std::size_t i = 0; i < pieces.size(); ++i)
      bytes += pieces.make(i);
    EXPECT_TRUE(bytes == expected);
    const std::string entries = entriesOf(pieces);
    EXPECT_TRUE(planned.empty() || planned == entries);
    return entries;
  };
  const std::string entries = make(nullptr);
  TailStore inMemory(folder.path(), std::size_t(64) << 20);
  EXPECT_EQ(make(&inMemory), entries);
  TailStore inFile(folder.path(), 0);
  EXPECT_EQ(make(&inFile), entries);
  TailStore noRoom(folder / "missing", 0); // tails are compressed again
  EXPECT_EQ(make(&noRoom), entries);
}

} // namespace
} // namespace tetvdb
