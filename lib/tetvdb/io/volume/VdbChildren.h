// SPDX-License-Identifier: Apache-2.0
//
// Reads a grid of a .vdb file, one entry of its root node at a time. Internal: instantiates
// OpenVDB's streams.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/VdbHeader.h"
#include "tetvdb/volume/GridTypes.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <openvdb/io/io.h>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

template <class GridT>
class VdbChildren {
public:
  using TreeT = typename GridT::TreeType;
  using Upper = typename NodeLists<TreeT>::Upper;
  using T = typename TreeT::ValueType;

  /// `grid`: of the file, no instance, of GridT's type. Throws Error(Invalid).
  VdbChildren(const std::string& path, const VdbHeader& header, const VdbGridHeader& grid)
      : path_(path), grid_(grid), background_(openvdb::zeroVal<T>()) {
    for (Stream* stream : {&topology_, &buffers_}) {
      stream->file.open(path, std::ios::binary);
      stream->file.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
      openvdb::io::setVersion(stream->file, {header.libraryMajor, header.libraryMinor},
                              header.fileVersion);
      stream->metadata = std::make_shared<openvdb::io::StreamMetadata>();
      stream->metadata->setFileVersion(header.fileVersion);
      stream->metadata->setLibraryVersion({header.libraryMajor, header.libraryMinor});
      stream->metadata->setHalfFloat(grid.half);
      stream->metadata->setCompression(grid.compression);
      stream->metadata->setSeekable(false);
      openvdb::io::setStreamMetadataPtr(stream->file, stream->metadata, false);
      openvdb::io::setDataCompression(stream->file, grid.compression);
      openvdb::io::setGridBackgroundValuePtr(stream->file, &background_);
    }
    guarded([&] { readRoot(); });
  }

  /// The grid without voxels.
  typename GridT::Ptr empty() const {
    auto grid = GridT::create(background_);
    for (auto entry = grid_.metadata.beginMeta(); entry != grid_.metadata.endMeta(); ++entry)
      grid->insertMeta(entry->first, *entry->second);
    grid->removeMeta(openvdb::GridBase::META_FILE_DELAYED_LOAD);
    grid->setName(grid_.name);
    if (grid_.half)
      grid->setSaveFloatAsHalf(true);
    grid->setTransform(grid_.transform);
    return grid;
  }

  /// The next entry, by x, then y, then z, as a grid that holds only this entry; null at the end.
  /// Memory: that of one child. Throws Error(Invalid).
  typename GridT::Ptr next(openvdb::Coord& origin) {
    const auto tile = tiles_.begin();
    if (!nextChild_ && childrenLeft_ > 0)
      guarded([&] {
        --childrenLeft_;
        openvdb::Coord coord;
        topology_.file.read(reinterpret_cast<char*>(coord.data()), 12);
        nextChild_ = coord;
      });
    if (tile == tiles_.end() && !nextChild_)
      return nullptr;
    auto grid = empty();
    if (tile != tiles_.end() && (!nextChild_ || tile->first < *nextChild_)) {
      origin = tile->first;
      grid->tree().root().addTile(origin, tile->second.first, tile->second.second);
      tiles_.erase(tile);
      return grid;
    }
    origin = *nextChild_;
    nextChild_.reset();
    guarded([&] {
      auto child = std::make_unique<Upper>(openvdb::PartialCreate(), origin, background_, false);
      child->readTopology(topology_.file, grid_.half);
      child->readBuffers(buffers_.file, grid_.half);
      grid->tree().root().addChild(child.release());
    });
    return grid;
  }

private:
  struct Stream {
    std::ifstream file;
    openvdb::io::StreamMetadata::Ptr metadata;
  };

  template <class Read>
  void guarded(const Read& read) const {
    try {
      read();
    } catch (const Error&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw Error(Status::Limit, path_, "does not fit in memory, or is damaged");
    } catch (const std::exception& e) {
      throw Error(Status::Invalid, path_, std::string("cannot be read: ") + e.what());
    }
  }

  void readRoot() {
    std::ifstream& file = topology_.file;
    file.seekg(static_cast<std::streamoff>(grid_.rootAt));
    buffers_.file.seekg(static_cast<std::streamoff>(grid_.buffersAt));
    const auto value = [&](auto& to) { file.read(reinterpret_cast<char*>(&to), sizeof to); };
    std::int32_t buffers = 0;
    value(buffers);
    value(background_);
    std::uint32_t tiles = 0;
    value(tiles);
    value(childrenLeft_);
    for (std::uint32_t i = 0; i < tiles; ++i) {
      openvdb::Coord origin;
      T tile{};
      bool active = false;
      file.read(reinterpret_cast<char*>(origin.data()), 12);
      value(tile);
      value(active);
      tiles_.emplace(origin, std::make_pair(tile, active));
    }
  }

  std::string path_;
  const VdbGridHeader& grid_;
  T background_;
  Stream topology_, buffers_;
  std::map<openvdb::Coord, std::pair<T, bool>> tiles_;
  std::uint32_t childrenLeft_ = 0;
  std::optional<openvdb::Coord> nextChild_;
};

} // namespace tetvdb
