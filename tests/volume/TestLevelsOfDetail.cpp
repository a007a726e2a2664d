// SPDX-License-Identifier: Apache-2.0
//
// Levels of detail against sums over the voxels that theirs cover, one by one.
#include "tetvdb/core/Error.h"
#include "tetvdb/volume/BitLevels.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/LevelsOfDetail.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <openvdb/math/Maps.h>
#include <random>
#include <set>

namespace tetvdb {
namespace {

using openvdb::Coord;

class LevelsOfDetail : public ::testing::Test {
protected:
  void SetUp() override { initializeOpenVDB(); }

  openvdb::GridPtrVec levelsOf(const openvdb::GridBase::Ptr& grid, const LevelRange& levels,
                               std::size_t maxMemory = 0) {
    Volume volume;
    volume.grids().all.push_back(grid);
    addLevels(volume, levels, maxMemory, progress_);
    EXPECT_EQ(volume.grids().all.front(), grid);
    return {volume.grids().all.begin() + 1, volume.grids().all.end()};
  }

  Progress progress_;
};

// Tiles of all levels, of which some are inactive, and voxels about the corners of nodes.
template <class GridT, class Value>
typename GridT::Ptr anything(const Value& value, unsigned seed) {
  auto grid = GridT::create(openvdb::zeroVal<typename GridT::ValueType>());
  grid->setName("a");
  std::mt19937 random(seed);
  auto& tree = grid->tree();
  tree.addTile(3, Coord(4096, -4096, 0), value(1), true);
  const auto any = [&](int step) {
    return (int(random() % (1024u / unsigned(step))) - 512 / step) * step;
  };
  for (int i = 0; i < 20; ++i) {
    tree.addTile(2, Coord(any(128), any(128), any(128)), value(i), i % 3 != 0);
    tree.addTile(1, Coord(any(8), any(8), any(8)), value(i), i % 4 != 0);
  }
  for (int i = 0; i < 4000; ++i)
    tree.setValue(Coord(any(1) / 8, any(1) / 16, any(1) / 8), value(i));
  for (int i = 0; i < 500; ++i)
    tree.setValueOff(Coord(any(1) / 8, any(1) / 16, any(1) / 8), value(i));
  return grid;
}

// Coarse voxels to look at: those around all entries of the grid.
template <class GridT>
std::set<Coord> placesOf(const GridT& grid, int k) {
  std::set<Coord> places;
  std::mt19937 random(7);
  for (auto entry = grid.cbeginValueOn(); entry; ++entry) {
    openvdb::CoordBBox box;
    entry.getBoundingBox(box);
    if (entry.isVoxelValue() && random() % 16 != 0)
      continue;
    for (const Coord& at :
         {box.min(), box.max(), box.min().offsetBy(-1, 0, 0), box.max().offsetBy(0, 1, 1)})
      places.insert(Coord(at.x() >> k, at.y() >> k, at.z() >> k));
  }
  return places;
}

template <class GridT, class LevelGrid, class Sum, class Expect>
void expectMeans(const GridT& grid, const LevelGrid& level, int k, const Sum& zero,
                 const Expect& expect) {
  auto fine = grid.getConstAccessor();
  auto coarse = level.getConstAccessor();
  std::size_t some = 0;
  for (const Coord& at : placesOf(grid, k)) {
    Sum sum = zero;
    int active = 0;
    const int side = 1 << k;
    for (int x = 0; x < side; ++x)
      for (int y = 0; y < side; ++y)
        for (int z = 0; z < side; ++z) {
          typename GridT::ValueType value;
          if (!fine.probeValue(Coord(at.x() * side + x, at.y() * side + y, at.z() * side + z),
                               value))
            continue;
          sum += Sum(value);
          ++active;
        }
    typename LevelGrid::ValueType found;
    ASSERT_EQ(coarse.probeValue(at, found), active > 0) << at << " of level " << k;
    expect(found, sum, active, at);
    some += active > 0 ? 1 : 0;
  }
  EXPECT_GT(some, 10u);
}

TEST_F(LevelsOfDetail, SharesOfMasksAreExact) {
  const auto mask = anything<openvdb::BoolGrid>([](int) { return true; }, 1);
  const auto levels = levelsOf(mask, {1, 5});
  ASSERT_EQ(levels.size(), 5u);
  for (int k = 1; k <= 5; ++k) {
    const auto level = std::dynamic_pointer_cast<openvdb::FloatGrid>(levels[std::size_t(k - 1)]);
    ASSERT_TRUE(level);
    EXPECT_EQ(level->getName(), "a_level_" + std::to_string(k));
    EXPECT_EQ(level->getGridClass(), openvdb::GRID_FOG_VOLUME);
    expectMeans(*mask, *level, k, 0.0, [&](float found, double, int active, const Coord& at) {
      EXPECT_EQ(found, float(active / std::ldexp(1.0, 3 * k))) << at << " of level " << k;
    });
  }
}

TEST_F(LevelsOfDetail, SumsOfAllLevelsAreEqual) {
  const auto mask = anything<openvdb::MaskGrid>([](int) { return true; }, 2);
  const double voxels = double(mask->activeVoxelCount());
  int k = 0;
  for (const auto& grid : levelsOf(mask, {1, 12})) {
    ++k;
    double sum = 0; // a voxel of level 12 has up to 2^36 voxels, of which a float keeps 24 bits
    for (auto entry = static_cast<openvdb::FloatGrid&>(*grid).cbeginValueOn(); entry; ++entry)
      sum += double(*entry) * double(entry.getVoxelCount());
    sum *= std::ldexp(1.0, 3 * k);
    EXPECT_NEAR(sum, voxels, k <= 7 ? 0 : voxels * std::ldexp(1.0, -24)) << k;
  }
}

TEST_F(LevelsOfDetail, FogIsAveragedOverAllAndOthersOverActiveVoxels) {
  const auto value = [](int i) { return float(i % 100) / 64 - 0.25F; }; // exact sums
  for (const bool fog : {true, false}) {
    const auto grid = anything<openvdb::FloatGrid>(value, 3);
    grid->setName(fog ? "density" : "temperature");
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    grid->insertMeta("unit", openvdb::StringMetadata("K"));
    const auto levels = levelsOf(grid, {1, 4});
    for (int k = 1; k <= 4; ++k) {
      const auto& level = static_cast<const openvdb::FloatGrid&>(*levels[std::size_t(k - 1)]);
      EXPECT_EQ(level.getGridClass(), grid->getGridClass());
      EXPECT_EQ(level.getMetadata<openvdb::StringMetadata>("unit") != nullptr, !fog);
      expectMeans(*grid, level, k, 0.0, [&](float found, double sum, int active, const Coord& at) {
        if (active > 0) {
          EXPECT_EQ(found, float(sum / (fog ? std::ldexp(1.0, 3 * k) : active))) << at << " " << k;
        }
      });
    }
  }
}

TEST_F(LevelsOfDetail, Vectors) {
  const auto grid = anything<openvdb::Vec3SGrid>(
      [](int i) { return openvdb::Vec3s(float(i % 50) / 32, -float(i % 7), 1); }, 4);
  const auto levels = levelsOf(grid, {2, 3});
  for (int k = 2; k <= 3; ++k) {
    const auto& level = static_cast<const openvdb::Vec3SGrid&>(*levels[std::size_t(k - 2)]);
    expectMeans(
        *grid, level, k, openvdb::Vec3d(0),
        [&](const openvdb::Vec3s& found, const openvdb::Vec3d& sum, int active, const Coord& at) {
          if (active > 0) {
            EXPECT_EQ(found, openvdb::Vec3s(sum / active)) << at;
          }
        });
  }
}

TEST_F(LevelsOfDetail, TransformsKeepThePlace) {
  const auto expectPlace = [&](const openvdb::math::Transform::Ptr& transform) {
    const auto grid = openvdb::BoolGrid::create(false);
    grid->setName("a");
    grid->tree().setValue(Coord(5, 6, 7), true);
    grid->setTransform(transform);
    const auto levels = levelsOf(grid, {1, 6});
    for (int k = 1; k <= 6; ++k)
      for (const Coord& at : {Coord(0, 0, 0), Coord(-3, 4, 5)}) {
        const double side = std::ldexp(1.0, k);
        const openvdb::Vec3d middle = at.asVec3d() * side + openvdb::Vec3d((side - 1) / 2);
        const openvdb::Vec3d wanted = transform->indexToWorld(middle);
        const openvdb::Vec3d found = levels[std::size_t(k - 1)]->indexToWorld(at);
        EXPECT_NEAR((wanted - found).length(), 0, 1e-12 * wanted.length() + 1e-300);
      }
  };
  expectPlace(makeTransform({{1, 1, 1}, {0, 0, 0}}));
  expectPlace(makeTransform({{0.1, 0.2, 0.3}, {5, -7, 11}}));
  openvdb::Mat4d turned = openvdb::Mat4d::identity();
  turned.setToRotation(openvdb::math::X_AXIS, 0.3);
  turned.postScale(openvdb::Vec3d(0.5, 2, 1));
  turned.postTranslate(openvdb::Vec3d(1, 2, 3));
  expectPlace(openvdb::math::Transform::createLinearTransform(turned));
}

TEST_F(LevelsOfDetail, WhatHasNoMeanIsRefused) {
  const auto refused = [&](const openvdb::GridBase::Ptr& grid) {
    grid->setName("a");
    Volume volume;
    volume.grids().all.push_back(grid);
    EXPECT_THROW(addLevels(volume, {1, 2}, 0, progress_), Error);
    EXPECT_EQ(volume.grids().all.size(), 1u);
  };
  refused(openvdb::Int32Grid::create(-1));
  const auto levelSet = openvdb::FloatGrid::create(3);
  levelSet->setGridClass(openvdb::GRID_LEVEL_SET);
  refused(levelSet);
  const auto frustum = openvdb::FloatGrid::create(0);
  frustum->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 2));
  refused(frustum);
  for (const LevelRange& levels : {LevelRange{0, 2}, LevelRange{3, 2}, LevelRange{1, 13}})
    EXPECT_THROW(checkLevels(levels), Error);
}

