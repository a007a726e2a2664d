// SPDX-License-Identifier: Apache-2.0
//
// The oracle is the definition: the nearest of all boxes of active voxels and tiles that a ray
// meets, each met on its own.
#include "tetvdb/visualize/ActiveTree.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace tetvdb {
namespace {

struct Cube {
  Vec3d low, high;
};

template <class GridT>
std::vector<Cube> cubes(const GridT& grid) {
  std::vector<Cube> result;
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    const openvdb::CoordBBox box = value.getBoundingBox();
    result.push_back({{double(box.min()[0]), double(box.min()[1]), double(box.min()[2])},
                      {box.max()[0] + 1.0, box.max()[1] + 1.0, box.max()[2] + 1.0}});
  }
  return result;
}

/// Infinity where the ray passes.
double entry(const Cube& cube, const IndexRay& ray) {
  double begin = ray.tMin, end = ray.tMax;
  for (std::size_t a = 0; a < 3; ++a) {
    if (ray.direction[a] == 0) {
      if (ray.origin[a] < cube.low[a] || ray.origin[a] >= cube.high[a])
        return INFINITY;
      continue;
    }
    const double one = (cube.low[a] - ray.origin[a]) / ray.direction[a];
    const double other = (cube.high[a] - ray.origin[a]) / ray.direction[a];
    begin = std::max(begin, std::min(one, other));
    end = std::min(end, std::max(one, other));
  }
  return begin <= end ? begin : INFINITY;
}

/// Voxels, tiles of all three sizes, negative coordinates.
template <class GridT>
typename GridT::Ptr scattered(std::mt19937& random) {
  auto grid = GridT::create();
  auto& tree = grid->tree();
  using T = typename GridT::ValueType;
  const auto value = openvdb::zeroVal<T>();
  const auto any = [&](int below) { return static_cast<int>(random() % unsigned(below)); };
  for (int n = 0; n < 60; ++n)
    tree.addTile(1, openvdb::Coord(any(96) - 48, any(96) - 48, any(96) - 48) & ~7, value, true);
  for (int n = 0; n < 3; ++n)
    tree.addTile(2, openvdb::Coord(any(600) - 300, any(600) - 300, 200 + any(300)) & ~127, value,
                 true);
  tree.addTile(3, openvdb::Coord(4096, -4096, 0), value, true);
  auto accessor = grid->getAccessor();
  for (int n = 0; n < 4000; ++n)
    accessor.setValueOn({any(120) - 60, any(120) - 60, any(120) - 60}, value);
  return grid;
}

template <class GridT>
void expectNearest(unsigned seed) {
  std::mt19937 random(seed);
  const auto grid = scattered<GridT>(random);
  const ActiveTree tree(*grid);
  const auto all = cubes(*grid);
  std::uniform_real_distribution<double> place(-500, 500), near(-60, 60);
  int hits = 0, passes = 0;
  for (int n = 0; n < 1500; ++n) {
    IndexRay ray;
    ray.origin = {place(random), place(random), place(random)};
    const Vec3d to = n % 3 == 2 ? Vec3d{4096 + 40 * near(random), -2000 + 40 * near(random), 900}
                                : Vec3d{near(random), near(random), near(random)};
    for (std::size_t a = 0; a < 3; ++a)
      ray.direction[a] = to[a] - ray.origin[a];
    if (n % 5 == 0) // along an axis, starting at a whole number
      ray = {{std::floor(ray.origin[0]), to[1], to[2]}, {n % 2 ? 1.0 : -1.0, 0, 0}, 0, 0};
    ray.tMax = n % 4 == 3 ? 0.4 : 1e6;
    double expected = INFINITY;
    for (const Cube& cube : all)
      expected = std::min(expected, entry(cube, ray));
    ActiveTree::Voxel found;
    const bool hit = tree.first(ray, found);
    ASSERT_EQ(hit, std::isfinite(expected)) << "ray " << n;
    ++(hit ? hits : passes);
    if (!hit)
      continue;
    const double scale = std::max(
        {std::abs(ray.direction[0]), std::abs(ray.direction[1]), std::abs(ray.direction[2])});
    EXPECT_NEAR(found.t * scale, expected * scale, 1e-8) << "ray " << n;
    EXPECT_TRUE(grid->tree().isValueOn({found.at[0], found.at[1], found.at[2]}));
    const Vec3d p = ray.at(found.t);
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_GE(p[a], found.at[a] - 1e-8);
      EXPECT_LE(p[a], found.at[a] + 1 + 1e-8);
    }
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(passes, 300);
}

TEST(ActiveTree, firstIsTheNearestOfAllBoxes) {
  initializeOpenVDB();
  expectNearest<openvdb::FloatGrid>(1);
  expectNearest<openvdb::BoolGrid>(2);
  expectNearest<openvdb::MaskGrid>(3);
  expectNearest<openvdb::Vec3SGrid>(4);
}

