// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/VdbPart.h"

#include "tetvdb/core/Error.h"

#include <fstream>
#include <sstream>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kMaxEntries = 1 << 24; // of a root node

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(Status::Invalid, path, what, "write this part again");
}

// Tiles and number of children.
void readRoot(const std::string& path, PartGrid& grid) {
  const std::string& type = grid.header.type;
  const bool isFloat = type == "Tree_float_5_4_3";
  if (!isFloat && type != "Tree_bool_5_4_3" && type != "Tree_mask_5_4_3")
    fail(path, "has a grid of a type that shards do not write");
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(grid.header.rootAt));
  const auto value = [&](auto& to) { file.read(reinterpret_cast<char*>(&to), sizeof to); };
  file.ignore(4);
  file.ignore(isFloat ? 4 : 1); // background
  std::uint32_t tiles = 0;
  value(tiles);
  value(grid.children);
  if (!file || tiles > kMaxEntries || grid.children > kMaxEntries)
    fail(path, "is cut or damaged");
  for (std::uint32_t i = 0; i < tiles && file; ++i) {
    grid.tiles.emplace_back();
    value(grid.tiles.back());
    file.ignore(isFloat ? 5 : 2); // value, active
  }
  if (!file)
    fail(path, "is cut or damaged");
  grid.topologyAt = static_cast<std::uint64_t>(file.tellg());
  if (grid.topologyAt > grid.header.buffersAt)
    fail(path, "is cut or damaged");
}

} // namespace

VdbPart readVdbPart(const std::string& path) {
  VdbHeader header = readVdbHeader(path);
  VdbPart part;
  part.path = path;
  part.metadata = std::move(header.metadata);
  if (header.fileVersion != 224 || !part.part.take(part.metadata))
    fail(path, "is no part of a volume");
  for (VdbGridHeader& one : header.grids) {
    PartGrid grid;
    grid.header = std::move(one);
    if (const auto leaves = grid.header.metadata.getMetadata<openvdb::Int64Metadata>(kPartLeaves))
      grid.leaves = static_cast<std::uint64_t>(leaves->value());
    grid.header.metadata.removeMeta(kPartLeaves);
    std::ostringstream transform;
    grid.header.transform->write(transform);
    grid.transformBytes = transform.str();
    readRoot(path, grid);
    part.grids.push_back(std::move(grid));
  }
  return part;
}

} // namespace tetvdb
