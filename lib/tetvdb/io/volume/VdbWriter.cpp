// SPDX-License-Identifier: Apache-2.0
//
// openvdb::io::File writes a grid on one thread, compresses every buffer twice (once to learn its
// size for the delayed-load metadata) and does not notice a full disk. This writer makes the same
// bytes but for two: the file version is always 224, which OpenVDB 10 to 12 write and everything
// reads, and the UUID is derived from the content, so that equal content gives equal files.
//
// The metadata entry file_delayed_load is part of the file, as io::File writes it: readers work
// without, but delayed loading (Houdini's default) is several times faster with it.
//
// Layout: magic, file version, library version, "has offsets", UUID, file metadata, number of
// grids; for each grid: name, type, instance parent, three offsets (grid, buffers, end),
// compression flags, metadata, transform, topology, buffers.
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/io/volume/PackedGrid.h"
#include "tetvdb/io/volume/PackedPieces.h"
#include "tetvdb/io/volume/VdbPieces.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/PackedRange.h"

#include <map>
#include <openvdb/io/Archive.h>
#include <set>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <xxhash.h>

namespace tetvdb {
namespace {

constexpr std::uint32_t kFileVersion = 224;
constexpr std::size_t kUuidSize = 36;
// The entry's blocks are compressed by Blosc, which takes 2 GB at most: 8 bytes a leaf.
constexpr std::size_t kDelayedLoadLeaves = std::size_t(200) << 20;

/// The file, and a running hash of what went into it.
class Output {
public:
  explicit Output(const std::string& path) : file_(path), state_(XXH3_createState()) {
    if (!state_)
      throw std::bad_alloc();
    XXH3_128bits_reset(state_.get());
  }

  void write(const void* data, std::size_t size) {
    XXH3_128bits_update(state_.get(), data, size);
    file_.write(data, size);
  }
  template <class T>
  void value(const T& x) {
    write(&x, sizeof x);
  }
  void text(const std::string& x) {
    value(static_cast<std::uint32_t>(x.size()));
    write(x.data(), x.size());
  }

  AtomicFile& file() { return file_; }
  std::int64_t position() const { return static_cast<std::int64_t>(file_.size()); }

  /// A version 8 UUID of everything written so far.
  std::string uuid() const {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
    canonical.digest[6] = static_cast<unsigned char>((canonical.digest[6] & 0x0F) | 0x80);
    canonical.digest[8] = static_cast<unsigned char>((canonical.digest[8] & 0x3F) | 0x80);
    std::string text;
    for (int i = 0; i < 16; ++i) {
      if (i == 4 || i == 6 || i == 8 || i == 10)
        text += '-';
      text += "0123456789abcdef"[canonical.digest[i] >> 4];
      text += "0123456789abcdef"[canonical.digest[i] & 15];
    }
    return text;
  }

private:
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  AtomicFile file_;
  std::unique_ptr<XXH3_state_t, Free> state_;
};

/// Maps work done in one grid to the whole job's fraction.
class Share {
public:
  Share(Progress& progress, double from, double to) : progress_(progress), from_(from), to_(to) {}
  void update(double fraction) const { progress_.update(from_ + (to_ - from_) * fraction); }
  Share part(double from, double to) const {
    return {progress_, from_ + (to_ - from_) * from, from_ + (to_ - from_) * to};
  }

private:
  Progress& progress_;
  double from_, to_;
};

/// Makes pieces 0 to `count` in parallel, a window at a time, and writes them in order.
template <class Make>
void writePieces(std::size_t count, const Make& make, Output& output, const Share& share) {
  const auto window = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()) * 4;
  std::size_t next = 0, written = 0;
  tbb::parallel_pipeline(
      window, tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order,
                                                  [&](tbb::flow_control& flow) {
                                                    if (next == count)
                                                      flow.stop();
                                                    return next++;
                                                  }) &
                  tbb::make_filter<std::size_t, std::string>(
                      tbb::filter_mode::parallel, [&](std::size_t piece) { return make(piece); }) &
                  tbb::make_filter<std::string, void>(
                      tbb::filter_mode::serial_in_order, [&](const std::string& bytes) {
                        output.write(bytes.data(), bytes.size());
                        share.update(double(++written) / double(count));
                      }));
}

std::string metadataBytes(const openvdb::MetaMap& metadata) {
  NodeStream out(0, nullptr);
  metadata.writeMeta(out.stream());
  return std::move(out.bytes());
}

