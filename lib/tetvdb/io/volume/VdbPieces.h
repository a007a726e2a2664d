// SPDX-License-Identifier: Apache-2.0
//
// Converts a tree to the bytes of a .vdb file, block by block: blocks are made in parallel and
// written in order. Internal to the .vdb writer.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/StreamBuffers.h"
#include "tetvdb/io/volume/TailStore.h"
#include "tetvdb/volume/BitSelect.h"
#include "tetvdb/volume/GridTypes.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <deque>
#include <memory>
#include <mutex>
#include <openvdb/io/Archive.h>
#include <openvdb/io/Compression.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <ostream>
#include <tbb/enumerable_thread_specific.h>
#include <unordered_map>

namespace tetvdb {

/// Compression of all grids: Blosc where OpenVDB has it, active mask.
inline std::uint32_t vdbCompression() {
  namespace io = openvdb::io;
  if (io::Archive::hasBloscCompression())
    return io::COMPRESS_BLOSC | io::COMPRESS_ACTIVE_MASK;
  return io::COMPRESS_ACTIVE_MASK;
}

/// Bytes of a leaf's mask, which come before its tail.
constexpr std::size_t kLeafMaskBytes = 64;

/// The entry for delayed loading of leaf `l`, whose tail has `size` bytes: the place where the next
/// leaf begins.
template <typename T>
void describeTail(openvdb::io::DelayedLoadMetadata& metadata, std::size_t l, std::int8_t how,
                  std::size_t size) {
  namespace io = openvdb::io;
  size -= 1; // the byte itself, then what it calls for
  if (how == io::NO_MASK_AND_ONE_INACTIVE_VAL || how == io::MASK_AND_ONE_INACTIVE_VAL)
    size -= sizeof(T);
  if (how == io::MASK_AND_TWO_INACTIVE_VALS)
    size -= 2 * sizeof(T);
  if (how == io::MASK_AND_NO_INACTIVE_VALS || how == io::MASK_AND_ONE_INACTIVE_VAL ||
      how == io::MASK_AND_TWO_INACTIVE_VALS)
    size -= kLeafMaskBytes;
  if (size == 0)
    size = 8; // half floats, none active: the value of io::File, which no reader uses
  metadata.setMask(l, how);
  metadata.setCompressedSize(l, static_cast<std::int64_t>(size));
}

/// A stream in memory that OpenVDB's nodes can be written to.
class NodeStream {
public:
  NodeStream(std::uint32_t compression, const void* background)
      : buffer_(sink_), stream_(&buffer_) {
    stream_.exceptions(std::ios_base::badbit | std::ios_base::failbit);
    openvdb::io::setDataCompression(stream_, compression);
    openvdb::io::setGridBackgroundValuePtr(stream_, background);
  }
  std::ostream& stream() { return stream_; }
  std::string& bytes() { return sink_.bytes; }

private:
  ByteSink sink_;
  SinkBuffer<ByteSink> buffer_;
  std::ostream stream_;
};

/// An upper node without its children, which are at the entries of `children`.
template <class Upper, class Mask>
void writeUpperNode(std::ostream& out, const Upper& node, const Mask& children, bool asHalf) {
  using T = typename Upper::ValueType;
  const openvdb::Coord origin = node.origin();
  out.write(reinterpret_cast<const char*>(origin.data()), 3 * sizeof(openvdb::Int32));
  children.save(out);
  node.getValueMask().save(out);
  const std::unique_ptr<T[]> values(new T[Upper::NUM_VALUES]);
  for (openvdb::Index i = 0; i < Upper::NUM_VALUES; ++i)
    values[i] = children.isOn(i) ? openvdb::zeroVal<T>() : T(node.getTable()[i].getValue());
  openvdb::io::writeCompressedValues(out, values.get(), Upper::NUM_VALUES, node.getValueMask(),
                                     children, asHalf);
}

/// The tree's structure: the root with its tiles, then the pieces: every internal node before its
/// children, of leaves the masks.
template <class TreeT>
class TopologyPieces {
public:
  TopologyPieces(const TreeT& tree, bool asHalf, std::uint32_t compression)
      : tree_(tree), asHalf_(asHalf), compression_(compression), background_(tree.background()) {
    for (auto child = tree.root().cbeginChildOn(); child; ++child) {
      nodes_.push_back({&*child, nullptr});
      for (auto below = child->cbeginChildOn(); below; ++below)
        nodes_.push_back({nullptr, &*below});
    }
  }

