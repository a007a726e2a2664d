// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/DelayedLoad.h"
#include "tetvdb/io/volume/GridSpool.h"
#include "tetvdb/io/volume/JoinedParts.h"
#include "tetvdb/io/volume/Spool.h"
#include "tetvdb/io/volume/VdbPieces.h"
#include "tetvdb/volume/NodeBytes.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

template <class GridT>
class TypedVdbSpool : public JoinedParts<GridT, VdbSpool> {
  using Joined = JoinedParts<GridT, VdbSpool>;
  using typename Joined::ChildMask;
  using typename Joined::Lists;
  using typename Joined::Lower;
  using typename Joined::T;
  using typename Joined::TreeT;
  using typename Joined::Upper;
  using Buffers = BufferPieces<TreeT>;

public:
  TypedVdbSpool(const openvdb::GridBase::Ptr& empty, const SpoolOptions& options)
      : Joined(empty, options), options_(options), grid_(withCreator(empty)),
        topology_(makeSpool(options)), buffers_(makeSpool(options)),
        described_(makeSpool(options)) {}

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
  /// A leaf's entries in file_delayed_load.
  struct Described {
    std::int8_t restore;
    std::uint16_t size;
  };

  static Spool makeSpool(const SpoolOptions& options) {
    return options.store ? Spool(options.store) : Spool(options.folder, options.inMemory);
  }
  bool half() const { return grid_->saveFloatAsHalf(); }

  void takeNodes(const TreeT& tree, const Lists& nodes) override {
    spoolTopology(nodes.lowers);
    spoolBuffers(tree);
  }
  void takeUpper(const Upper& upper, const ChildMask& children) override {
    NodeStream out(vdbCompression(), &this->background());
    writeUpperNode(out.stream(), upper, children, half());
    uppers_.push_back({cubeStart_, std::move(out.bytes())});
    cubeStart_ = topologyBytes_;
  }
  void takeTile(const openvdb::Coord& origin, const T& value, bool active) override {
    tiles_.emplace(origin, std::pair(value, active));
  }

  void takeOpened(const TreeT& tree, std::size_t place, bool isNew) override {
    topology_.put(place, topologyOf(Lists(tree).lowers, 0, 1), !isNew);
    spoolBuffers(tree);
  }

  void spoolTopology(const std::vector<const Lower*>& lowers) {
    // One at a time where takeOpened() may replace it.
    const std::size_t nodesAPiece = options_.openFirstTile ? 1 : 4;
    std::size_t next = 0;
    makeInOrder<std::size_t, std::string>(
        [&](std::size_t& first) {
          first = next;
          next += nodesAPiece;
          return first < lowers.size();
        },
        [&](std::size_t first) {
          return topologyOf(lowers, first, std::min(first + nodesAPiece, lowers.size()));
        },
        [&](const std::string& bytes) {
          topology_.add(bytes);
          topologyBytes_ += bytes.size();
        });
  }
  std::string topologyOf(const std::vector<const Lower*>& lowers, std::size_t begin,
                         std::size_t end) const {
    NodeStream out(vdbCompression(), &this->background());
    for (std::size_t i = begin; i < end; ++i)
      lowers[i]->writeTopology(out.stream(), half());
    return std::move(out.bytes());
  }

  void spoolBuffers(const TreeT& tree) {
    Buffers buffers(tree, half(), vdbCompression());
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
    if (Buffers::kHasTails && this->leaves() <= kDelayedLoadLeaves) {
      openvdb::io::DelayedLoadMetadata own;
      buffers.describe(own);
      std::string bytes;
      for (std::size_t l = 0; l < buffers.leafCount(); ++l) {
        const Described one{own.getMask(l), static_cast<std::uint16_t>(own.getCompressedSize(l))};
        bytes.append(reinterpret_cast<const char*>(&one), sizeof one);
      }
      described_.add(bytes);
    }
  }

  std::string makeRoot() const {
    TreeT tiles(this->background());
    for (const auto& [origin, tile] : tiles_)
      tiles.root().addTile(origin, tile.first, tile.second);
    std::string root = TopologyPieces<TreeT>(tiles, half(), vdbCompression()).root();
    // Buffers a leaf, the background, the numbers of tiles and of children.
    const auto children = static_cast<std::uint32_t>(uppers_.size());
    std::memcpy(root.data() + sizeof(std::int32_t) + sizeof(T) + sizeof(std::uint32_t), &children,
                sizeof children);
    return root;
  }

  VdbHead makeHead() {
    const openvdb::GridBase::Ptr copy =
        withCounts(grid_,
                   {this->box(), this->activeVoxels(), this->leaves(),
                    openvdbNodeBytes<TreeT>().of(this->uppers(), this->lowers(), this->leaves())},
                   options_.part);
    if (Buffers::kHasTails && this->leaves() <= kDelayedLoadLeaves) {
      openvdb::io::DelayedLoadMetadata all;
      all.resizeMask(this->leaves());
      all.resizeCompressedSize(this->leaves());
      std::size_t l = 0;
      described_.drain([&](const std::string& bytes) {
        for (std::size_t at = 0; at < bytes.size(); at += sizeof(Described), ++l) {
          Described one;
          std::memcpy(&one, bytes.data() + at, sizeof one);
          all.setMask(l, one.restore);
          all.setCompressedSize(l, one.size);
        }
      });
      insertDelayedLoad(*copy, all, this->leaves());
    }
    return makeVdbHead(grid_->getName(), vdbTypeOf(*grid_), "", *copy, grid_->transform(),
                       makeRoot());
  }

  SpoolOptions options_;
  openvdb::GridBase::Ptr grid_; ///< empty, with its creator
  Spool topology_, buffers_;    ///< of lower nodes; of leaves
  Spool described_;             ///< of leaves, while file_delayed_load is for so many
  std::uint64_t topologyBytes_ = 0, bufferBytes_ = 0;
  std::uint64_t cubeStart_ = 0; ///< bytes of topology before the cube under way
  /// Upper nodes, each with the bytes of topology that come before its children.
  std::vector<std::pair<std::uint64_t, std::string>> uppers_;
  std::map<openvdb::Coord, std::pair<T, bool>> tiles_; ///< of the root
};

} // namespace

std::unique_ptr<VdbSpool> makeVdbSpool(const openvdb::GridBase::Ptr& empty,
                                       const SpoolOptions& options) {
  std::unique_ptr<VdbSpool> spool;
  withKnownGrid(*empty, [&](const auto& typed) {
    spool = std::make_unique<TypedVdbSpool<std::decay_t<decltype(typed)>>>(empty, options);
  });
  if (!spool)
    throw Error(Status::Usage, empty->getName(),
                "grids of type " + empty->type() + " cannot be streamed");
  return spool;
}

} // namespace tetvdb