/// The grid with its creator named if it says nothing else.
openvdb::GridBase::Ptr withCreator(const openvdb::GridBase::Ptr& grid) {
  const openvdb::GridBase::Ptr copy = grid->copyGrid(); // shares the tree
  copy->setTransform(grid->transformPtr());             // the copy's was rounded
  if (copy->getCreator().empty())
    copy->setCreator(std::string("TetVDB ") + version());
  return copy;
}

/// Adds the statistics that io::File adds.
openvdb::GridBase::Ptr withStatistics(const openvdb::GridBase::Ptr& grid) {
  const openvdb::GridBase::Ptr copy = grid->copyGrid();
  copy->addStatsMetadata();
  copy->insertMeta(openvdb::GridBase::META_FILE_COMPRESSION,
                   openvdb::StringMetadata(openvdb::io::compressionToString(vdbCompression())));
  return copy;
}

struct Descriptor {
  std::string name, type, parent;
};

/// Writes one grid after another.
class VdbWriter {
public:
  explicit VdbWriter(Output& output) : output_(output) {}

  /// `packed`: where the leaves' values are, or null.
  void write(const openvdb::GridBase::Ptr& grid, const PackedGrid* packed, const Share& share) {
    Descriptor descriptor;
    descriptor.name = grid->getName();
    descriptor.type = grid->type() + (grid->saveFloatAsHalf() ? "_HalfFloat" : "");
    if (!names_.insert(descriptor.name).second || descriptor.name.empty())
      throw Error(Status::Usage, output_.file().path(),
                  "grid names must be unique and not empty: '" + descriptor.name + "'");

    const std::pair<const void*, bool> tree(&grid->baseTree(), grid->saveFloatAsHalf());
    const auto found = trees_.find(tree);
    const bool instance = found != trees_.end();
    if (instance)
      descriptor.parent = found->second;
    else
      trees_.emplace(tree, descriptor.name);

    output_.text(descriptor.name);
    output_.text(descriptor.type);
    output_.text(descriptor.parent);
    const std::int64_t offsetsAt = output_.position();
    std::int64_t offsets[3] = {0, 0, 0}; // grid, buffers, end
    output_.value(offsets);
    offsets[0] = output_.position();
    output_.value(vdbCompression());
    if (instance) {
      append(metadataBytes(*grid));
      writeTransform(*grid);
    } else {
      offsets[1] = writeTree(grid, packed, share);
    }
    offsets[2] = output_.position();
    output_.file().writeAt(static_cast<std::uint64_t>(offsetsAt), offsets, sizeof offsets);
  }

private:
  void append(const std::string& bytes) { output_.write(bytes.data(), bytes.size()); }

  void writeTransform(const openvdb::GridBase& grid) {
    NodeStream out(0, nullptr);
    grid.writeTransform(out.stream());
    append(out.bytes());
  }

  /// Metadata, transform and tree; returns where the buffers begin.
  std::int64_t writeTree(const openvdb::GridBase::Ptr& grid, const PackedGrid* packed,
                         const Share& share) {
    const openvdb::GridBase::Ptr copy = withStatistics(grid);
    std::int64_t buffersAt = 0;
    const bool known = withKnownGrid(std::as_const(*grid), [&](const auto& typed) {
      using TreeT = typename std::decay_t<decltype(typed)>::TreeType;
      if constexpr (!hasBitLeaves<TreeT>)
        if (packed != nullptr) {
          buffersAt = writePacked(typed, *packed, *copy, share);
          return;
        }
      buffersAt = writeTyped(typed, *copy, share);
    });
    if (!known)
      buffersAt = writeOther(*grid, *copy);
    return buffersAt;
  }

  template <class GridT>
  std::int64_t writeTyped(const GridT& grid, openvdb::GridBase& copy, const Share& share) {
    using TreeT = typename GridT::TreeType;
    const TreeT& tree = grid.constTree();
    BufferPieces<TreeT> buffers(tree, grid.saveFloatAsHalf(), vdbCompression());
    if constexpr (BufferPieces<TreeT>::kPlanned) {
      const Share planning = share.part(0, 0.5);
      std::atomic<std::size_t> done{0};
      tbb::parallel_for(std::size_t(0), buffers.size(), [&](std::size_t piece) {
        buffers.plan(piece);
        planning.update(double(++done) / double(buffers.size()));
      });
      describeLeaves(buffers, copy);
    }
    return writeNodes(grid, buffers, copy, share);
  }

