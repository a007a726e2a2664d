// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/GridLayers.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::int32_t kLayersInBatch = 8; // a leaf's

// A voxel's value as that of a pixel.
std::uint8_t pixelValue(bool value, const GreyLevels& levels) {
  return value ? levels.of(GreyLevels::kWhole) : std::uint8_t(0);
}
std::uint8_t pixelValue(std::int32_t value, const GreyLevels&) {
  return value > 0 && value < 256 ? static_cast<std::uint8_t>(value) : std::uint8_t(0);
}
std::int64_t shareOf(float value) {
  const double share = value > 0 ? std::min<double>(value, 1) : 0; // NaN counts as 0
  return std::llrint(share * static_cast<double>(GreyLevels::kWhole));
}
std::uint8_t pixelValue(float value, const GreyLevels& levels) {
  return levels.of(shareOf(value));
}
double filledBy(bool value) {
  return value ? 1 : 0;
}
double filledBy(std::int32_t value) {
  return value > 0 && value < 256 ? 1 : 0;
}
double filledBy(float value) {
  return static_cast<double>(shareOf(value)) / static_cast<double>(GreyLevels::kWhole);
}

// Part of a row with one value.
struct Segment {
  std::int32_t y, begin, end;
  std::uint8_t value;
  bool operator<(const Segment& o) const { return std::tie(y, begin) < std::tie(o.y, o.begin); }
};

template <typename Grid>
class GridLayers : public LayerSource {
  using Tree = typename Grid::TreeType;
  using Leaf = typename Tree::LeafNodeType;
  using Value = typename Grid::ValueType;

  // An active tile, whose voxels have one value.
  struct Tile {
    openvdb::CoordBBox box;
    Value value;
  };

  class Batch : public LayerBatch {
  public:
    Batch(const GridLayers& source, std::int32_t first, std::int32_t end)
        : source_(source), end_(end) {
      const auto z = [&](std::int32_t k) { return k - source.map_.z; };
      const auto from = std::lower_bound(
          source.leaves_.begin(), source.leaves_.end(), z(first) - (kLayersInBatch - 1),
          [](const Leaf* leaf, std::int64_t low) { return leaf->origin().z() < low; });
      for (auto leaf = from; leaf != source.leaves_.end() && (*leaf)->origin().z() < z(end); ++leaf)
        leaves_.push_back(*leaf);
      for (const Tile& tile : source.tiles_)
        if (tile.box.max().z() >= z(first) && tile.box.min().z() < z(end))
          tiles_.push_back(tile);
    }

    std::int32_t end() const override { return end_; }

    void make(std::int32_t k, Layer& layer) const override {
      layer.clear();
      const std::int64_t z = k - source_.map_.z;
      std::vector<Segment> segments;
      for (const Leaf* leaf : leaves_)
        if (z >= leaf->origin().z() && z < leaf->origin().z() + kLayersInBatch)
          addLeaf(*leaf, static_cast<openvdb::Int32>(z), segments, layer);
      for (const Tile& tile : tiles_)
        if (z >= tile.box.min().z() && z <= tile.box.max().z())
          for (openvdb::Int32 y = tile.box.min().y(); y <= tile.box.max().y(); ++y)
            add(tile.box.min().x(), tile.box.max().x() + 1, y, tile.value, segments, layer);
      std::sort(segments.begin(), segments.end());
      for (const Segment& s : segments)
        layer.add(s.y, s.begin, s.end, s.value);
    }

  private:
    void addLeaf(const Leaf& leaf, openvdb::Int32 z, std::vector<Segment>& segments,
                 Layer& layer) const {
      const openvdb::Coord origin = leaf.origin();
      for (openvdb::Int32 y = origin.y(); y < origin.y() + kLayersInBatch; ++y)
        for (openvdb::Int32 x = origin.x(); x < origin.x() + kLayersInBatch; ++x) {
          const auto at = Leaf::coordToOffset(openvdb::Coord(x, y, z));
          if (leaf.isValueOn(at))
            add(x, x + 1, y, leaf.getValue(at), segments, layer);
        }
    }

