// SPDX-License-Identifier: Apache-2.0
//
// Assembles 128^3 nodes that tasks have built independently into one tree, without locks and
// merging. Internal.
#pragma once

#include "tetvdb/geometry/NodeIndex.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tuple>
#include <utility>
#include <vector>

namespace tetvdb {

/// Nodes (x, y, z) with zBegin <= z < zEnd.
struct NodeRun {
  std::int32_t x, y, zBegin, zEnd;
};

/// Takes finished lower nodes and tiles in their place, from any thread, and makes the tree. The
/// order in which they arrive has no influence.
template <typename TreeType>
class TreeAssembly {
public:
  using Upper = typename TreeType::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  using Value = typename TreeType::ValueType;

  explicit TreeAssembly(const Value& background) : background_(background) {}
  TreeAssembly(const TreeAssembly&) = delete;
  TreeAssembly& operator=(const TreeAssembly&) = delete;
  ~TreeAssembly() {
    for (Part& part : collect())
      delete part.node;
  }

  /// An empty node for a task to fill.
  std::unique_ptr<Lower> begin(const NodeIndex& node) const {
    return std::make_unique<Lower>(
        openvdb::Coord(node[0] * kNodeSize, node[1] * kNodeSize, node[2] * kNodeSize), background_,
        false);
  }

  /// Takes the filled node. A node that is full of one value becomes a tile; it is dropped if that
  /// is the background, inactive.
  void end(std::unique_ptr<Lower> lower, const NodeIndex& index) {
    Value value{};
    bool active = false;
    if (lower->getChildMask().isOff() && lower->isConstant(value, active)) {
      if (active || value != background_)
        parts_.local().push_back({index, nullptr, value, active});
      return;
    }
    parts_.local().push_back({index, lower.release(), Value{}, false});
  }

  /// A node all of whose voxels are active and have one value.
  void tile(const NodeIndex& index, const Value& value) {
    parts_.local().push_back({index, nullptr, value, true});
  }
  /// Many of them.
  void tiles(const NodeRun& run, const Value& value) { runs_.local().push_back({run, value}); }

  /// The grid; call once, after the last node.
  typename openvdb::Grid<TreeType>::Ptr
  finish(const std::string& name, openvdb::GridClass gridClass, const GridTransform& transform) {
    // Upper nodes by origin, each with the nodes and runs inside it.
    struct UpperParts {
      std::vector<Part> parts;
      std::vector<ValueRun> runs;
    };
    std::map<std::tuple<int, int, int>, UpperParts> uppers;
    const auto upperOf = [](std::int32_t node) { return node >> 5; };
    for (const Part& part : collect())
      uppers[{upperOf(part.index[0]), upperOf(part.index[1]), upperOf(part.index[2])}]
          .parts.push_back(part);
    parts_.clear();
    for (const auto& local : runs_)
      for (const ValueRun& all : local) {
        const NodeRun& run = all.run;
        for (std::int32_t z = run.zBegin; z < run.zEnd;) {
          const std::int32_t end = std::min((upperOf(z) + 1) * kChildrenPerAxis, run.zEnd);
          uppers[{upperOf(run.x), upperOf(run.y), upperOf(z)}].runs.push_back(
              {{run.x, run.y, z, end}, all.value});
          z = end;
        }
      }
    runs_.clear();

    std::vector<std::pair<openvdb::Coord, const UpperParts*>> list;
    list.reserve(uppers.size());
    for (const auto& [key, parts] : uppers)
      list.emplace_back(openvdb::Coord(std::get<0>(key) * kRootChildSize,
                                       std::get<1>(key) * kRootChildSize,
                                       std::get<2>(key) * kRootChildSize),
                        &parts);
    std::vector<std::unique_ptr<Upper>> nodes(list.size());
    struct Tile {
      Value value{};
      bool active = false;
    };
    std::vector<Tile> tiles(list.size()); // where the upper node is one
    tbb::parallel_for(std::size_t(0), list.size(), [&](std::size_t i) {
      auto upper = std::make_unique<Upper>(list[i].first, background_, false);
      for (const ValueRun& all : list[i].second->runs)
        for (std::int32_t z = all.run.zBegin; z < all.run.zEnd; ++z)
          upper->addTile(offsetInUpper({all.run.x, all.run.y, z}), all.value, true);
      for (const Part& part : list[i].second->parts) {
        if (part.node != nullptr)
          upper->addChild(part.node);
        else
          upper->addTile(offsetInUpper(part.index), part.value, part.active);
      }
      Tile& tile = tiles[i];
      if (!upper->getChildMask().isOff() || !upper->isConstant(tile.value, tile.active))
        nodes[i] = std::move(upper);
    });

    auto tree = std::make_shared<TreeType>(background_);
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (nodes[i])
        tree->root().addChild(nodes[i].release());
      else
        tree->root().addTile(list[i].first, tiles[i].value, tiles[i].active);
    }
    auto grid = openvdb::Grid<TreeType>::create(tree);
    grid->setName(name);
    grid->setGridClass(gridClass);
    grid->setTransform(makeTransform(transform));
    return grid;
  }

private:
  static constexpr std::int32_t kChildrenPerAxis = kRootChildSize / kNodeSize; // of an upper node

  // A lower node, or a tile in its place where node is null.
  struct Part {
    NodeIndex index;
    Lower* node;
    Value value;
    bool active;
  };
  struct ValueRun {
    NodeRun run;
    Value value;
  };

  std::vector<Part> collect() const {
    std::vector<Part> all;
    for (const auto& local : parts_)
      all.insert(all.end(), local.begin(), local.end());
    return all;
  }

  static openvdb::Index offsetInUpper(const NodeIndex& node) {
    const auto local = [](std::int32_t v) {
      return static_cast<openvdb::Index>(v & (kChildrenPerAxis - 1));
    };
    return local(node[0]) << 10 | local(node[1]) << 5 | local(node[2]);
  }

  Value background_;
  tbb::enumerable_thread_specific<std::vector<Part>> parts_;
  tbb::enumerable_thread_specific<std::vector<ValueRun>> runs_;
};

} // namespace tetvdb