  /// The same of a grid whose leaves are packed.
  template <class GridT>
  std::int64_t writePacked(const GridT& grid, const PackedGrid& packed, openvdb::GridBase& copy,
                           const Share& share) {
    const PackedPieces<typename GridT::TreeType> buffers(grid.constTree(), packed,
                                                         grid.saveFloatAsHalf());
    if (const auto bytes =
            copy.getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_MEM_BYTES))
      bytes->setValue(bytes->value() + static_cast<std::int64_t>(buffers.missingBytes()));
    describeLeaves(buffers, copy);
    return writeNodes(grid, buffers, copy, share);
  }

  template <class Buffers>
  static void describeLeaves(const Buffers& buffers, openvdb::GridBase& copy) {
    if (buffers.leafCount() > kDelayedLoadLeaves)
      return;
    openvdb::io::DelayedLoadMetadata delayed;
    buffers.describe(delayed);
    copy.insertMeta(openvdb::GridBase::META_FILE_DELAYED_LOAD, delayed);
  }

  /// Metadata, transform, topology and buffers; returns where the buffers begin.
  template <class GridT, class Buffers>
  std::int64_t writeNodes(const GridT& grid, const Buffers& buffers, const openvdb::GridBase& copy,
                          const Share& share) {
    append(metadataBytes(copy));
    writeTransform(grid);
    const TopologyPieces<typename GridT::TreeType> topology(
        grid.constTree(), grid.saveFloatAsHalf(), vdbCompression());
    writePieces(
        topology.size(), [&](std::size_t i) { return topology.make(i); }, output_,
        share.part(0.5, 0.6));
    const std::int64_t buffersAt = output_.position();
    writePieces(
        buffers.size(), [&](std::size_t i) { return buffers.make(i); }, output_,
        share.part(0.6, 1));
    return buffersAt;
  }

  /// A grid of a type that has no typed code: straight through, on one thread.
  std::int64_t writeOther(const openvdb::GridBase& grid, const openvdb::GridBase& copy) {
    append(metadataBytes(copy));
    SinkBuffer<Output> buffer(output_);
    std::ostream stream(&buffer);
    stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
    openvdb::io::StreamMetadata::Ptr metadata(new openvdb::io::StreamMetadata);
    metadata->setHalfFloat(grid.saveFloatAsHalf());
    metadata->gridMetadata() = static_cast<const openvdb::MetaMap&>(grid);
    openvdb::io::setStreamMetadataPtr(stream, metadata, /*transfer=*/false);
    openvdb::io::setDataCompression(stream, vdbCompression());
    grid.writeTransform(stream);
    grid.writeTopology(stream);
    const std::int64_t buffersAt = output_.position();
    grid.writeBuffers(stream);
    return buffersAt;
  }

  Output& output_;
  std::set<std::string> names_;
  std::map<std::pair<const void*, bool>, std::string> trees_; ///< written trees, as half or not
};

} // namespace

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

  Output output(path);
  output.value(std::int64_t(openvdb::OPENVDB_MAGIC));
  output.value(kFileVersion);
  output.value(std::uint32_t(openvdb::OPENVDB_LIBRARY_MAJOR_VERSION));
  output.value(std::uint32_t(openvdb::OPENVDB_LIBRARY_MINOR_VERSION));
  output.value(char(1)); // grids have offsets
  const std::int64_t uuidAt = output.position();
  output.write(std::string(kUuidSize, '0').data(), kUuidSize);

  openvdb::MetaMap metadata;
  for (const auto& [key, text] : volume.metadata)
    metadata.insertMeta(key, openvdb::StringMetadata(text));
  const std::string bytes = metadataBytes(metadata);
  output.write(bytes.data(), bytes.size());
  output.value(static_cast<std::int32_t>(grids.size()));

  VdbWriter writer(output);
  const Share whole(progress, 0, 1);
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const double count = double(grids.size());
    writer.write(withCreator(grids[i]), i < ordinary ? nullptr : packed[i - ordinary].get(),
                 whole.part(double(i) / count, double(i + 1) / count));
  }
  const std::string uuid = output.uuid();
  output.file().writeAt(static_cast<std::uint64_t>(uuidAt), uuid.data(), uuid.size());
  progress.check();
  output.file().commit();
}

} // namespace tetvdb
