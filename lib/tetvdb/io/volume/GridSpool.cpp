// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/GridSpool.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/NodeBytes.h"
#include "tetvdb/io/volume/Spool.h"
#include "tetvdb/io/volume/VdbPieces.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/VoxelBounds.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

// What jobs make.
using StreamedGrids = openvdb::TypeList<openvdb::FloatGrid, openvdb::BoolGrid, openvdb::MaskGrid,
                                        openvdb::Int32Grid, openvdb::Vec3SGrid>;

GridInfo describeOne(const openvdb::GridBase::Ptr& grid) {
  Volume volume;
  volume.grids().all.push_back(grid);
  return describe(volume).front();
}

template <class GridT>
class TypedGridSpool : public GridSpool {
  using TreeT = typename GridT::TreeType;
  using T = typename TreeT::ValueType;
  using Lists = NodeLists<TreeT>;
  using Upper = typename Lists::Upper;
  using Lower = typename Lists::Lower;
  using Buffers = BufferPieces<TreeT>;

public:
  TypedGridSpool(const openvdb::GridBase::Ptr& empty, const SpoolOptions& options)
      : options_(options), grid_(withCreator(empty)), info_(describeOne(empty)),
        background_(static_cast<const GridT&>(*empty).background()),
        topology_(options.folder, options.inMemory), buffers_(options.folder, options.inMemory) {}

  void beginCube(const Vec3i& origin) override {
    upper_ = std::make_unique<Upper>(openvdb::Coord(origin[0], origin[1], origin[2]), background_,
                                     false);
    children_ = {};
    countedTiles_ = 0;
    cubeStart_ = topologyBytes_;
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
    spoolTopology(nodes.lowers);
    spoolBuffers(tree);
  }

