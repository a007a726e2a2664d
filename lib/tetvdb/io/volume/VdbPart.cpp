// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/VdbPart.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <openvdb/io/io.h>
#include <sstream>

namespace tetvdb {
namespace {

constexpr std::int32_t kMaxGrids = 1024;
constexpr std::uint32_t kMaxText = 1 << 20;
constexpr std::uint32_t kMaxEntries = 1 << 24; // of a root node

class PartReader {
public:
  explicit PartReader(const std::string& path) : file_(path, std::ios::binary) {
    part_.path = path;
    std::error_code error;
    size_ = std::filesystem::file_size(path, error);
    if (!file_ || error)
      fail("cannot be read");
    file_.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
  }

  VdbPart read() {
    try {
      header();
      const auto grids = value<std::int32_t>();
      if (grids < 1 || grids > kMaxGrids)
        fail("holds no grid");
      for (std::int32_t g = 0; g < grids; ++g)
        grid();
    } catch (const Error&) {
      throw;
    } catch (const std::exception&) {
      fail("is cut or damaged");
    }
    if (part_.grids.back().end != size_)
      fail("is cut or damaged");
    return std::move(part_);
  }

private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(Status::Invalid, part_.path, what, "write this part again");
  }

  template <class T>
  T value() {
    T result;
    file_.read(reinterpret_cast<char*>(&result), sizeof result);
    return result;
  }
  std::string text() {
    const auto size = value<std::uint32_t>();
    if (size > kMaxText)
      fail("is cut or damaged");
    std::string result(size, '\0');
    file_.read(result.data(), static_cast<std::streamsize>(size));
    return result;
  }

  void header() {
    const auto magic = value<std::int64_t>();
    const auto version = value<std::uint32_t>();
    value<std::uint64_t>(); // of the library
    const char offsets = value<char>();
    if (magic != std::int64_t(openvdb::OPENVDB_MAGIC) || version != 224 || offsets != 1)
      fail("is no .vdb file that a shard has written");
    file_.ignore(36);
    openvdb::io::setVersion(file_, openvdb::VersionId(10, 0), version);
    openvdb::MetaMap metadata;
    metadata.readMeta(file_);
    for (auto entry = metadata.beginMeta(); entry != metadata.endMeta(); ++entry)
      part_.metadata[entry->first] = entry->second->str();
    if (!part_.part.take(part_.metadata))
      fail("is no part of a volume");
  }

  void grid() {
    PartGrid grid;
    grid.name = text();
    grid.type = text();
    grid.parent = text();
    const auto at = value<std::uint64_t>();
    grid.buffersAt = value<std::uint64_t>();
    grid.end = value<std::uint64_t>();
    if (at != position() || grid.buffersAt < at || grid.end < grid.buffersAt || grid.end > size_)
      fail("is cut or damaged");
    value<std::uint32_t>(); // compression
    grid.metadata.readMeta(file_);
    grid.transform = std::make_shared<openvdb::math::Transform>();
    grid.transform->read(file_);
    std::ostringstream transform;
    grid.transform->write(transform);
    grid.transformBytes = transform.str();
    if (const auto leaves = grid.metadata.getMetadata<openvdb::Int64Metadata>(kPartLeaves))
      grid.leaves = static_cast<std::uint64_t>(leaves->value());
    grid.metadata.removeMeta(kPartLeaves);
    root(grid);
    grid.topologyAt = position();
    if (grid.topologyAt > grid.buffersAt)
      fail("is cut or damaged");
    file_.seekg(static_cast<std::streamoff>(grid.end));
    part_.grids.push_back(std::move(grid));
  }

  void root(PartGrid& grid) {
    const bool isFloat = grid.type.rfind("Tree_float", 0) == 0;
    if (!isFloat && grid.type != "Tree_bool_5_4_3" && grid.type != "Tree_mask_5_4_3")
      fail("has a grid of a type that shards do not write");
    file_.ignore(4);
    file_.ignore(isFloat ? 4 : 1); // background
    const auto tiles = value<std::uint32_t>();
    grid.children = value<std::uint32_t>();
    if (tiles > kMaxEntries || grid.children > kMaxEntries)
      fail("is cut or damaged");
    for (std::uint32_t i = 0; i < tiles; ++i) {
      grid.tiles.push_back(value<Vec3i>());
      file_.ignore(isFloat ? 5 : 2); // value, active
    }
  }

  std::uint64_t position() { return static_cast<std::uint64_t>(file_.tellg()); }

  std::ifstream file_;
  std::uint64_t size_ = 0;
  VdbPart part_;
};

} // namespace

VdbPart readVdbPart(const std::string& path) {
  initializeOpenVDB();
  return PartReader(path).read();
}

} // namespace tetvdb
