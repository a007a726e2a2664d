// SPDX-License-Identifier: Apache-2.0
//
// The bytes that OpenVDB's nodes write to a .vdb file, for nodes whose active voxels all have one
// value and whose inactive voxels have the background value. The bytes of the values of a node or a
// leaf depend only on the number of active ones, so that topology can be read back without
// decompressing them.
#pragma once

#include "tetvdb/volume/BitSource.h"
#include "tetvdb/volume/NodeBytes.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <openvdb/openvdb.h>
#include <string>
#include <vector>

namespace tetvdb {

/// Masks of a 4096^3 node, bits as in BitNode.
struct UpperMasks {
  std::array<std::uint64_t, 512> children{}, tiles{};
};

/// Encodes the nodes of one kind of grid. Thread-safe.
class BitCodec {
public:
  virtual ~BitCodec() = default;

  /// The root node with full cubes as tiles.
  virtual std::string root(const std::vector<Vec3i>& tiles, std::uint32_t children) const = 0;
  virtual std::string upper(const Vec3i& origin, const UpperMasks& masks) const = 0;
  virtual void addLower(const BitNode& node, std::string& out) const = 0;
  /// The buffers of a node's leaves; `origin`: the node's first voxel.
  virtual void addBuffers(const Vec3i& origin, const BitNode& node, std::string& out) const = 0;

  /// Bytes of the values of a node with so many tiles.
  virtual std::size_t upperValues(std::size_t tiles) const = 0;
  virtual std::size_t lowerValues(std::size_t tiles) const = 0;

  /// The metadata entry file_delayed_load for leaves with so many active voxels; null where grids
  /// of this kind have none.
  virtual openvdb::Metadata::Ptr delayedLoad(const std::vector<std::uint16_t>& leaves) const = 0;
  virtual bool hasDelayedLoad() const = 0;

  /// Memory of the nodes of a tree, as OpenVDB counts it, and as describe() does.
  virtual NodeBytes openvdbBytes() const = 0;
  virtual NodeBytes describedBytes() const = 0;
};

/// For a FloatGrid (inside 1, background 0), BoolGrid or MaskGrid. Throws Error(Usage) for others.
std::unique_ptr<BitCodec> makeBitCodec(const openvdb::GridBase& grid);

} // namespace tetvdb
