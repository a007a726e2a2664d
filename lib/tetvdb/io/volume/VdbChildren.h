// SPDX-License-Identifier: Apache-2.0
//
// Reads a grid of a .vdb file, one entry of its root node at a time, or less; in parallel where the
// places of its nodes are known. Internal: instantiates OpenVDB's streams.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/StreamBuffers.h"
#include "tetvdb/io/volume/VdbHeader.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/NodeBytes.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <istream>
#include <limits>
#include <map>
#include <memory>
#include <openvdb/io/Compression.h>
#include <openvdb/io/io.h>
#include <optional>
#include <string>
#include <tbb/parallel_for.h>
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
      : path_(path), grid_(grid), fileVersion_(header.fileVersion),
        libraryVersion_(header.libraryMajor, header.libraryMinor),
        background_(openvdb::zeroVal<T>()) {
    for (Stream* stream : {&topology_, &buffers_}) {
      stream->file.open(path, std::ios::binary);
      prepare(stream->file, stream->metadata);
    }
    if (!grid.lowers.empty())
      mapped_.emplace(path);
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
      if (mapped_)
        readPlaced(bytes, *upper);
      else
        readNext(bytes, *upper);
      grid->tree().root().addChild(upper.release());
    });
    under_ = entry_ < Upper::NUM_VALUES;
    return grid;
  }

  /// The share of the file's grid that has been read.
  double share() {
    const std::vector<VdbLowerPlace>& lowers = grid_.lowers;
    const std::uint64_t at = !mapped_
                                 ? static_cast<std::uint64_t>(std::streamoff(buffers_.file.tellg()))
                             : nextLower_ < lowers.size() ? lowers[nextLower_].buffersAt
                                                          : grid_.end;
    return at <= grid_.buffersAt
               ? 0
               : double(at - grid_.buffersAt) / double(grid_.end - grid_.buffersAt);
  }

private:
  struct Stream {
    std::ifstream file;
    openvdb::io::StreamMetadata::Ptr metadata;
  };

  /// Of nodes that are read at a time; more would not be faster.
  static constexpr std::size_t kMappedBytes = std::size_t(8) << 20;

  /// `metadata` must outlive the stream's use.
  void prepare(std::istream& stream, openvdb::io::StreamMetadata::Ptr& metadata) const {
    stream.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
    openvdb::io::setVersion(stream, libraryVersion_, fileVersion_);
    metadata = std::make_shared<openvdb::io::StreamMetadata>();
    metadata->setFileVersion(fileVersion_);
    metadata->setLibraryVersion(libraryVersion_);
    metadata->setHalfFloat(grid_.half);
    metadata->setCompression(grid_.compression);
    metadata->setSeekable(false);
    openvdb::io::setStreamMetadataPtr(stream, metadata, false);
    openvdb::io::setDataCompression(stream, grid_.compression);
    openvdb::io::setGridBackgroundValuePtr(stream, &background_);
  }

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
  // Lower nodes at the streams' places, about so many bytes of them in memory.
  void readNext(std::size_t bytes, Upper& upper) {
    std::size_t used = 0;
    for (; entry_ < Upper::NUM_VALUES && (used == 0 || used < bytes);
         entry_ = children_.findNextOn(entry_ + 1)) {
      auto lower = readLower(upper.offsetToGlobalCoord(entry_), topology_.file, buffers_.file);
      used += nodeBytes_.of(0, 1, lower->getChildMask().countOn());
      upper.addChild(lower.release());
    }
  }
  // The same, in parallel.
  void readPlaced(std::size_t bytes, Upper& upper) {
    std::size_t used = 0;
    while (entry_ < Upper::NUM_VALUES && (used == 0 || used < bytes)) {
      std::vector<openvdb::Index> entries;
      const VdbLowerPlace* const first = &grid_.lowers[nextLower_];
      for (std::size_t inFile = 0;
           entry_ < Upper::NUM_VALUES && (used == 0 || used < bytes) && inFile < kMappedBytes;
           entry_ = children_.findNextOn(entry_ + 1)) {
        const VdbLowerPlace& place = grid_.lowers[nextLower_++];
        entries.push_back(entry_);
        used += nodeBytes_.of(0, 1, place.leaves);
        inFile += place.topologyBytes + place.buffersBytes;
      }
      std::vector<std::unique_ptr<Lower>> lowers(entries.size());
      tbb::parallel_for(std::size_t(0), entries.size(), [&](std::size_t i) {
        lowers[i] = readMapped(upper.offsetToGlobalCoord(entries[i]), first[i]);
      });
      for (auto& lower : lowers)
        upper.addChild(lower.release());
      mapped_->source().release();
      const VdbLowerPlace& last = first[entries.size() - 1];
      topology_.file.seekg(static_cast<std::streamoff>(last.topologyAt + last.topologyBytes));
    }
  }
  std::unique_ptr<Lower> readMapped(const openvdb::Coord& origin,
                                    const VdbLowerPlace& place) const {
    ByteSource topology(mapped_->bytes().substr(place.topologyAt, place.topologyBytes));
    ByteSource buffers(mapped_->bytes().substr(place.buffersAt, place.buffersBytes));
    std::istream streams[2]{std::istream(&topology), std::istream(&buffers)};
    openvdb::io::StreamMetadata::Ptr metadata[2]; // one for both would be contended
    for (int i = 0; i < 2; ++i)
      prepare(streams[i], metadata[i]);
    return readLower(origin, streams[0], streams[1]);
  }
  std::unique_ptr<Lower> readLower(const openvdb::Coord& origin, std::istream& topology,
                                   std::istream& buffers) const {
    auto lower =
        std::make_unique<Lower>(openvdb::PartialCreate(), origin, background_, /*active=*/false);
    lower->readTopology(topology, grid_.half);
    lower->readBuffers(buffers, grid_.half);
    return lower;
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
  std::uint32_t fileVersion_;
  openvdb::VersionId libraryVersion_;
  T background_;
  Stream topology_, buffers_;
  std::optional<MappedFile> mapped_; ///< where the grid's places are known
  std::size_t nextLower_ = 0;        ///< of these
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