TEST_F(LevelsOfDetail, MemoryIsBounded) {
  const auto mask = anything<openvdb::MaskGrid>([](int) { return true; }, 5);
  try {
    levelsOf(mask, {1, 1}, 10000);
    FAIL() << "10 kB are not enough";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Limit);
  }
  EXPECT_EQ(levelsOf(mask, {9, 12}, 100000).size(), 4u);
}

// Random nodes in two cubes, and a full one, as bits and as a tree.
class Bits : public BitSource {
public:
  explicit Bits(unsigned seed) : random_(seed) {
    cubes_ = {{{-4096, 0, 4096}, false}, {{0, 0, 0}, false}, {{0, 4096, 0}, true}};
    made_.resize(cubes_.size());
    for (std::size_t c = 0; c < 2; ++c)
      for (int i = 0; i < 12; ++i)
        add(c, int(random_() % 1024), random_() % 32);
    auto& tree = grid->tree();
    tree.addTile(3, Coord(0, 4096, 0), true, true);
  }

  const std::vector<RootCube>& cubes() const override { return cubes_; }
  std::vector<int> begin(std::size_t cube) override {
    cube_ = cube;
    std::vector<int> stacks;
    for (const auto& [stack, bits] : made_[cube])
      stacks.push_back(stack);
    return stacks;
  }
  void fill(int stack, BitStack& out) override {
    const BitStack& bits = made_[cube_].at(stack);
    out.states = bits.states;
    for (std::size_t z = 0; z < out.nodes.size(); ++z)
      if (bits.nodes[z])
        out.nodes[z] = std::make_unique<BitNode>(*bits.nodes[z]);
  }

