// SPDX-License-Identifier: Apache-2.0
//
// A grid on its way into a volume file, part by part: what it will be in the file waits in files
// without names until all parts have come.
//
//   const auto spool = tetvdb::makeVdbSpool(empty, options);
//   spool->beginCube(origin);
//   spool->add(part); ...                 // parts of the 4096^3 cube in the order of its nodes
//   spool->endCube();
//   spool->writeTo(output, share);
#pragma once

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/io/volume/TailStore.h"
#include "tetvdb/io/volume/VdbOutput.h"
#include "tetvdb/volume/Volume.h"

#include <cstddef>
#include <memory>
#include <openvdb/openvdb.h>
#include <optional>
#include <string>

namespace tetvdb {

struct SpoolOptions {
  std::string folder;                           ///< of the files
  std::size_t inMemory = std::size_t(16) << 20; ///< bytes of topology and of buffers, each
  bool part = false;                            ///< the grid says how many leaves it has
  /// Every node and tile is kept as it is, those too that pruning would change.
  bool exact = false;
  /// Where the bytes wait with those of other grids until none of them is needed any more, in place
  /// of stores of the grid's own.
  std::shared_ptr<TailStore> store;
  /// Of a grid for a .vdb file that is one cube: its first tile is opened as openFirstTile() does,
  /// without open().
  bool openFirstTile = false;
};

class GridSpool {
public:
  virtual ~GridSpool() = default;
  virtual void beginCube(const Vec3i& origin) = 0;
  /// A grid of the type, with nodes of this cube alone; it may change. Throws Error(Write), and
  /// Error(Limit) for 2^32 leaves or more.
  virtual void add(const openvdb::GridBase::Ptr& part) = 0;
  virtual void endCube() = 0;

  /// The first active tile of a grid without leaves, by x, then y, then z; after the last cube.
  virtual std::optional<Vec3i> tileAlone() const = 0;
  /// Opens this tile to a leaf when its part comes, as openFirstTile() does.
  virtual void open(const Vec3i& tile) = 0;

  /// What describe() says of the whole grid.
  virtual GridInfo describe() const = 0;
};

/// For a .vdb file: the bytes of its topology and of its buffers.
class VdbSpool : public GridSpool {
public:
  /// Writes the grid: the bytes that a whole tree would give. To be called once.
  virtual void writeTo(VdbOutput& output, const ProgressShare& share) = 0;
};

/// For a .nvdb file: its nodes, level by level.
class NvdbSpool : public GridSpool {
public:
  /// Appends the grid: the bytes that a whole tree would give. To be called once.
  virtual void writeTo(AtomicFile& file, const ProgressShare& share) = 0;
};

/// `empty`: with name, class, transform and metadata, and the background of the grid. Throw
/// Error(Usage) for types that are not supported.
std::unique_ptr<VdbSpool> makeVdbSpool(const openvdb::GridBase::Ptr& empty,
                                       const SpoolOptions& options);
std::unique_ptr<NvdbSpool> makeNvdbSpool(const openvdb::GridBase::Ptr& empty,
                                         const SpoolOptions& options);

} // namespace tetvdb
