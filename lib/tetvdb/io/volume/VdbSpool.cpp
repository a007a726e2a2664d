// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
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
      : Joined(empty, options.exact), options_(options), grid_(withCreator(empty)),
        topology_(options.folder, options.inMemory), buffers_(options.folder, options.inMemory) {}

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
          NodeStream out(vdbCompression(), &this->background());
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
    if constexpr (Buffers::kHasTails) {
      if (this->leaves() <= kDelayedLoadLeaves) {
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

  VdbHead makeHead() const {
    const openvdb::GridBase::Ptr copy =
        withCounts(grid_,
                   {this->box(), this->activeVoxels(), this->leaves(),
                    openvdbNodeBytes<TreeT>().of(this->uppers(), this->lowers(), this->leaves())},
                   options_.part);
    if (Buffers::kHasTails && this->leaves() <= kDelayedLoadLeaves) {
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
  Spool topology_, buffers_;    ///< of lower nodes; of leaves
  std::uint64_t topologyBytes_ = 0, bufferBytes_ = 0;
  std::uint64_t cubeStart_ = 0; ///< bytes of topology before the cube under way
  /// Upper nodes, each with the bytes of topology that come before its children.
  std::vector<std::pair<std::uint64_t, std::string>> uppers_;
  std::map<openvdb::Coord, std::pair<T, bool>> tiles_; ///< of the root
  /// Of leaves, for file_delayed_load.
  std::vector<std::int8_t> restore_;
  std::vector<std::uint16_t> sizes_;
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
