// SPDX-License-Identifier: Apache-2.0
//
// openvdb::io::File writes a grid on one thread, compresses every buffer twice (once to learn its
// size for the delayed-load metadata) and does not notice a full disk. This writer makes the same
// bytes with four exceptions: the file version is always 224, which OpenVDB 10 to 12 write and all
// readers support, the UUID is derived from the content, grids of more than kDelayedLoadLeaves
// leaves have no metadata entry file_delayed_load (io/volume/VdbOutput.h), and that of grids with
// many values is not compressed (io/volume/DelayedLoad.h). Readers work without that entry, but
// delayed loading (Houdini's default) is several times faster with it.
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/DelayedLoad.h"
#include "tetvdb/io/volume/PackedGrid.h"
#include "tetvdb/io/volume/PackedPieces.h"
#include "tetvdb/io/volume/VdbOutput.h"
#include "tetvdb/io/volume/VdbPieces.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/PackedRange.h"

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <openvdb/io/Archive.h>
#include <optional>
#include <set>
#include <utility>

namespace tetvdb {
namespace {

/// Adds the statistics that io::File adds.
openvdb::GridBase::Ptr withStatistics(const openvdb::GridBase::Ptr& grid) {
  const openvdb::GridBase::Ptr copy = grid->copyGrid();
  copy->addStatsMetadata();
  copy->insertMeta(openvdb::GridBase::META_FILE_COMPRESSION,
                   openvdb::StringMetadata(openvdb::io::compressionToString(vdbCompression())));
  return copy;
}

/// Writes one grid after another.
class VdbWriter {
public:
  explicit VdbWriter(VdbOutput& output) : output_(output) {}

  /// `packed`: where the leaves' values are, or null.
  void write(const openvdb::GridBase::Ptr& grid, const PackedGrid* packed,
             const ProgressShare& share) {
    name_ = grid->getName();
    if (!names_.insert(name_).second || name_.empty())
      throw Error(Status::Usage, output_.file().path(),
                  "grid names must be unique and not empty: '" + name_ + "'");

    const std::pair<const void*, bool> tree(&grid->baseTree(), grid->saveFloatAsHalf());
    const auto found = trees_.find(tree);
    if (found != trees_.end()) {
      const VdbHead head =
          makeVdbHead(name_, vdbTypeOf(*grid), found->second, *grid, grid->transform(), "");
      output_.beginGrid(head);
      output_.finishGrid(head, 0);
      return;
    }
    trees_.emplace(tree, name_);
    writeTree(grid, packed, share);
  }

private:
  /// Bytes of tails that wait in memory for the entry for delayed loading; more lie in a file
  /// without a name.
  static constexpr std::size_t kTailsInMemory = std::size_t(256) << 20;

  /// Metadata, transform and tree.
  void writeTree(const openvdb::GridBase::Ptr& grid, const PackedGrid* packed,
                 const ProgressShare& share) {
    const openvdb::GridBase::Ptr copy = withStatistics(grid);
    const bool known = withKnownGrid(std::as_const(*grid), [&](const auto& typed) {
      using TreeT = typename std::decay_t<decltype(typed)>::TreeType;
      if constexpr (!hasBitLeaves<TreeT>)
        if (packed != nullptr)
          return writePacked(typed, *packed, *copy, share);
      writeTyped(typed, *copy, share);
    });
    if (!known)
      writeOther(*grid, *copy);
  }

  template <class GridT>
  void writeTyped(const GridT& grid, openvdb::GridBase& copy, const ProgressShare& share) {
    using TreeT = typename GridT::TreeType;
    const TreeT& tree = grid.constTree();
    BufferPieces<TreeT> buffers(tree, grid.saveFloatAsHalf(), vdbCompression());
    std::optional<TailStore> store;
    if constexpr (BufferPieces<TreeT>::kHasTails)
      if (buffers.leafCount() <= kDelayedLoadLeaves) {
        if (isDelayedLoadPlain(buffers.leafCount(),
                               [&](std::size_t l) { return buffers.sizeOf(l); })) {
          reserveDelayedLoad(copy, buffers.leafCount());
          return writeNodes(grid, buffers, copy, share, [&] { describeLeaves(buffers, copy); });
        }
        store.emplace(std::filesystem::path(output_.file().path()).parent_path().string(),
                      kTailsInMemory);
        const ProgressShare planning = share.part(0, 0.5);
        std::atomic<std::size_t> done{0};
        tbb::parallel_for(std::size_t(0), buffers.size(), [&](std::size_t piece) {
          buffers.plan(piece, *store);
          planning.update(double(++done) / double(buffers.size()));
        });
        describeLeaves(buffers, copy);
      }
    writeNodes(grid, buffers, copy, share);
  }

