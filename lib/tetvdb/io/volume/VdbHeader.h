// SPDX-License-Identifier: Apache-2.0
//
// The headers of a .vdb file and of its grids, which precede the nodes.
#pragma once

#include <cstdint>
#include <map>
#include <openvdb/openvdb.h>
#include <string>
#include <vector>

namespace tetvdb {

/// Of OpenVDB 3, the first with the tree's layout that is read here.
constexpr std::uint32_t kFirstVdbVersion = 222;
/// Of OpenVDB 13, which adds a type of grid to the version before and changes nothing else.
constexpr std::uint32_t kLastVdbVersion = 225;

/// A lower node in the file.
struct VdbLowerPlace {
  std::uint64_t topologyAt, buffersAt;
  std::uint32_t topologyBytes, buffersBytes;
  std::uint32_t leaves;
};

struct VdbGridHeader {
  std::string name, type, parent;
  bool half = false; ///< `type` is without its suffix for that
  std::uint32_t compression = 0;
  openvdb::MetaMap metadata;
  openvdb::math::Transform::Ptr transform;          ///< exact
  std::uint64_t rootAt = 0, buffersAt = 0, end = 0; ///< in the file
  std::vector<VdbLowerPlace> lowers; ///< in order; only where the file was looked through
};

struct VdbHeader {
  std::uint32_t fileVersion = 0, libraryMajor = 0, libraryMinor = 0;
  std::map<std::string, std::string> metadata;
  std::vector<VdbGridHeader> grids;
};

/// Reads the headers and checks that the file has the length that they state. Reads files with
/// offsets of kFirstVdbVersion and above. Throws Error(Invalid).
VdbHeader readVdbHeader(const std::string& path);

} // namespace tetvdb
