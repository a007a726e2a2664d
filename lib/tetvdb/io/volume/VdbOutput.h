// SPDX-License-Identifier: Apache-2.0
//
// A .vdb file that is being written, and the functions that all writers of .vdb files share.
//
// Layout of the file: magic, file version, library version, "has offsets", UUID, file metadata,
// number of grids; for each grid its head (name, type, instance parent, three offsets, compression
// flags, metadata, transform, root node), then the topology of the root's children, then their
// buffers.
//
// The UUID is derived from the content, so that equal content gives equal files. Topology and
// buffers are hashed as they are written. Heads are hashed after their grids, since a writer that
// streams knows them only then.
#pragma once

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/MakeInOrder.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/core/ProgressShare.h"
#include "tetvdb/volume/VoxelBounds.h"

#include <cstdint>
#include <map>
#include <memory>
#include <openvdb/openvdb.h>
#include <string>
#include <xxhash.h>

namespace tetvdb {

/// The largest number of leaves of a grid for which the metadata entry file_delayed_load is
/// written. The entry comes before the topology, so that a writer that streams has to keep the
/// topology until then: 64 bytes a leaf. Readers work without the entry, but delayed loading is
/// slower.
constexpr std::uint64_t kDelayedLoadLeaves = std::uint64_t(1) << 20;

/// The head of a grid in the file.
struct VdbHead {
  std::string bytes;
  std::size_t offsetsAt = 0; ///< in `bytes`: place of the offsets of grid, buffers and end
};

/// `metadata` with the statistics and all; `root`: of grids that are no instances.
VdbHead makeVdbHead(const std::string& name, const std::string& type, const std::string& parent,
                    const openvdb::MetaMap& metadata, const openvdb::math::Transform& transform,
                    const std::string& root);

/// The grid, sharing its tree, with this program as its creator unless it names another.
openvdb::GridBase::Ptr withCreator(const openvdb::GridBase::Ptr& grid);

/// Counts of a grid whose nodes are written without a tree of it.
struct VdbCounts {
  VoxelBounds box; ///< of active voxels, where there are any
  std::uint64_t activeVoxels = 0, leaves = 0;
  std::uint64_t memoryBytes = 0; ///< of OpenVDB's nodes
};

/// The empty grid with the entries for such counts; `part`: with that of its leaves
/// (PartMetadata.h).
openvdb::GridBase::Ptr withCounts(const openvdb::GridBase::Ptr& grid, const VdbCounts& counts,
                                  bool part);

/// The name of the grid's type in the file.
std::string vdbTypeOf(const openvdb::GridBase& grid);

class VdbOutput {
public:
  /// Writes the header of the file. Throws as AtomicFile does.
  VdbOutput(const std::string& path, const std::map<std::string, std::string>& metadata,
            std::size_t grids);

  /// Appends to topology or buffers.
  void write(const void* data, std::size_t size) {
    XXH3_128bits_update(state_.get(), data, size);
    file_.write(data, size);
  }
  void write(const std::string& bytes) { write(bytes.data(), bytes.size()); }

  /// Appends a head; finishGrid() can replace it by one of the same size.
  void beginGrid(const VdbHead& head);
  /// Ends the grid. `buffersAt`: where its buffers begin, 0 for an instance.
  void finishGrid(const VdbHead& head, std::uint64_t buffersAt);

  std::uint64_t position() const { return file_.size(); }
  AtomicFile& file() { return file_; }

  /// Adds the UUID, which completes the file.
  void commit(Progress& progress);

private:
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  void hash(const std::string& bytes) {
    XXH3_128bits_update(state_.get(), bytes.data(), bytes.size());
  }

  AtomicFile file_;
  std::unique_ptr<XXH3_state_t, Free> state_;
  std::uint64_t uuidAt_ = 0, headAt_ = 0;
  std::size_t headSize_ = 0;
};

/// Writes grids whose trees are in memory, after others: their bytes in a file of writeVdb().
/// Throws as that does.
void writeGrids(VdbOutput& output, const openvdb::GridPtrVec& grids, const ProgressShare& share);

/// Makes blocks 0 to `count` - 1 in parallel and writes them in order.
template <class Make>
void writePieces(std::size_t count, const Make& make, VdbOutput& output,
                 const ProgressShare& share) {
  std::size_t next = 0, written = 0;
  makeInOrder<std::size_t, std::string>(
      [&](std::size_t& piece) {
        piece = next++;
        return piece < count;
      },
      make,
      [&](const std::string& bytes) {
        output.write(bytes);
        share.update(double(++written) / double(count));
      });
}

} // namespace tetvdb
