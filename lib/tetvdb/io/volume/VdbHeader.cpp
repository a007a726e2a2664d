// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/VdbHeader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/volume/Grids.h"

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <memory>
#include <openvdb/io/io.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::int32_t kMaxGrids = 1 << 16;
constexpr std::uint32_t kMaxText = 1 << 20;

class HeaderReader {
public:
  explicit HeaderReader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
    if (!file_)
      failToOpen(path, errno);
    std::error_code error;
    size_ = std::filesystem::file_size(path, error);
    if (error)
      fail("is no file");
    file_.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
  }

  VdbHeader read() {
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
    if (result_.grids.back().end != size_)
      fail("is cut or damaged");
    return std::move(result_);
  }

private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(Status::Invalid, path_, what, "write it again");
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
  std::uint64_t position() { return static_cast<std::uint64_t>(file_.tellg()); }

  void header() {
    const auto magic = value<std::int64_t>();
    result_.fileVersion = value<std::uint32_t>();
    result_.libraryMajor = value<std::uint32_t>();
    result_.libraryMinor = value<std::uint32_t>();
    const char offsets = value<char>();
    if (magic != std::int64_t(openvdb::OPENVDB_MAGIC))
      fail("is no .vdb file");
    if (result_.fileVersion < kFirstVdbVersion || offsets != 1)
      fail("is a .vdb file of an old version or without offsets");
    file_.ignore(36); // UUID
    openvdb::io::setVersion(file_, {result_.libraryMajor, result_.libraryMinor},
                            result_.fileVersion);
    openvdb::MetaMap metadata;
    metadata.readMeta(file_);
    for (auto entry = metadata.beginMeta(); entry != metadata.endMeta(); ++entry)
      result_.metadata[entry->first] = entry->second->str();
  }

  void grid() {
    VdbGridHeader grid;
    grid.name = text();
    grid.type = text();
    grid.parent = text();
    const std::string half = "_HalfFloat";
    if (grid.type.size() > half.size() &&
        grid.type.compare(grid.type.size() - half.size(), half.size(), half) == 0) {
      grid.half = true;
      grid.type.resize(grid.type.size() - half.size());
    }
    const auto at = value<std::uint64_t>();
    grid.buffersAt = value<std::uint64_t>();
    grid.end = value<std::uint64_t>();
    const bool instance = !grid.parent.empty();
    if (at != position() || grid.end < at || grid.end > size_ ||
        (!instance && (grid.buffersAt < at || grid.end < grid.buffersAt)))
      fail("is cut or damaged");
    grid.compression = value<std::uint32_t>();
    grid.metadata.readMeta(file_);
    grid.transform = std::make_shared<openvdb::math::Transform>();
    grid.transform->read(file_);
    grid.rootAt = position();
    if (grid.rootAt > (instance ? grid.end : grid.buffersAt))
      fail("is cut or damaged");
    file_.seekg(static_cast<std::streamoff>(grid.end));
    result_.grids.push_back(std::move(grid));
  }

  std::string path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  VdbHeader result_;
};

} // namespace

VdbHeader readVdbHeader(const std::string& path) {
  initializeOpenVDB();
  return HeaderReader(path).read();
}

} // namespace tetvdb