  std::string root() const {
    NodeStream out(compression_, &background_);
    writeRoot(out.stream());
    return std::move(out.bytes());
  }

  std::size_t size() const { return (nodes_.size() + kNodesAPiece - 1) / kNodesAPiece; }

  std::string make(std::size_t piece) const {
    NodeStream out(compression_, &background_);
    const std::size_t begin = piece * kNodesAPiece;
    const std::size_t end = std::min(begin + kNodesAPiece, nodes_.size());
    for (std::size_t i = begin; i < end; ++i) {
      if (nodes_[i].lower)
        nodes_[i].lower->writeTopology(out.stream(), asHalf_);
      else
        writeUpperNode(out.stream(), *nodes_[i].upper, nodes_[i].upper->getChildMask(), asHalf_);
    }
    return std::move(out.bytes());
  }

private:
  static constexpr std::size_t kNodesAPiece = 4; // a lower node takes up to 280 KB
  using T = typename TreeT::ValueType;
  using Upper = typename NodeLists<TreeT>::Upper;
  using Lower = typename NodeLists<TreeT>::Lower;
  struct Node { // one of the two
    const Upper* upper = nullptr;
    const Lower* lower = nullptr;
  };

  template <class V>
  static void put(std::ostream& out, const V& value) {
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
  }
  static void putCoord(std::ostream& out, const openvdb::Coord& coord) {
    out.write(reinterpret_cast<const char*>(coord.data()), 3 * sizeof(openvdb::Int32));
  }

  void writeRoot(std::ostream& out) const {
    const auto& root = tree_.root();
    put(out, std::int32_t(1)); // buffers a leaf
    put(out, asHalf_ ? T(openvdb::io::truncateRealToHalf(background_)) : background_);
    std::uint32_t children = 0, tiles = 0;
    for (auto child = root.cbeginChildOn(); child; ++child)
      ++children;
    for (auto tile = root.cbeginChildOff(); tile; ++tile)
      ++tiles;
    put(out, tiles);
    put(out, children);
    for (auto tile = root.cbeginValueAll(); tile; ++tile) {
      putCoord(out, tile.getCoord());
      put(out, T(*tile));
      put(out, tile.isValueOn());
    }
  }

  const TreeT& tree_;
  bool asHalf_;
  std::uint32_t compression_;
  T background_;
  std::vector<Node> nodes_;
};

/// The leaves' buffers: of each leaf its mask again, then its tail: a byte that says how inactive
/// values are restored, and the compressed active values.
///
/// In a fog most leaves hold one value where they are active and the background elsewhere. Their
/// tail depends only on that value and the number of active voxels: it is compressed once and
/// shared. A piece is made in one step by make(), after which describe() knows its tails; or, where
/// describe() is needed before the first piece is used, in two, plan() and make(), between which
/// the tails of other leaves lie in a store.
template <class TreeT>
class BufferPieces {
public:
  /// Whether leaves have tails, which plan() and describe() are for.
  static constexpr bool kHasTails = !hasBitLeaves<TreeT>;

  BufferPieces(const TreeT& tree, bool asHalf, std::uint32_t compression)
      : asHalf_(asHalf), compression_(compression), background_(tree.background()),
        leaves_(NodeLists<TreeT>(tree).leaves()),
        pieces_((leaves_.size() + kLeavesAPiece - 1) / kLeavesAPiece),
        caches_([] { return std::vector<CacheEntry>(kCacheEntries); }) {
    if constexpr (kHasTails) {
      tails_.resize(leaves_.size());
      restore_.resize(leaves_.size());
    }
  }

  std::size_t size() const { return pieces_.size(); }
  std::size_t leafCount() const { return leaves_.size(); }

  /// The size in the entry of leaf `l`, of which nothing is known yet. Not thread-safe.
  std::size_t sizeOf(std::size_t l) {
    NodeStream out(compression_, &background_);
    encode(l, caches_.local(), out);
    openvdb::io::DelayedLoadMetadata one;
    one.resizeMask(1);
    one.resizeCompressedSize(1);
    describeTail<T>(one, 0, restore_[l], tailSize(l));
    return static_cast<std::size_t>(one.getCompressedSize(0));
  }

