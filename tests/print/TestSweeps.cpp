// SPDX-License-Identifier: Apache-2.0
//
// Islands, cups and traps of random stacks, against flood fills of every prefix.
#include "DenseLayers.h"
#include "tetvdb/print/CavitySweep.h"
#include "tetvdb/print/IslandSweep.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <string>

namespace tetvdb {
namespace {

using Step = std::array<std::int32_t, 3>;

std::vector<Step> stepsOf(Neighbours neighbours) {
  std::vector<Step> steps = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  if (neighbours == Neighbours::Eight)
    for (const std::int32_t x : {-1, 1})
      for (const std::int32_t y : {-1, 1})
        steps.push_back({x, y, 0});
  return steps;
}

// Components of the solid, or of the void, of layers 0 to top: of each voxel a number, -1 for
// others. Of the void, what is connected with the outside at the sides is number 0.
std::vector<int> flood(const DenseStack& stack, std::int32_t top, bool solid,
                       Neighbours neighbours) {
  const std::vector<Step> steps = stepsOf(neighbours);
  std::vector<int> numbers(stack.solid.size(), -1);
  int next = solid ? 0 : 1;
  const auto spread = [&](std::vector<Step> stack3, int number) {
    while (!stack3.empty()) {
      const Step p = stack3.back();
      stack3.pop_back();
      for (const Step& s : steps) {
        const Step q = {p[0] + s[0], p[1] + s[1], p[2] + s[2]};
        if (!stack.has(q[0], q[1], q[2]) || q[2] > top || stack.at(q[0], q[1], q[2]) != solid ||
            numbers[stack.index(q[0], q[1], q[2])] >= 0)
          continue;
        numbers[stack.index(q[0], q[1], q[2])] = number;
        stack3.push_back(q);
      }
    }
  };
  if (!solid) {
    std::vector<Step> around; // places beside the box
    for (std::int32_t z = 0; z <= top; ++z)
      for (std::int32_t y = -1; y <= stack.height; ++y)
        for (std::int32_t x = -1; x <= stack.width; ++x)
          if (x < 0 || y < 0 || x == stack.width || y == stack.height)
            around.push_back({x, y, z});
    spread(around, 0);
  }
  for (std::int32_t z = 0; z <= top; ++z)
    for (std::int32_t y = 0; y < stack.height; ++y)
      for (std::int32_t x = 0; x < stack.width; ++x)
        if (stack.at(x, y, z) == solid && numbers[stack.index(x, y, z)] < 0) {
          numbers[stack.index(x, y, z)] = next;
          spread({{x, y, z}}, next++);
        }
  return numbers;
}

LayerFrame unitFrame(const DenseStack& stack) {
  return DenseSource(stack, 1, 1, 1).frame();
}

class Sweeps : public testing::TestWithParam<Neighbours> {};

INSTANTIATE_TEST_SUITE_P(All, Sweeps, testing::Values(Neighbours::Four, Neighbours::Eight));

void compareCups(Neighbours neighbours, int seed, std::size_t& count) {
  std::mt19937 random(static_cast<unsigned>(seed));
  const double share = 0.45 + 0.009 * seed;
  const DenseStack stack = randomStack(random, 9, 8, 7, share);
  CavitySweep sweep(unitFrame(stack));
  LayerComponents below;
  for (std::int32_t k = 0; k < stack.layers; ++k) {
    LayerComponents layer = componentsOf(stack.rows(k), neighbours);
    sweep.add(layer.gaps, k == 0 ? std::vector<LayerContact>() : voidContacts(below, layer));
    below = std::move(layer);
    // By component: voxels, and pixels in layer k.
    const std::vector<int> numbers = flood(stack, k, false, complementOf(neighbours));
    std::map<int, std::pair<double, std::int64_t>> sizes;
    for (std::int32_t z = 0; z <= k; ++z)
      for (std::int32_t y = 0; y < stack.height; ++y)
        for (std::int32_t x = 0; x < stack.width; ++x)
          if (const int number = numbers[stack.index(x, y, z)]; number > 0) {
            sizes[number].first += 1;
            sizes[number].second += z == k ? 1 : 0;
          }
    std::multiset<std::pair<double, std::int64_t>> expected, found;
    for (const auto& [number, size] : sizes)
      if (size.second > 0)
        expected.insert(size);
    std::vector<std::int64_t> inLayer(sweep.open().size(), 0);
    for (std::size_t label = 1; label < below.gaps.shapes.size(); ++label)
      if (sweep.openOf()[label] != CavitySweep::kOutside)
        inLayer[sweep.openOf()[label]] += below.gaps.shapes[label].pixels;
    for (std::size_t i = 0; i < inLayer.size(); ++i)
      found.insert({sweep.open()[i].voxels, inLayer[i]});
    ASSERT_EQ(found, expected) << "layer " << k;
    count += expected.size();
  }
}

void compareTraps(Neighbours neighbours, int seed, std::size_t& count) {
  std::mt19937 random(static_cast<unsigned>(1000 + seed));
  DenseStack stack = randomStack(random, 8, 7, 8, 0.5 + 0.005 * seed);
  CavitySweep sweep(unitFrame(stack));
  LayerComponents below;
  for (std::int32_t k = 0; k < stack.layers; ++k) {
    LayerComponents layer = componentsOf(stack.rows(k), neighbours);
    sweep.add(layer.gaps, k == 0 ? std::vector<LayerContact>() : voidContacts(below, layer));
    below = std::move(layer);
  }
  sweep.finish();
  // With a layer of void above; below is the plate.
  DenseStack higher(stack.width, stack.height, stack.layers + 1);
  std::copy(stack.solid.begin(), stack.solid.end(), higher.solid.begin());
  const std::vector<int> numbers = flood(higher, stack.layers, false, complementOf(neighbours));
  struct Trap {
    double voxels = 0;
    std::int32_t first = 1 << 20, last = -1;
    bool operator<(const Trap& o) const {
      return std::tie(voxels, first, last) < std::tie(o.voxels, o.first, o.last);
    }
    bool operator==(const Trap& o) const {
      return std::tie(voxels, first, last) == std::tie(o.voxels, o.first, o.last);
    }
  };
  std::map<int, Trap> traps;
  for (std::int32_t z = 0; z < stack.layers; ++z)
    for (std::int32_t y = 0; y < stack.height; ++y)
      for (std::int32_t x = 0; x < stack.width; ++x)
        if (const int number = numbers[higher.index(x, y, z)]; number > 0) {
          Trap& trap = traps[number];
          trap.voxels += 1;
          trap.first = std::min(trap.first, z);
          trap.last = std::max(trap.last, z);
        }
  std::multiset<Trap> expected, found;
  for (const auto& [number, trap] : traps)
    expected.insert(trap);
  for (const LayerCavity& cavity : sweep.cavities())
    if (cavity.end == LayerCavity::End::Closed) {
      found.insert({cavity.voxels, cavity.first, cavity.last});
      EXPECT_EQ(cavity.onPlate, cavity.first == 0);
      EXPECT_EQ(numbers[higher.index(cavity.largest.x, cavity.largest.y, cavity.largestLayer)] > 0,
                true);
    }
  EXPECT_TRUE(found == expected) << found.size() << " for " << expected.size();
  count += expected.size();
}

void compareIslands(Neighbours neighbours, int seed, std::size_t& count) {
  std::mt19937 random(static_cast<unsigned>(2000 + seed));
  const DenseStack stack = randomStack(random, 10, 9, 7, 0.15 + 0.007 * seed);
  IslandSweep sweep;
  LabelledSpans below;
  for (std::int32_t k = 0; k < stack.layers; ++k) {
    LabelledSpans layer = labelled(stack.rows(k), neighbours);
    sweep.add(layer, k == 0 ? std::vector<LayerContact>() : solidContacts(below, layer));
    below = std::move(layer);
  }
  std::vector<std::vector<int>> prefix;
  for (std::int32_t k = 0; k < stack.layers; ++k)
    prefix.push_back(flood(stack, k, true, neighbours));
  // By the first voxel of a component of one layer: pixels, and the layer in which it joins.
  struct Found {
    std::int32_t layer;
    std::int64_t pixels;
    std::int32_t joins, last;
    std::int64_t largest;
    bool operator<(const Found& o) const {
      return std::tie(layer, pixels, joins, last, largest) <
             std::tie(o.layer, o.pixels, o.joins, o.last, o.largest);
    }
  };
  std::multiset<Found> expected, found;
  for (std::int32_t k = 1; k < stack.layers; ++k) {
    DenseStack one(stack.width, stack.height, 1);
    for (std::int32_t y = 0; y < stack.height; ++y)
      for (std::int32_t x = 0; x < stack.width; ++x)
        one.solid[one.index(x, y, 0)] = stack.at(x, y, k);
    const std::vector<int> components = flood(one, 0, true, neighbours);
    std::map<int, std::vector<Step>> voxels;
    for (std::int32_t y = 0; y < stack.height; ++y)
      for (std::int32_t x = 0; x < stack.width; ++x)
        if (components[one.index(x, y, 0)] >= 0)
          voxels[components[one.index(x, y, 0)]].push_back({x, y, k});
    for (const auto& [number, all] : voxels) {
      if (std::any_of(all.begin(), all.end(),
                      [&](const Step& p) { return stack.at(p[0], p[1], k - 1); }))
        continue;
      Found island{k, static_cast<std::int64_t>(all.size()), -1, k, 0};
      for (std::int32_t top = k; top < stack.layers && island.joins < 0; ++top) {
        const auto& numbers = prefix[static_cast<std::size_t>(top)];
        const int body = numbers[stack.index(all[0][0], all[0][1], k)];
        std::int64_t inLayer = 0;
        bool stands = false;
        for (std::int32_t y = 0; y < stack.height; ++y)
          for (std::int32_t x = 0; x < stack.width; ++x) {
            stands = stands || numbers[stack.index(x, y, 0)] == body;
            inLayer += numbers[stack.index(x, y, top)] == body ? 1 : 0;
          }
        if (stands)
          island.joins = top;
        else if (inLayer > 0)
          island.last = top;
        if (!stands)
          island.largest = std::max(island.largest, inLayer);
      }
      expected.insert(island);
    }
  }
  for (const Island& island : sweep.islands()) {
    found.insert(
        {island.layer, island.shape.pixels, island.joins, island.last, island.largestPixels});
    EXPECT_TRUE(stack.at(island.shape.x, island.shape.y, island.layer));
  }
  EXPECT_EQ(found.size(), expected.size());
  count += expected.size();
  EXPECT_TRUE(std::equal(found.begin(), found.end(), expected.begin(), expected.end(),
                         [](const Found& a, const Found& b) { return !(a < b) && !(b < a); }));
}

TEST_P(Sweeps, CupsAreThoseOfEveryPrefix) {
  std::size_t count = 0;
  for (int seed = 0; seed < 60 && !HasFailure(); ++seed)
    compareCups(GetParam(), seed, count);
  EXPECT_GT(count, 100u);
}

TEST_P(Sweeps, TrapsAreThoseOfTheWhole) {
  std::size_t count = 0;
  for (int seed = 0; seed < 60 && !HasFailure(); ++seed)
    compareTraps(GetParam(), seed, count);
  EXPECT_GT(count, 100u);
}

TEST_P(Sweeps, IslandsJoinWhereTheSolidBelowDoes) {
  std::size_t count = 0;
  for (int seed = 0; seed < 60 && !HasFailure(); ++seed)
    compareIslands(GetParam(), seed, count);
  EXPECT_GT(count, 100u);
}

} // namespace
} // namespace tetvdb
