// SPDX-License-Identifier: Apache-2.0
//
// What the parts of a grid add up to: its counts, the tiles of its root and the upper node of the
// cube under way. Common to all spools of grids. Internal: instantiates OpenVDB.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/GridSpool.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/VoxelBounds.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

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

  JoinedParts(const openvdb::GridBase::Ptr& empty, bool exact)
      : exact_(exact), info_(describeOne(empty)),
        background_(static_cast<const GridT&>(*empty).background()) {}

  /// The nodes of a part, which are counted.
  virtual void takeNodes(const TreeT& tree, const Lists& nodes) = 0;
  /// The upper node of a cube: its tiles, and which of its entries are the lower nodes that were
  /// taken since the one before.
  virtual void takeUpper(const Upper& upper, const ChildMask& children) = 0;
  /// A cube of one value.
  virtual void takeTile(const openvdb::Coord& origin, const T& value, bool active) = 0;

public:
  void beginCube(const Vec3i& origin) override {
    if (exact_)
      return;
    upper_ = std::make_unique<Upper>(openvdb::Coord(origin[0], origin[1], origin[2]), background_,
                                     false);
    children_ = {};
    countedTiles_ = 0;
  }

  void add(const openvdb::GridBase::Ptr& part) override {
    TreeT& tree = static_cast<GridT&>(*part).tree();
    if (opened_ && tree.isValueOn(*opened_))
      tree.touchLeaf(*opened_);
    const Lists nodes(tree);
    count(part, nodes);
    if (exact_)
      keepTiles(tree);
    else
      takeTiles(tree);
    if (leaves_ >= std::numeric_limits<std::uint32_t>::max())
      throw Error(Status::Limit, "", "a grid would have 2^32 leaves or more",
                  "OpenVDB cannot count them: write parts with `shard`");
    takeNodes(tree, nodes);
  }

  void endCube() override {
    if (exact_)
      return endExactCube();
    T value{};
    bool active = false;
    if (children_.isOff() && upper_->isConstant(value, active)) {
      if (active)
        info_.activeTiles = info_.activeTiles + 1 - countedTiles_;
      if (active || value != background_)
        takeTile(upper_->origin(), value, active);
    } else {
      ++uppers_;
      takeUpper(*upper_, children_);
    }
    upper_.reset();
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
    info_.volume += own.volume;
    leaves_ += own.leaves;
    lowers_ += nodes.lowers.size();
    if (leaves_ != 0)
      return;
    for (auto tile = static_cast<const GridT&>(*part).cbeginValueOn(); tile; ++tile) {
      const openvdb::Coord at = tile.getCoord();
      const Vec3i origin{at.x(), at.y(), at.z()};
      if (!firstTile_ || origin < *firstTile_)
        firstTile_ = origin;
    }
  }

  /// The root's tile, or the tiles of the upper node, which its first part has.
  void keepTiles(const TreeT& tree) {
    for (auto tile = tree.root().cbeginValueAll(); tile; ++tile)
      takeTile(tile.getCoord(), *tile, tile.isValueOn());
    for (auto child = tree.root().cbeginChildOn(); child; ++child) {
      if (!upper_) {
        upper_ = std::make_unique<Upper>(child->origin(), background_, false);
        for (auto tile = child->cbeginValueAll(); tile; ++tile)
          upper_->addTile(tile.pos(), *tile, tile.isValueOn());
      }
      children_ |= child->getChildMask();
    }
  }
  void endExactCube() {
    if (!upper_)
      return;
    ++uppers_;
    takeUpper(*upper_, children_);
    upper_.reset();
    children_ = {};
  }

  /// The entries of the cube's node that the part has.
  void takeTiles(const TreeT& tree) {
    for (auto tile = tree.root().cbeginValueAll(); tile; ++tile) {
      countedTiles_ += tile.isValueOn() ? 1 : 0;
      for (openvdb::Index i = 0; i < Upper::NUM_VALUES; ++i)
        upper_->addTile(i, *tile, tile.isValueOn());
    }
    for (auto child = tree.root().cbeginChildOn(); child; ++child) {
      for (auto tile = child->cbeginValueAll(); tile; ++tile) {
        const bool active = tile.isValueOn();
        countedTiles_ += active ? 1 : 0;
        if (active || *tile != background_)
          upper_->addTile(tile.pos(), *tile, active);
      }
      children_ |= child->getChildMask();
    }
  }

  bool exact_;
  GridInfo info_; ///< so far, without the box and the bytes of upper nodes
  VoxelBounds box_;
  T background_;
  std::uint64_t leaves_ = 0, lowers_ = 0, uppers_ = 0;
  std::optional<Vec3i> firstTile_;
  std::optional<openvdb::Coord> opened_;

  /// The cube under way: its tiles, and which entries are children.
  std::unique_ptr<Upper> upper_;
  ChildMask children_;
  std::uint64_t countedTiles_ = 0; ///< active ones that info_ counts
};

} // namespace tetvdb
