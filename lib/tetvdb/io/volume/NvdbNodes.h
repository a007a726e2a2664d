// SPDX-License-Identifier: Apache-2.0
//
// A grid on its way into a .nvdb file: its nodes come in the order of OpenVDB's tree and wait,
// level by level, until all have come. Internal: instantiates OpenVDB and NanoVDB.
//
//   tetvdb::NvdbNodes<openvdb::FloatTree> nodes(folder, bytesInMemory);
//   nodes.addLowers(lowers);                   // of one upper node, any number of times
//   nodes.addUpper(upper, upper.getChildMask());
//   nodes.addTile(origin, value, active);
//   nodes.writeTo(file, grid, share);
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/NanoNodes.h"
#include "tetvdb/io/volume/NodeChecksum.h"
#include "tetvdb/io/volume/NodeSpool.h"
#include "tetvdb/io/volume/NvdbHead.h"
#include "tetvdb/io/volume/NvdbSegment.h"
#include "tetvdb/io/volume/VdbOutput.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <tbb/task_arena.h>
#include <utility>
#include <vector>

namespace tetvdb {

template <class TreeT>
class NvdbNodes {
  using Nodes = NanoNodes<TreeT>;
  using T = typename Nodes::T;
  using Summary = typename Nodes::Summary;
  using OpenUpper = typename Nodes::OpenUpper;
  using OpenLower = typename Nodes::OpenLower;
  using Leaf = typename Nodes::Leaf;
  using Lower = typename Nodes::Lower;
  using Upper = typename Nodes::Upper;
  using Root = typename Nodes::Root;

public:
  /// Leaves take `inMemory` bytes at most before a file without a name in `folder` takes them,
  /// other nodes together as many.
  NvdbNodes(const std::string& folder, std::size_t inMemory)
      : leaves_(folder, inMemory), lowers_(folder, inMemory / 2), uppers_(folder, inMemory / 2) {}

