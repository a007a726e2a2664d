// SPDX-License-Identifier: Apache-2.0
//
// What the parts of a grid add up to: its counts, the tiles of its root and the upper node of the
// cube under way. Common to all spools of grids. Internal: instantiates OpenVDB.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/AddCounts.h"
#include "tetvdb/io/volume/GridSpool.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/VoxelBounds.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace tetvdb {

/// `Base`: GridSpool or an interface that adds to it.
template <class GridT, class Base>
class JoinedParts : public Base {
protected:
  using TreeT = typename GridT::TreeType;
  using T = typename TreeT::ValueType;
  using Lists = NodeLists<TreeT>;
  using Upper = typename Lists::Upper;
  using Lower = typename Lists::Lower;
  using ChildMask = typename Upper::NodeMaskType;

  JoinedParts(const openvdb::GridBase::Ptr& empty, const SpoolOptions& options)
      : exact_(options.exact), opensFirst_(options.openFirstTile), info_(describeOne(empty)),
        background_(static_cast<const GridT&>(*empty).background()) {}

  /// The nodes of a part, which are counted.
  virtual void takeNodes(const TreeT& tree, const Lists& nodes) = 0;
  /// The upper node of a cube: its tiles, and which of its entries are the lower nodes that were
  /// taken since the one before.
  virtual void takeUpper(const Upper& upper, const ChildMask& children) = 0;
  /// A cube of one value.
  virtual void takeTile(const openvdb::Coord& origin, const T& value, bool active) = 0;
  /// The grid's one leaf, in a lower node, which `tree` has alone: of those that were taken it
  /// replaces the one at `place`, or comes before that where it is new. Only where the options ask
  /// for openFirstTile.
  virtual void takeOpened(const TreeT& /*tree*/, std::size_t /*place*/, bool /*isNew*/) {}

public:
  void beginCube(const Vec3i& origin) override {
    origin_ = openvdb::Coord(origin[0], origin[1], origin[2]);
    whole_.reset();
    hasUpper_ = false;
    entries_.clear();
    children_ = {};
    countedTiles_ = 0;
  }

  void add(const openvdb::GridBase::Ptr& part) override {
    TreeT& tree = static_cast<GridT&>(*part).tree();
    if (opened_ && tree.isValueOn(*opened_))
      tree.touchLeaf(*opened_);
    const Lists nodes(tree);
    count(part, nodes);
    takeTiles(tree);
    if (leaves_ >= std::numeric_limits<std::uint32_t>::max())
      throw Error(Status::Limit, "", "a grid would have 2^32 leaves or more",
                  "OpenVDB cannot count them: write parts with `shard`");
    takeNodes(tree, nodes);
  }

  void endCube() override {
    if (opensFirst_ && firstTile_ && leaves_ == 0)
      openFirst();
    if (whole_) {
      if (exact_ || isEntry(*whole_))
        takeTile(origin_, whole_->value, whole_->active);
      return;
    }
    if (!hasUpper_)
      return;
    const auto upper = std::make_unique<Upper>(origin_, background_, false);
    for (const auto& [place, tile] : entries_)
      upper->addTile(place, tile.value, tile.active);
    Tile all{};
    if (!exact_ && children_.isOff() && upper->isConstant(all.value, all.active)) {
      if (all.active)
        info_.activeTiles = info_.activeTiles + 1 - countedTiles_;
      if (isEntry(all))
        takeTile(origin_, all.value, all.active);
    } else {
      ++uppers_;
      takeUpper(*upper, children_);
    }
  }

  std::optional<Vec3i> tileAlone() const override {
    return leaves_ == 0 ? firstTile_ : std::nullopt;
  }
  void open(const Vec3i& tile) override { opened_.emplace(tile[0], tile[1], tile[2]); }

  GridInfo describe() const override {
    GridInfo info = info_;
    info.leaves = leaves_;
    info.bytes += uppers_ * sizeof(Upper);
    if (info.activeVoxels > 0) {
      info.boxMin = box_.min;
      info.boxMax = box_.max;
    }
    return info;
  }

protected:
  const T& background() const { return background_; }
  const VoxelBounds& box() const { return box_; }
  std::uint64_t activeVoxels() const { return info_.activeVoxels; }
  std::uint64_t leaves() const { return leaves_; }
  std::uint64_t lowers() const { return lowers_; }
  std::uint64_t uppers() const { return uppers_; }

private:
  struct Tile {
    T value;
    bool active;
  };

  /// Whether a node has it for itself.
  bool isEntry(const Tile& tile) const {
    return tile.active || std::memcmp(&tile.value, &background_, sizeof(T)) != 0;
  }

