// SPDX-License-Identifier: Apache-2.0
//
// Reads a grid of a .vdb file, one entry of its root node at a time, or less. Internal:
// instantiates OpenVDB's streams.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/VdbHeader.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/NodeBytes.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <openvdb/io/Compression.h>
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
  using Lower = typename NodeLists<TreeT>::Lower;
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
      if (entry->first != openvdb::GridBase::META_FILE_DELAYED_LOAD) // 9 bytes a leaf of the file
        grid->insertMeta(entry->first, *entry->second);
    grid->setName(grid_.name);
    if (grid_.half)
      grid->setSaveFloatAsHalf(true);
    grid->setTransform(grid_.transform);
    return grid;
  }

  /// The next entry, by x, then y, then z, as a grid that holds only this entry; null at the end.
  /// Memory: that of one child. Throws Error(Invalid).
  typename GridT::Ptr next(openvdb::Coord& origin) {
    return begin(origin) ? part(std::numeric_limits<std::size_t>::max()) : nullptr;
  }

  /// Goes to the next entry, of which part() gives the nodes; false at the end. The parts of the
  /// one before have all been read. Throws Error(Invalid).
  bool begin(openvdb::Coord& origin) {
    const auto tile = tiles_.begin();
    if (!nextChild_ && childrenLeft_ > 0)
      guarded([&] {
        --childrenLeft_;
        openvdb::Coord coord;
        topology_.file.read(reinterpret_cast<char*>(coord.data()), 12);
        nextChild_ = coord;
      });
    if (tile == tiles_.end() && !nextChild_)
      return false;
    under_ = true;
    if (tile != tiles_.end() && (!nextChild_ || tile->first < *nextChild_)) {
      origin_ = origin = tile->first;
      tile_ = tile->second;
      tiles_.erase(tile);
      return true;
    }
    origin_ = origin = *nextChild_;
    nextChild_.reset();
    guarded([&] { readUpper(); });
    return true;
  }

  /// A grid with the entry's next lower nodes alone, about `bytes` of them, at least one; the first
  /// also has the tiles. Null where all have come. Memory: that of these. Throws Error(Invalid).
  typename GridT::Ptr part(std::size_t bytes) {
    if (!under_)
      return nullptr;
    auto grid = empty();
    if (tile_) {
      grid->tree().root().addTile(origin_, tile_->first, tile_->second);
      tile_.reset();
      under_ = false;
      return grid;
    }
    guarded([&] {
      auto upper = first_ ? std::move(first_)
                          : std::make_unique<Upper>(origin_, background_, /*active=*/false);
      std::size_t used = 0;
      for (; entry_ < Upper::NUM_VALUES && (used == 0 || used < bytes);
           entry_ = children_.findNextOn(entry_ + 1))
        used += readLower(*upper);
      grid->tree().root().addChild(upper.release());
    });
    under_ = entry_ < Upper::NUM_VALUES;
    return grid;
  }

  /// The share of the file's grid that has been read.
  double share() {
    const auto at = static_cast<std::uint64_t>(std::streamoff(buffers_.file.tellg()));
    return at <= grid_.buffersAt
               ? 0
               : double(at - grid_.buffersAt) / double(grid_.end - grid_.buffersAt);
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

  // As OpenVDB reads it.
  void readUpper() {
    std::ifstream& file = topology_.file;
    children_.load(file);
    typename Upper::NodeMaskType active;
    active.load(file);
    const std::unique_ptr<T[]> values(new T[Upper::NUM_VALUES]);
    openvdb::io::readCompressedValues(file, values.get(), Upper::NUM_VALUES, active, grid_.half);
    first_ = std::make_unique<Upper>(origin_, background_, false);
    for (auto tile = children_.beginOff(); tile; ++tile)
      first_->addTile(tile.pos(), values[tile.pos()], active.isOn(tile.pos()));
    entry_ = children_.findFirstOn();
  }
  // Returns its bytes.
  std::size_t readLower(Upper& upper) {
    auto lower = std::make_unique<Lower>(openvdb::PartialCreate(),
                                         upper.offsetToGlobalCoord(entry_), background_, false);
    lower->readTopology(topology_.file, grid_.half);
    lower->readBuffers(buffers_.file, grid_.half);
    const std::size_t bytes = nodeBytes_.of(0, 1, lower->getChildMask().countOn());
    upper.addChild(lower.release());
    return bytes;
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
  const NodeBytes nodeBytes_ = openvdbNodeBytes<TreeT>();

  /// The entry under way.
  openvdb::Coord origin_;
  bool under_ = false; ///< something of it is to come
  std::optional<std::pair<T, bool>> tile_;
  std::unique_ptr<Upper> first_; ///< with its tiles, until the first part
  typename Upper::NodeMaskType children_;
  openvdb::Index entry_ = 0; ///< of the next lower node
};

} // namespace tetvdb