// Leaf nodes and active tiles whose inside a ray passes, from the tree's own iterators.
TEST(ActiveTree, spansOfARayAreThoseOfTheNodesThatItPasses) {
  initializeOpenVDB();
  std::mt19937 random(11);
  const auto grid = scattered<openvdb::FloatGrid>(random);
  const ActiveTree tree(*grid);
  const openvdb::CoordBBox active = grid->evalActiveVoxelBoundingBox();
  std::vector<openvdb::CoordBBox> nodes;
  const auto add = [&](openvdb::CoordBBox box) {
    box.intersect(active);
    nodes.push_back(box);
  };
  for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf)
    add(leaf->getNodeBoundingBox());
  for (auto value = grid->tree().cbeginValueOn(); value; ++value)
    if (value.isTileValue())
      add(value.getBoundingBox());
  std::uniform_real_distribution<double> far(-400, 400), near(-80, 80);
  std::size_t spans = 0;
  for (int n = 0; n < 300; ++n) {
    IndexRay ray;
    ray.origin = {far(random), far(random), far(random)};
    for (std::size_t a = 0; a < 3; ++a)
      ray.direction[a] = near(random) - ray.origin[a];
    ray.tMax = n % 3 == 0 ? 1 : 3;
    std::vector<std::array<double, 2>> expected, found;
    for (const openvdb::CoordBBox& node : nodes) {
      double begin = 0, end = ray.tMax;
      for (std::size_t a = 0; a < 3; ++a) {
        const double p = (node.min()[a] - ray.origin[a]) / ray.direction[a];
        const double q = (node.max()[a] + 1 - ray.origin[a]) / ray.direction[a];
        begin = std::max(begin, std::min(p, q));
        end = std::min(end, std::max(p, q));
      }
      if (end - begin > 1e-9)
        expected.push_back({begin, end});
    }
    std::sort(expected.begin(), expected.end());
    tree.walk(ray, [&](double begin, double end) {
      if (end - begin > 1e-9)
        found.push_back({begin, end});
      return false;
    });
    ASSERT_EQ(found.size(), expected.size()) << "ray " << n;
    for (std::size_t i = 0; i < found.size(); ++i)
      for (std::size_t k = 0; k < 2; ++k)
        EXPECT_NEAR(found[i][k], expected[i][k], 1e-9) << "ray " << n;
    spans += found.size();
  }
  EXPECT_GT(spans, 2000u);
}

TEST(ActiveTree, statesAreTheTrees) {
  initializeOpenVDB();
  std::mt19937 random(7);
  const auto grid = scattered<openvdb::FloatGrid>(random);
  const ActiveTree tree(*grid);
  ActiveTree::Probe probe(tree);
  std::uniform_int_distribution<int> place(-70, 70), far(-5000, 9000);
  int on = 0;
  for (int n = 0; n < 200000; ++n) {
    const Vec3i v = n % 4 ? Vec3i{place(random), place(random), place(random)}
                          : Vec3i{far(random), far(random), far(random)};
    const bool is = grid->tree().isValueOn({v[0], v[1], v[2]});
    ASSERT_EQ(tree.isOn(v), is);
    ASSERT_EQ(probe.isOn(v), is);
    on += is;
  }
  EXPECT_GT(on, 1000);
}

// Also in tiles, across nodes of all sizes and where nothing is.
TEST(ActiveTree, sharesOfRowsAreThoseOfTheVoxels) {
  initializeOpenVDB();
  std::mt19937 random(8);
  const auto grid = scattered<openvdb::BoolGrid>(random);
  const ActiveTree tree(*grid);
  ActiveTree::Probe probe(tree);
  auto states = grid->getConstAccessor();
  std::array<int, 3> partly{};
  for (int log2Side = 1; log2Side <= 3; ++log2Side) {
    const int side = 1 << log2Side;
    std::uniform_int_distribution<int> place(-144 / side, 144 / side),
        far(-5000 / side, 5000 / side);
    for (int n = 0; n < 40000 >> 2 * (log2Side - 1); ++n) {
      const Vec3i cell = n % 8 ? Vec3i{place(random), place(random), place(random)}
                               : Vec3i{far(random), far(random), far(random)};
      const auto shares = probe.filled(cell, log2Side);
      for (int k = 0; k < 4; ++k) {
        int on = 0;
        for (int x = 0; x < side; ++x)
          for (int y = 0; y < side; ++y)
            for (int z = 0; z < side; ++z)
              on += states.isValueOn(
                  {cell[0] * side + x, cell[1] * side + y, (cell[2] + k) * side + z});
        ASSERT_EQ(shares[std::size_t(k)], double(on) / (side * side * side));
        partly[std::size_t(log2Side) - 1] += on > 0 && on < side * side * side;
      }
    }
  }
  for (const int count : partly)
    EXPECT_GT(count, 100);
}

TEST(ActiveTree, ofAnEmptyTreeNothingIsFound) {
  initializeOpenVDB();
  const auto grid = openvdb::FloatGrid::create();
  const ActiveTree tree(*grid);
  ActiveTree::Voxel found;
  EXPECT_FALSE(tree.first({{0, 0, -5}, {0, 0, 1}, 0, 100}, found));
  EXPECT_FALSE(tree.isOn({0, 0, 0}));
  EXPECT_GT(tree.low()[0], tree.high()[0]);
}

} // namespace
} // namespace tetvdb