  openvdb::MaskGrid::Ptr grid = openvdb::MaskGrid::create();

private:
  void add(std::size_t cube, int stack, std::size_t z) {
    BitStack& bits = made_[cube][stack];
    if (bits.states[z] != NodeState::Empty)
      return;
    const Vec3i& o = cubes_[cube].origin;
    const Coord origin(o[0] + stack / 32 * 128, o[1] + stack % 32 * 128, o[2] + int(z) * 128);
    auto& tree = grid->tree();
    if (random_() % 4 == 0) {
      bits.states[z] = NodeState::Full;
      tree.addTile(2, origin, true, true);
      return;
    }
    bits.states[z] = NodeState::Mixed;
    bits.nodes[z] = std::make_unique<BitNode>();
    BitNode& node = *bits.nodes[z];
    for (int n = 0; n < 4096; ++n) {
      const Coord corner = origin.offsetBy((n >> 8) * 8, (n >> 4 & 15) * 8, (n & 15) * 8);
      const unsigned what = random_() % 16;
      const std::uint64_t bit = std::uint64_t(1) << (n & 63);
      if (what == 0) {
        node.tiles[std::size_t(n) >> 6] |= bit;
        tree.addTile(1, corner, true, true);
      }
      if (what != 1)
        continue;
      node.children[std::size_t(n) >> 6] |= bit;
      for (int x = 0; x < 8; ++x) {
        const std::uint64_t word = std::uint64_t(random_()) << 32 | random_();
        node.leaves.push_back(word);
        for (int i = 0; i < 64; ++i)
          if ((word >> i & 1) != 0)
            tree.setValueOn(corner.offsetBy(x, i >> 3, i & 7));
      }
    }
  }

  std::mt19937 random_;
  std::vector<RootCube> cubes_;
  std::vector<std::map<int, BitStack>> made_;
  std::size_t cube_ = 0;
};

TEST_F(LevelsOfDetail, BitsGiveWhatATreeGives) {
  Bits bits(6);
  bits.grid->setName("a");
  const auto expected = levelsOf(bits.grid, {1, 12});
  BitLevels levels(bits, {1, 12}, std::numeric_limits<std::size_t>::max());
  for (int pass = 0; pass < 2; ++pass) // the second counts anew
    for (std::size_t c = 0; c < 2; ++c)
      for (const int stack : levels.begin(c)) {
        BitStack out;
        levels.fill(stack, out);
      }
  const auto found = levels.finish({bits.grid});
  ASSERT_EQ(found.size(), expected.size());
  Volume a, b;
  a.grids().all = found;
  b.grids().all = expected;
  EXPECT_EQ(hash(a), hash(b));
  EXPECT_EQ(describe(a)[0].activeVoxels, describe(b)[0].activeVoxels);
  EXPECT_GT(describe(a)[0].leaves, 100u);
}

} // namespace
} // namespace tetvdb