  /// Makes the tails of the piece's leaves and stores those that are not shared. Where the store
  /// has no room, make() compresses them again. Thread-safe for different pieces.
  void plan(std::size_t piece, TailStore& store) {
    NodeStream out(compression_, &background_);
    std::string own;
    auto& cache = caches_.local();
    for (std::size_t l = begin(piece); l < end(piece); ++l)
      if (encode(l, cache, out) == nullptr)
        own.append(out.bytes(), kLeafMaskBytes);
    Piece& stored = pieces_[piece];
    try {
      for (std::size_t at = 0; at < own.size(); at += TailStore::kChunk)
        stored.places.push_back(
            store.add(own.data() + at, std::min(TailStore::kChunk, own.size() - at)));
      stored.store = &store;
      stored.size = own.size();
    } catch (const Error&) {
      stored.places.clear();
    }
  }

  /// The bytes of a piece. Thread-safe for different pieces. Throws Error(Write) as its store does.
  std::string make(std::size_t piece) {
    NodeStream out(compression_, &background_);
    if constexpr (!kHasTails) {
      for (std::size_t l = begin(piece); l < end(piece); ++l)
        leaves_[l]->writeBuffers(out.stream(), asHalf_);
      return std::move(out.bytes());
    } else {
      return pieces_[piece].store != nullptr ? joinTails(piece) : encodeAll(piece);
    }
  }

  /// The entry for OpenVDB's delayed loading of each leaf, when all pieces are planned or made.
  void describe(openvdb::io::DelayedLoadMetadata& metadata) const {
    metadata.resizeMask(leaves_.size());
    metadata.resizeCompressedSize(leaves_.size());
    for (std::size_t l = 0; l < leaves_.size(); ++l)
      describeTail<T>(metadata, l, restore_[l], tailSize(l));
  }

private:
  using T = typename TreeT::ValueType;
  using Leaf = typename TreeT::LeafNodeType;

  static constexpr std::size_t kLeavesAPiece = 512;
  static constexpr std::size_t kCacheEntries = 1024;
  static constexpr std::size_t kSharedTails = 1 << 16;
  static constexpr std::uint32_t kOwn = std::uint32_t(1) << 31;

  struct Piece { // the tails of its leaves that share none, where they are stored
    const TailStore* store = nullptr;
    std::vector<std::uint64_t> places; ///< of their bytes, TailStore::kChunk at each but the last
    std::size_t size = 0;
  };
  struct CacheEntry {
    openvdb::Index count = ~openvdb::Index(0);
    T value{};
    std::uint32_t tail = 0;
    const std::string* bytes = nullptr; ///< of the tail
  };

  std::size_t begin(std::size_t piece) const { return piece * kLeavesAPiece; }
  std::size_t end(std::size_t piece) const {
    return std::min(begin(piece) + kLeavesAPiece, leaves_.size());
  }

  std::size_t tailSize(std::size_t l) const {
    return (tails_[l] & kOwn) != 0 ? tails_[l] & ~kOwn : shared_[tails_[l]].size();
  }