  void endCube() override {
    T value{};
    bool active = false;
    if (children_.isOff() && upper_->isConstant(value, active)) {
      if (active)
        info_.activeTiles = info_.activeTiles + 1 - countedTiles_;
      if (active || value != background_)
        tiles_.emplace(upper_->origin(), std::pair(value, active));
    } else {
      NodeStream out(vdbCompression(), &background_);
      writeUpperNode(out.stream(), *upper_, children_, half());
      uppers_.push_back({cubeStart_, std::move(out.bytes())});
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
    info.bytes += uppers_.size() * sizeof(Upper);
    if (info.activeVoxels > 0) {
      info.boxMin = box_.min;
      info.boxMax = box_.max;
    }
    return info;
  }

  void writeTo(VdbOutput& output, const ProgressShare& share) override {
    const VdbHead head = makeHead();
    output.beginGrid(head);
    const auto total = static_cast<double>(topologyBytes_ + bufferBytes_ + 1);
    std::uint64_t done = 0;
    std::size_t next = 0; // of the upper nodes
    const auto writeUppers = [&] {
      for (; next < uppers_.size() && uppers_[next].first == done; ++next)
        output.write(uppers_[next].second);
    };
    const auto write = [&](const std::string& bytes) {
      output.write(bytes);
      done += bytes.size();
      share.update(static_cast<double>(done) / total);
    };
    topology_.drain([&](const std::string& bytes) {
      writeUppers();
      write(bytes);
    });
    writeUppers();
    const std::uint64_t buffersAt = output.position();
    buffers_.drain(write);
    output.finishGrid(head, buffersAt);
  }

private:
  bool half() const { return grid_->saveFloatAsHalf(); }

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

  void spoolTopology(const std::vector<const Lower*>& lowers) {
    constexpr std::size_t kNodesAPiece = 4;
    std::size_t next = 0;
    makeInOrder<std::size_t, std::string>(
        [&](std::size_t& first) {
          first = next;
          next += kNodesAPiece;
          return first < lowers.size();
        },
        [&](std::size_t first) {
          NodeStream out(vdbCompression(), &background_);
          for (std::size_t i = first; i < std::min(first + kNodesAPiece, lowers.size()); ++i)
            lowers[i]->writeTopology(out.stream(), half());
          return std::move(out.bytes());
        },
        [&](const std::string& bytes) {
          topology_.add(bytes);
          topologyBytes_ += bytes.size();
        });
  }

  void spoolBuffers(const TreeT& tree) {
    Buffers buffers(tree, half(), vdbCompression(), options_.keptBytes);
    if constexpr (Buffers::kPlanned) {
      tbb::parallel_for(std::size_t(0), buffers.size(), [&](std::size_t i) { buffers.plan(i); });
      if (leaves_ <= kDelayedLoadLeaves) {
        openvdb::io::DelayedLoadMetadata own;
        buffers.describe(own);
        for (std::size_t l = 0; l < buffers.leafCount(); ++l) {
          restore_.push_back(own.getMask(l));
          sizes_.push_back(static_cast<std::uint16_t>(own.getCompressedSize(l)));
        }
      } else {
        restore_ = {};
        sizes_ = {};
      }
    }
    std::size_t next = 0;
    makeInOrder<std::size_t, std::string>(
        [&](std::size_t& piece) {
          piece = next++;
          return piece < buffers.size();
        },
        [&](std::size_t piece) { return buffers.make(piece); },
        [&](const std::string& bytes) {
          buffers_.add(bytes);
          bufferBytes_ += bytes.size();
        });
  }

  std::string makeRoot() const {
    TreeT tiles(background_);
    for (const auto& [origin, tile] : tiles_)
      tiles.root().addTile(origin, tile.first, tile.second);
    std::string root = TopologyPieces<TreeT>(tiles, half(), vdbCompression()).root();
    // Buffers a leaf, the background, the numbers of tiles and of children.
    const auto children = static_cast<std::uint32_t>(uppers_.size());
    std::memcpy(root.data() + sizeof(std::int32_t) + sizeof(T) + sizeof(std::uint32_t), &children,
                sizeof children);
    return root;
  }

  VdbHead makeHead() const {
    const openvdb::GridBase::Ptr copy =
        withCounts(grid_,
                   {box_, info_.activeVoxels, leaves_,
                    openvdbNodeBytes<TreeT>().of(uppers_.size(), lowers_, leaves_)},
                   options_.part);
    if (Buffers::kPlanned && leaves_ <= kDelayedLoadLeaves) {
      openvdb::io::DelayedLoadMetadata all;
      all.resizeMask(restore_.size());
      all.resizeCompressedSize(sizes_.size());
      for (std::size_t l = 0; l < sizes_.size(); ++l) {
        all.setMask(l, restore_[l]);
        all.setCompressedSize(l, sizes_[l]);
      }
      copy->insertMeta(openvdb::GridBase::META_FILE_DELAYED_LOAD, all);
    }
    return makeVdbHead(grid_->getName(), vdbTypeOf(*grid_), "", *copy, grid_->transform(),
                       makeRoot());
  }

  SpoolOptions options_;
  openvdb::GridBase::Ptr grid_; ///< empty, with its creator
  GridInfo info_;               ///< so far, without the box and the bytes of upper nodes
  VoxelBounds box_;
  T background_;
  std::uint64_t leaves_ = 0, lowers_ = 0;
  std::optional<Vec3i> firstTile_;
  std::optional<openvdb::Coord> opened_;

  Spool topology_, buffers_; ///< of lower nodes; of leaves
  std::uint64_t topologyBytes_ = 0, bufferBytes_ = 0;
  /// Upper nodes, each with the bytes of topology that come before its children.
  std::vector<std::pair<std::uint64_t, std::string>> uppers_;
  std::map<openvdb::Coord, std::pair<T, bool>> tiles_; ///< of the root
  /// Of leaves, for file_delayed_load.
  std::vector<std::int8_t> restore_;
  std::vector<std::uint16_t> sizes_;

  /// The cube under way: its tiles, and which entries are children.
  std::unique_ptr<Upper> upper_;
  typename Upper::NodeMaskType children_;
  std::uint64_t countedTiles_ = 0; ///< active ones that info_ counts
  std::uint64_t cubeStart_ = 0;
};

} // namespace

std::unique_ptr<GridSpool> makeGridSpool(const openvdb::GridBase::Ptr& empty,
                                         const SpoolOptions& options) {
  std::unique_ptr<GridSpool> spool;
  empty->apply<StreamedGrids>([&](const auto& typed) {
    spool = std::make_unique<TypedGridSpool<std::decay_t<decltype(typed)>>>(empty, options);
  });
  if (!spool)
    throw Error(Status::Usage, empty->getName(),
                "grids of type " + empty->type() + " cannot be streamed");
  return spool;
}

} // namespace tetvdb
