// SPDX-License-Identifier: Apache-2.0
//
// The beginning of a NanoVDB grid's buffer, of NanoVDB 32.4, whose buffers all newer versions read.
#pragma once

#include "tetvdb/io/volume/NvdbLayout.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <openvdb/openvdb.h>
#include <optional>
#include <string>

namespace tetvdb {

/// What a grid's nodes are, from leaves up.
struct NvdbCounts {
  std::uint32_t type = 0;     ///< nanovdb::GridType
  bool hasStatistics = false; ///< minimum to standard deviation
  std::array<std::uint64_t, 3> nodes{};
  std::array<std::uint64_t, 3> tiles{};  ///< active ones of lower nodes, upper nodes and the root
  std::array<std::uint64_t, 3> at{};     ///< where the nodes begin in the buffer
  std::uint64_t size = 0;                ///< of the buffer
  std::uint64_t voxels = 0;              ///< active
  std::optional<openvdb::CoordBBox> box; ///< of these
};

/// Throws Error(Usage) for a grid that cannot be in a .nvdb file: its type, a transform that is not
/// linear, a level set of whole numbers, a name of 256 bytes or more.
void requireNvdbForm(const openvdb::GridBase& grid, const std::string& path);

/// The head, without the root node. The grid's name, class and transform are taken.
NvdbGrid makeNvdbGrid(const openvdb::GridBase& grid, const NvdbCounts& counts);

/// Puts in the checksum of grid, tree and root, `head`, and that of the nodes.
void setNvdbChecksum(unsigned char* head, std::size_t size, std::uint32_t nodes);

} // namespace tetvdb