  static bool sameBits(const T& a, const T& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

  /// True if the leaf's active values are all `value` and its inactive ones the background, by
  /// bits.
  bool uniform(const Leaf& leaf, T& value) const {
    const T* data = leaf.buffer().data();
    const auto& mask = leaf.getValueMask();
    const openvdb::Index first = mask.findFirstOn();
    value = first < Leaf::SIZE ? data[first] : background_;
    for (openvdb::Index w = 0; w < Leaf::SIZE / 64; ++w)
      if (!uniformRow(data + 64 * w, mask.template getWord<openvdb::Index64>(w), value))
        return false;
    return true;
  }

  /// The same of 64 values.
  bool uniformRow(const T* data, std::uint64_t word, const T& value) const {
    if constexpr (sizeof(T) == 4) {
      std::uint32_t off, flip;
      std::memcpy(&off, &background_, 4);
      std::memcpy(&flip, &value, 4);
      flip ^= off;
      std::uint32_t differs[8] = {};
      for (int byte = 0; byte < 8; ++byte) {
        std::uint32_t bits[8];
        std::memcpy(bits, data + 8 * byte, sizeof bits);
        const auto& active = kLaneMasks[word >> (8 * byte) & 0xFF];
        for (std::size_t i = 0; i < 8; ++i)
          differs[i] |= bits[i] ^ off ^ (active[i] & flip);
      }
      std::uint32_t any = 0;
      for (const std::uint32_t lane : differs)
        any |= lane;
      return any == 0;
    } else {
      const T expected[2] = {background_, value};
      bool same = true;
      for (int i = 0; i < 64; ++i)
        same &= sameBits(data[i], expected[word >> i & 1]);
      return same;
    }
  }

  /// Sets the entries of leaf `l` and returns its tail if that is shared; else makes mask and tail
  /// the content of `out` and returns null.
  const std::string* encode(std::size_t l, std::vector<CacheEntry>& cache, NodeStream& out) {
    const Leaf& leaf = *leaves_[l];
    T value;
    if (uniform(leaf, value))
      if (const CacheEntry* entry = sharedTail(leaf, value, cache, out)) {
        tails_[l] = entry->tail;
        restore_[l] = openvdb::io::NO_MASK_OR_INACTIVE_VALS;
        return entry->bytes;
      }
    out.bytes().clear();
    leaf.writeBuffers(out.stream(), asHalf_);
    tails_[l] = kOwn | static_cast<std::uint32_t>(out.bytes().size() - kLeafMaskBytes);
    restore_[l] = static_cast<std::int8_t>(out.bytes()[kLeafMaskBytes]);
    return nullptr;
  }

  /// The tail of all leaves with this value and number of active voxels; null if there are too many
  /// different ones.
  const CacheEntry* sharedTail(const Leaf& leaf, const T& value, std::vector<CacheEntry>& cache,
                               NodeStream& out) {
    const openvdb::Index count = leaf.getValueMask().countOn();
    std::uint64_t slot = count;
    for (std::size_t i = 0; i + 4 <= sizeof(T); i += 4) {
      std::uint32_t word;
      std::memcpy(&word, reinterpret_cast<const char*>(&value) + i, 4);
      slot = (slot ^ word) * 0x9E3779B97F4A7C15u;
    }
    CacheEntry& entry = cache[(slot >> 32) % kCacheEntries];
    if (entry.count != count || !sameBits(entry.value, value)) {
      out.bytes().clear();
      leaf.writeBuffers(out.stream(), asHalf_);
      std::string tail = out.bytes().substr(kLeafMaskBytes);
      const std::lock_guard<std::mutex> lock(mutex_);
      const auto found = tailIds_.find(tail);
      if (found == tailIds_.end() && shared_.size() >= kSharedTails)
        return nullptr;
      if (found == tailIds_.end()) {
        entry.tail = static_cast<std::uint32_t>(shared_.size());
        tailIds_.emplace(tail, entry.tail);
        shared_.push_back(std::move(tail));
      } else {
        entry.tail = found->second;
      }
      entry.bytes = &shared_[entry.tail];
      entry.count = count;
      entry.value = value;
    }
    return &entry;
  }

  std::string encodeAll(std::size_t piece) {
    NodeStream all(compression_, &background_), one(compression_, &background_);
    auto& cache = caches_.local();
    for (std::size_t l = begin(piece); l < end(piece); ++l) {
      if (const std::string* tail = encode(l, cache, one)) {
        leaves_[l]->getValueMask().save(all.stream());
        all.bytes() += *tail;
      } else {
        all.bytes() += one.bytes();
      }
    }
    return std::move(all.bytes());
  }

  /// The same of stored tails.
  std::string joinTails(std::size_t piece) const {
    const Piece& stored = pieces_[piece];
    std::string own(stored.size, '\0');
    for (std::size_t i = 0; i < stored.places.size(); ++i) {
      const std::size_t at = i * TailStore::kChunk;
      stored.store->read(stored.places[i], own.data() + at,
                         std::min(TailStore::kChunk, own.size() - at));
    }
    NodeStream all(compression_, &background_);
    all.bytes().reserve((end(piece) - begin(piece)) * 3 * kLeafMaskBytes + own.size());
    std::size_t next = 0; // in `own`
    for (std::size_t l = begin(piece); l < end(piece); ++l) {
      leaves_[l]->getValueMask().save(all.stream());
      const std::size_t size = tails_[l] & ~kOwn;
      if ((tails_[l] & kOwn) != 0) {
        all.bytes().append(own, next, size);
        next += size;
      } else {
        all.bytes() += shared_[tails_[l]];
      }
    }
    return std::move(all.bytes());
  }

  bool asHalf_;
  std::uint32_t compression_;
  T background_;
  std::vector<const Leaf*> leaves_;
  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> tails_; ///< index into shared_, or kOwn with the size in bytes
  std::vector<std::int8_t> restore_; ///< the first byte of each tail

  std::mutex mutex_; ///< for the two below, while tails are made
  std::deque<std::string> shared_;
  std::unordered_map<std::string, std::uint32_t> tailIds_;
  tbb::enumerable_thread_specific<std::vector<CacheEntry>> caches_;
};

} // namespace tetvdb