  static GridInfo describeOne(const openvdb::GridBase::Ptr& grid) {
    Volume volume;
    volume.grids().all.push_back(grid);
    return tetvdb::describe(volume).front();
  }

  void count(const openvdb::GridBase::Ptr& part, const Lists& nodes) {
    const GridInfo own = describeOne(part);
    if (own.activeVoxels > 0) {
      const bool first = info_.activeVoxels == 0;
      info_.minValue = first ? own.minValue : std::min(info_.minValue, own.minValue);
      info_.maxValue = first ? own.maxValue : std::max(info_.maxValue, own.maxValue);
      box_.add({own.boxMin, own.boxMax});
    }
    info_.activeVoxels += own.activeVoxels;
    info_.activeTiles += own.activeTiles;
    info_.bytes += own.bytes - sizeof(TreeT) - nodes.uppers.size() * sizeof(Upper);
    addVolume(own, info_);
    leaves_ += own.leaves;
    lowers_ += nodes.lowers.size();
    if (leaves_ != 0)
      return;
    std::optional<openvdb::Coord> found; // a first tile, so far
    for (auto tile = static_cast<const GridT&>(*part).cbeginValueOn(); tile; ++tile) {
      const openvdb::Coord at = tile.getCoord();
      const Vec3i origin{at.x(), at.y(), at.z()};
      if (firstTile_ && !(origin < *firstTile_))
        continue;
      firstTile_ = origin;
      found = at;
    }
    if (!opensFirst_ || !found)
      return;
    const Lower* lower =
        static_cast<const GridT&>(*part).constTree().template probeConstNode<Lower>(*found);
    firstLower_ = lower != nullptr ? std::make_unique<Lower>(*lower) : nullptr;
  }

  /// The entries of the cube's node that the part has.
  void takeTiles(const TreeT& tree) {
    for (auto tile = tree.root().cbeginValueAll(); tile; ++tile)
      whole_ = Tile{*tile, tile.isValueOn()};
    for (auto child = tree.root().cbeginChildOn(); child; ++child) {
      hasUpper_ = true;
      for (auto tile = child->cbeginValueAll(); tile; ++tile) {
        const Tile own{*tile, tile.isValueOn()};
        countedTiles_ += own.active ? 1 : 0;
        if (isEntry(own))
          entries_.emplace_back(tile.pos(), own);
      }
      children_ |= child->getChildMask();
    }
  }

  /// Opens the first tile to a leaf, as openFirstTile() does.
  void openFirst() {
    const openvdb::Coord at((*firstTile_)[0], (*firstTile_)[1], (*firstTile_)[2]);
    const openvdb::Index place = Upper::coordToOffset(at);
    if (whole_) {
      for (openvdb::Index i = 0; i < Upper::NUM_VALUES; ++i)
        entries_.emplace_back(i, *whole_);
      info_.activeTiles += Upper::NUM_VALUES - 1;
      whole_.reset();
      hasUpper_ = true;
    }
    const auto grid = GridT::create(background_);
    auto upper = std::make_unique<Upper>(origin_, background_, false);
    const bool isNew = firstLower_ == nullptr;
    if (isNew) {
      const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                      [&](const auto& one) { return one.first == place; });
      upper->addTile(place, entry->second.value, entry->second.active);
      entries_.erase(entry);
      ++lowers_;
    } else {
      upper->addChild(firstLower_.release());
    }
    grid->tree().root().addChild(upper.release());
    const GridInfo before = describeOne(grid);
    grid->tree().touchLeaf(at);
    const GridInfo after = describeOne(grid);
    info_.activeTiles += after.activeTiles - before.activeTiles;
    info_.bytes += after.bytes - before.bytes;
    leaves_ = 1;
    std::size_t lowersBefore = 0;
    for (auto child = children_.beginOn(); child && child.pos() < place; ++child)
      ++lowersBefore;
    children_.setOn(place);
    takeOpened(grid->tree(), lowersBefore, isNew);
  }

  bool exact_, opensFirst_;
  GridInfo info_; ///< so far, without the box and the bytes of upper nodes
  VoxelBounds box_;
  T background_;
  std::uint64_t leaves_ = 0, lowers_ = 0, uppers_ = 0;
  std::optional<Vec3i> firstTile_;
  std::optional<openvdb::Coord> opened_;

  /// The cube under way: a tile, or a node's entries: tiles, by place, and which are children.
  openvdb::Coord origin_;
  std::optional<Tile> whole_;
  bool hasUpper_ = false;
  std::vector<std::pair<openvdb::Index, Tile>> entries_;
  ChildMask children_;
  std::uint64_t countedTiles_ = 0;    ///< active ones of the node that info_ counts
  std::unique_ptr<Lower> firstLower_; ///< that firstTile_ is in, where that is to be opened
};

} // namespace tetvdb