  /// In parallel. Memory: besides, about 3 compressed nodes a thread. Throws Error(Write), and
  /// Error(Limit) for 2^32 leaves or more.
  void addLowers(const std::vector<const OpenLower*>& lowers) {
    std::size_t next = 0;
    using Piece = std::shared_ptr<Made>;
    makeInOrder<std::size_t, Piece>(
        [&](std::size_t& i) {
          i = next++;
          return i < lowers.size();
        },
        [&](std::size_t i) { return make(*lowers[i]); },
        [&](const Piece& made) {
          for (const auto& [nodes, sums] : made->leaves) {
            leaves_.add(nodes);
            leafSums_.add(sums);
          }
          lowers_.add(made->lower);
          tiles_[0] += made->tiles;
          voxels_ += made->voxels;
          under_.push_back(made->sum);
        },
        2 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
    if (leaves_.count() >= std::numeric_limits<std::uint32_t>::max())
      throw Error(Status::Limit, "", "a grid would have 2^32 leaves or more",
                  "NanoVDB cannot count them: use larger voxels");
  }

  /// After its lower nodes, which are at the entries of `children`.
  template <class Mask>
  void addUpper(const OpenUpper& from, const Mask& children) {
    NodeMemory bytes(sizeof(Upper));
    auto& node = *reinterpret_cast<Upper*>(bytes.data());
    const Summary sum = Nodes::makeInternal(from, children, under_.begin(), node);
    uppers_.add(NodeSpool::pack(bytes.data(), bytes.size(), 1, under_.size()));
    tiles_[1] += from.getValueMask().countOn();
    root_.emplace(from.origin(), Entry{true, T{}, false, sum});
    under_.clear();
  }

  void addTile(const openvdb::Coord& origin, const T& value, bool active) {
    Summary sum;
    if (active)
      sum.addTile(origin, value, static_cast<int>(OpenUpper::DIM), OpenUpper::NUM_VOXELS);
    tiles_[2] += active ? 1 : 0;
    root_.emplace(origin, Entry{false, value, active, sum});
  }

  /// Appends the grid; `grid`: its name, class, transform and background. To be called once, last.
  /// Throws Error(Write).
  void writeTo(AtomicFile& file, const openvdb::Grid<TreeT>& grid, const ProgressShare& share) {
    NodeMemory head = makeHead(grid);
    const double total =
        static_cast<double>(2 * (lowers_.count() + uppers_.count()) + leaves_.count() / 8 + 1);
    double done = 0;
    const auto step = [&](std::size_t bytes, double most) {
      done += std::min(most, static_cast<double>(bytes) / sizeof(Lower));
      share.update(std::min(1.0, done / total));
    };
    NodeChecksum tail;
    const auto addSums = [&](const NodeMemory& nodes, std::size_t size) {
      std::vector<std::uint64_t> sums;
      for (std::size_t at = 0; at < nodes.size(); at += size)
        sums.push_back(NodeChecksum::of(nodes.data() + at, size));
      tail.add(sums);
      step(nodes.size(), 1);
    };
    readUppers([&](const NodeMemory& nodes) { addSums(nodes, sizeof(Upper)); }, false);
    readLowers([&](const NodeMemory& nodes) { addSums(nodes, sizeof(Lower)); }, false);
    tail.append(leafSums_);
    setNvdbChecksum(head.data(), head.size(),
                    root_.empty() ? ~std::uint32_t(0) : static_cast<std::uint32_t>(tail.value()));
    NvdbSegment segment(file, head.data(), grid.getName());
    segment.write(head.data(), head.size());
    const auto write = [&](const NodeMemory& nodes) {
      segment.write(nodes.data(), nodes.size());
      step(nodes.size(), 1);
    };
    readUppers(write, true);
    readLowers(write, true);
    read(
        leaves_, [](NodeMemory&, const NodeSpool::Piece&) {}, write, true);
    segment.finish();
  }

private:
  struct Entry {
    bool child;
    T value;
    bool active;
    Summary sum;
  };
  /// Of one lower node.
  struct Made {
    std::vector<std::pair<NodeSpool::Packed, std::vector<std::uint64_t>>> leaves;
    NodeSpool::Packed lower;
    Summary sum;
    std::uint64_t tiles = 0, voxels = 0;
  };

  static std::shared_ptr<Made> make(const OpenLower& from) {
    constexpr std::size_t kLeavesAPiece = 64;
    auto made = std::make_shared<Made>();
    std::vector<Summary> sums;
    NodeMemory bytes;
    std::size_t count = 0; // of leaves in `bytes`
    const auto flush = [&] {
      if (count == 0)
        return;
      std::vector<std::uint64_t> checks;
      for (std::size_t i = 0; i < count; ++i)
        checks.push_back(NodeChecksum::of(bytes.data() + i * sizeof(Leaf), sizeof(Leaf)));
      made->leaves.emplace_back(NodeSpool::pack(bytes.data(), count * sizeof(Leaf), count, 0),
                                std::move(checks));
      count = 0;
    };
    for (auto child = from.cbeginChildOn(); child; ++child) {
      if (count == 0)
        bytes.assign(kLeavesAPiece * sizeof(Leaf), 0);
      sums.push_back(
          Nodes::makeLeaf(*child, *reinterpret_cast<Leaf*>(bytes.data() + count * sizeof(Leaf))));
      made->voxels += child->onVoxelCount();
      if (++count == kLeavesAPiece)
        flush();
    }
    flush();
    NodeMemory own(sizeof(Lower));
    made->sum = Nodes::makeInternal(from, from.getChildMask(), sums.begin(),
                                    *reinterpret_cast<Lower*>(own.data()));
    made->lower = NodeSpool::pack(own.data(), own.size(), 1, sums.size());
    made->tiles = from.getValueMask().countOn();
    return made;
  }

  std::size_t rootBytes() const {
    return sizeof(Root) + root_.size() * sizeof(typename Root::Tile);
  }
  std::uint64_t uppersAt() const { return sizeof(NvdbGrid) + rootBytes(); }
  std::uint64_t lowersAt() const { return uppersAt() + uppers_.count() * sizeof(Upper); }
  std::uint64_t leavesAt() const { return lowersAt() + lowers_.count() * sizeof(Lower); }

  NodeMemory makeHead(const openvdb::Grid<TreeT>& grid) const {
    NodeMemory head(uppersAt());
    auto& root = *reinterpret_cast<Root*>(head.data() + sizeof(NvdbGrid));
    root.mBackground = Nodes::nanoValue(grid.background());
    Summary all;
    std::uint64_t upper = 0;
    for (const auto& [origin, entry] : root_) {
      auto& tile = *root.tile(root.mTableSize++);
      if (entry.child) {
        tile.setValue(origin, false, Nodes::nanoValue(T(openvdb::zeroVal<T>())));
        tile.child = static_cast<std::int64_t>(rootBytes() + upper++ * sizeof(Upper));
      } else {
        tile.setValue(origin, entry.active, Nodes::nanoValue(entry.value));
      }
      all.add(entry.sum);
    }
    root.mBBox = all.box;
    if (root_.empty())
      root.mMinimum = root.mMaximum = root.mBackground;
    else
      Nodes::setStatistics(root, all);
    NvdbCounts counts;
    counts.type = gridTypeOf<typename Nodes::Build>();
    counts.hasStatistics = !Nodes::kIsBool;
    counts.nodes = {leaves_.count(), lowers_.count(), uppers_.count()};
    counts.tiles = tiles_;
    counts.at = {leavesAt(), lowersAt(), uppersAt()};
    counts.size = leavesAt() + leaves_.count() * sizeof(Leaf);
    counts.voxels = voxels_ + tiles_[0] * Nodes::OpenLeaf::NUM_VOXELS +
                    tiles_[1] * OpenLower::NUM_VOXELS + tiles_[2] * OpenUpper::NUM_VOXELS;
    if (!all.box.empty())
      counts.box.emplace(openvdb::Coord(all.box.min()[0], all.box.min()[1], all.box.min()[2]),
                         openvdb::Coord(all.box.max()[0], all.box.max()[1], all.box.max()[2]));
    const NvdbGrid begin = makeNvdbGrid(grid, counts);
    std::memcpy(head.data(), &begin, sizeof begin);
    return head;
  }

  /// Nodes in order, piece by piece, after change(nodes, piece), which is called in parallel.
  template <class Change, class Take>
  static void read(NodeSpool& spool, const Change& change, const Take& take, bool last) {
    const std::vector<NodeSpool::Piece>& pieces = spool.pieces();
    std::size_t next = 0, taken = 0;
    using Read = std::shared_ptr<NodeMemory>;
    makeInOrder<std::size_t, Read>(
        [&](std::size_t& i) {
          i = next++;
          return i < pieces.size();
        },
        [&](std::size_t i) {
          auto nodes = std::make_shared<NodeMemory>(spool.read(pieces[i]));
          change(*nodes, pieces[i]);
          return nodes;
        },
        [&](const Read& nodes) {
          take(*nodes);
          // Pieces that are being read lie behind this one.
          if (last && taken % 64 == 0)
            spool.release(pieces[taken]);
          ++taken;
        });
  }

  template <class Node, class Take>
  static void readInternal(NodeSpool& spool, std::uint64_t nodesAt, std::uint64_t childrenAt,
                           std::size_t childBytes, const Take& take, bool last) {
    const auto change = [=](NodeMemory& nodes, const NodeSpool::Piece& piece) {
      const std::uint64_t from = nodesAt + piece.firstNode * sizeof(Node);
      const std::uint64_t to = childrenAt + piece.firstChild * childBytes;
      Nodes::setChildren(*reinterpret_cast<Node*>(nodes.data()),
                         static_cast<std::int64_t>(to - from), childBytes);
    };
    read(spool, change, take, last);
  }
  template <class Take>
  void readUppers(const Take& take, bool last) {
    readInternal<Upper>(uppers_, uppersAt(), lowersAt(), sizeof(Lower), take, last);
  }
  template <class Take>
  void readLowers(const Take& take, bool last) {
    readInternal<Lower>(lowers_, lowersAt(), leavesAt(), sizeof(Leaf), take, last);
  }

  NodeSpool leaves_, lowers_, uppers_;
  NodeChecksum leafSums_;
  std::map<openvdb::Coord, Entry> root_;
  std::vector<Summary> under_;           ///< of the lower nodes of the next upper one
  std::array<std::uint64_t, 3> tiles_{}; ///< active ones of lower nodes, upper nodes and the root
  std::uint64_t voxels_ = 0;             ///< active, in leaves
};

} // namespace tetvdb