  /// The same for a grid whose leaves are packed.
  template <class GridT>
  void writePacked(const GridT& grid, const PackedGrid& packed, openvdb::GridBase& copy,
                   const ProgressShare& share) {
    PackedPieces<typename GridT::TreeType> buffers(grid.constTree(), packed,
                                                   grid.saveFloatAsHalf());
    if (const auto bytes =
            copy.getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_MEM_BYTES))
      bytes->setValue(bytes->value() + static_cast<std::int64_t>(buffers.missingBytes()));
    if (buffers.leafCount() <= kDelayedLoadLeaves)
      describeLeaves(buffers, copy);
    writeNodes(grid, buffers, copy, share);
  }

  template <class Buffers>
  static void describeLeaves(const Buffers& buffers, openvdb::GridBase& copy) {
    openvdb::io::DelayedLoadMetadata delayed;
    buffers.describe(delayed);
    insertDelayedLoad(copy, delayed, buffers.leafCount());
  }

  /// Head, topology and buffers; after these complete(), where it is given, replaces entries of
  /// `copy` by others of the same size.
  template <class GridT, class Buffers>
  void writeNodes(const GridT& grid, Buffers& buffers, const openvdb::GridBase& copy,
                  const ProgressShare& share, const std::function<void()>& complete = {}) {
    const TopologyPieces<typename GridT::TreeType> topology(
        grid.constTree(), grid.saveFloatAsHalf(), vdbCompression());
    const auto makeHead = [&] {
      return makeVdbHead(name_, vdbTypeOf(grid), "", copy, grid.transform(), topology.root());
    };
    VdbHead head = makeHead();
    output_.beginGrid(head);
    writePieces(
        topology.size(), [&](std::size_t i) { return topology.make(i); }, output_,
        share.part(0.5, 0.6));
    const std::uint64_t buffersAt = output_.position();
    writePieces(
        buffers.size(), [&](std::size_t i) { return buffers.make(i); }, output_,
        share.part(0.6, 1));
    if (complete) {
      complete();
      head = makeHead();
    }
    output_.finishGrid(head, buffersAt);
  }

  /// Writes a grid of a type that has no typed code, with OpenVDB's own function, on one thread.
  void writeOther(const openvdb::GridBase& grid, const openvdb::GridBase& copy) {
    const VdbHead head = makeVdbHead(name_, vdbTypeOf(grid), "", copy, grid.transform(), "");
    output_.beginGrid(head);
    SinkBuffer<VdbOutput> buffer(output_);
    std::ostream stream(&buffer);
    stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
    openvdb::io::StreamMetadata::Ptr metadata(new openvdb::io::StreamMetadata);
    metadata->setHalfFloat(grid.saveFloatAsHalf());
    metadata->gridMetadata() = static_cast<const openvdb::MetaMap&>(grid);
    openvdb::io::setStreamMetadataPtr(stream, metadata, /*transfer=*/false);
    openvdb::io::setDataCompression(stream, vdbCompression());
    grid.writeTopology(stream);
    const std::uint64_t buffersAt = output_.position();
    grid.writeBuffers(stream);
    output_.finishGrid(head, buffersAt);
  }

  VdbOutput& output_;
  std::string name_; ///< of the grid being written
  std::set<std::string> names_;
  std::map<std::pair<const void*, bool>, std::string> trees_; ///< written trees, as half or not
};

} // namespace

void writeGrids(VdbOutput& output, const openvdb::GridPtrVec& grids, const ProgressShare& share) {
  VdbWriter writer(output);
  for (std::size_t i = 0; i < grids.size(); ++i)
    writer.write(
        withCreator(grids[i]), nullptr,
        share.part(double(i) / double(grids.size()), double(i + 1) / double(grids.size())));
}

GridInfo describe(const PackedGrid& packed) {
  return describePacked(*packed.grid, {packed.min, packed.max});
}

void writeVdb(const std::string& path, const Volume& volume, Progress& progress) {
  writeVdb(path, volume, {}, progress);
}

void writeVdb(const std::string& path, const Volume& volume,
              const std::vector<std::unique_ptr<PackedGrid>>& packed, Progress& progress) {
  initializeOpenVDB();
  openvdb::GridPtrVec grids = volume.grids().all;
  const std::size_t ordinary = grids.size();
  for (const auto& one : packed)
    grids.push_back(one->grid);
  for (const auto& grid : grids)
    if (!grid)
      throw Error(Status::Usage, path, "there is no grid where one was promised");

  VdbOutput output(path, volume.metadata, grids.size());
  VdbWriter writer(output);
  const ProgressShare whole(progress, 0, 1);
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const double count = double(grids.size());
    writer.write(withCreator(grids[i]), i < ordinary ? nullptr : packed[i - ordinary].get(),
                 whole.part(double(i) / count, double(i + 1) / count));
  }
  output.commit(progress);
}

} // namespace tetvdb
