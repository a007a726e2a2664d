// SPDX-License-Identifier: Apache-2.0
//
// The header of a .vdb file that is a part of a volume.
#pragma once

#include "tetvdb/io/volume/PartMetadata.h"
#include "tetvdb/io/volume/VdbHeader.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

/// A grid of the part.
struct PartGrid {
  VdbGridHeader header;      ///< without kPartLeaves and kPartLevel
  std::optional<bool> level; ///< kPartLevel
  std::string transformBytes;
  std::string root;  ///< bytes of the root node up to the number of tiles
  std::string tiles; ///< bytes of its tiles
  std::uint32_t tileCount = 0, children = 0;
  std::uint64_t topologyAt = 0; ///< of the children, in the file
  std::uint64_t leaves = 0;
};

struct VdbPart {
  std::string path;
  PartMetadata part;
  std::map<std::string, std::string> metadata; ///< of the file, but for those
  std::vector<PartGrid> grids;
};

/// Reads the header and checks that the file has the length that it states. Throws Error(Invalid).
VdbPart readVdbPart(const std::string& path);

} // namespace tetvdb
