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

// Bytes of a value of the types that shards write; 0 for others.
std::size_t valueBytes(const std::string& type) {
  if (type == "Tree_float_5_4_3" || type == "Tree_int32_5_4_3")
    return 4;
  if (type == "Tree_vec3s_5_4_3")
    return 12;
  return type == "Tree_bool_5_4_3" || type == "Tree_mask_5_4_3" ? 1 : 0;
}

// Tiles and number of children.
void readRoot(const std::string& path, PartGrid& grid) {
  const std::size_t value = valueBytes(grid.header.type);
  if (value == 0)
    fail(path, "has a grid of a type that shards do not write");
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(grid.header.rootAt));
  const auto bytes = [&](std::string& to, std::size_t size) {
    to.resize(size);
    file.read(to.data(), static_cast<std::streamsize>(size));
  };
  const auto number = [&](std::uint32_t& to) {
    file.read(reinterpret_cast<char*>(&to), sizeof to);
  };
  bytes(grid.root, sizeof(std::int32_t) + value); // buffers a leaf, background
  number(grid.tileCount);
  number(grid.children);
  if (!file || grid.tileCount > kMaxEntries || grid.children > kMaxEntries)
    fail(path, "is cut or damaged");
  const std::size_t tile = 3 * sizeof(std::int32_t) + value + 1; // origin, value, active
  if (grid.tileCount * tile > grid.header.end - grid.header.rootAt)
    fail(path, "is cut or damaged");
  bytes(grid.tiles, grid.tileCount * tile);
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
    if (const auto level = grid.header.metadata.getMetadata<openvdb::BoolMetadata>(kPartLevel))
      grid.level = level->value();
    for (const char* name : {kPartLeaves, kPartLevel})
      grid.header.metadata.removeMeta(name);
    std::ostringstream transform;
    grid.header.transform->write(transform);
    grid.transformBytes = transform.str();
    readRoot(path, grid);
    part.grids.push_back(std::move(grid));
  }
  return part;
}

} // namespace tetvdb