    // Voxels x0 to x1 - 1.
    void add(std::int64_t x0, std::int64_t x1, std::int64_t voxelY, const Value& value,
             std::vector<Segment>& segments, Layer& layer) const {
      const VoxelToPixel& map = source_.map_;
      const LayerFrame& frame = source_.frame_;
      const std::int64_t y = map.reverseY ? map.y - voxelY : map.y + voxelY;
      std::int64_t begin = map.reverseX ? map.x - x1 + 1 : map.x + x0;
      std::int64_t end = map.reverseX ? map.x - x0 + 1 : map.x + x1;
      begin = std::max<std::int64_t>(begin, 0);
      end = std::min<std::int64_t>(end, frame.width);
      if (y < 0 || y >= frame.height || begin >= end)
        return;
      layer.filled += filledBy(value) * static_cast<double>(end - begin);
      const std::uint8_t grey = pixelValue(value, source_.levels_);
      if (grey == 0)
        return;
      const auto row = static_cast<std::int32_t>(y);
      if (!segments.empty() && segments.back().y == row && segments.back().end == begin &&
          segments.back().value == grey)
        segments.back().end = static_cast<std::int32_t>(end);
      else
        segments.push_back(
            {row, static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end), grey});
    }

    const GridLayers& source_;
    std::int32_t end_;
    std::vector<const Leaf*> leaves_;
    std::vector<Tile> tiles_;
  };

public:
  GridLayers(typename Grid::ConstPtr grid, const LayerFrame& frame, const VoxelToPixel& map,
             const GreyLevels& levels)
      : grid_(std::move(grid)), frame_(frame), map_(map), levels_(levels) {
    for (auto leaf = grid_->tree().cbeginLeaf(); leaf; ++leaf)
      leaves_.push_back(leaf.getLeaf());
    std::stable_sort(leaves_.begin(), leaves_.end(), [](const Leaf* a, const Leaf* b) {
      return a->origin().z() < b->origin().z();
    });
    auto value = grid_->tree().cbeginValueOn();
    value.setMaxDepth(Tree::ValueOnCIter::LEAF_DEPTH - 1);
    for (; value; ++value) {
      openvdb::CoordBBox box;
      value.getBoundingBox(box);
      tiles_.push_back({box, *value});
    }
  }

  const LayerFrame& frame() const override { return frame_; }

  std::shared_ptr<const LayerBatch> batch(std::int32_t first) override {
    return std::make_shared<Batch>(*this, first, std::min(first + kLayersInBatch, frame_.layers));
  }

private:
  typename Grid::ConstPtr grid_;
  LayerFrame frame_;
  VoxelToPixel map_;
  GreyLevels levels_;
  std::vector<const Leaf*> leaves_;
  std::vector<Tile> tiles_;
};

template <typename Grid>
std::unique_ptr<LayerSource> tryGrid(const openvdb::GridBase::ConstPtr& grid,
                                     const LayerFrame& frame, const VoxelToPixel& map,
                                     const GreyLevels& levels) {
  if (!grid->isType<Grid>())
    return nullptr;
  return std::make_unique<GridLayers<Grid>>(openvdb::gridConstPtrCast<Grid>(grid), frame, map,
                                            levels);
}

} // namespace

std::unique_ptr<LayerSource> gridLayers(openvdb::GridBase::ConstPtr grid, const LayerFrame& frame,
                                        const VoxelToPixel& map, const GreyLevels& levels) {
  if (auto source = tryGrid<openvdb::BoolGrid>(grid, frame, map, levels))
    return source;
  if (auto source = tryGrid<openvdb::Int32Grid>(grid, frame, map, levels))
    return source;
  if (auto source = tryGrid<openvdb::FloatGrid>(grid, frame, map, levels))
    return source;
  throw Error(Status::Usage, "`grid`",
              "'" + grid->getName() + "' has a type that cannot be cut into layers",
              "give a mask, a coverage, a material or a level set");
}

} // namespace tetvdb
