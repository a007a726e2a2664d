// SPDX-License-Identifier: Apache-2.0
//
// The canonical form of a tree is the list of its leaves and of its tiles, without inactive tiles
// of the background's value, by coordinates and level. Internal nodes are not part of it: an empty
// node and none are the same. Each 128^3 node is hashed on its own, a 4096^3 node over the hashes
// of its children, and the grid over these, so that any number of threads gives the same result.
#include "tetvdb/core/Error.h"
#include "tetvdb/volume/GridHash.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>
#include <vector>
#include <xxhash.h>

namespace tetvdb {
namespace {

struct FreeState {
  void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};

class Hasher {
public:
  Hasher() : state_(XXH3_createState()) {
    if (!state_)
      throw std::bad_alloc();
    reset();
  }
  void reset() {
    XXH3_128bits_reset(state_.get());
    used_ = 0;
  }
  void bytes(const void* data, std::size_t size) {
    if (used_ + size > sizeof staged_)
      flush();
    if (size > sizeof staged_ / 4) {
      flush();
      XXH3_128bits_update(state_.get(), data, size);
      return;
    }
    std::memcpy(staged_ + used_, data, size);
    used_ += size;
  }
  template <class T>
  void value(const T& x) {
    bytes(&x, sizeof x);
  }
  void text(const std::string& x) {
    value(std::uint64_t(x.size()));
    bytes(x.data(), x.size());
  }
  XXH128_hash_t digest() {
    flush();
    return XXH3_128bits_digest(state_.get());
  }

private:
  void flush() {
    XXH3_128bits_update(state_.get(), staged_, used_);
    used_ = 0;
  }

  char staged_[4096]; ///< many small updates are several times as slow as one
  std::size_t used_ = 0;
  std::unique_ptr<XXH3_state_t, FreeState> state_;
};

enum class Tag : std::uint32_t { Tile = 1, Leaf, Lower, Upper };

template <class T>
bool sameBits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Adds the tile at `offset` unless it is inactive background; true if it was added.
template <class Sink, class T>
bool addTile(Sink& hasher, std::uint32_t offset, const T& value, bool active, const T& background) {
  if (!active && sameBits(value, background))
    return false;
  hasher.value(Tag::Tile);
  hasher.value(offset);
  hasher.value(std::uint32_t(active));
  hasher.bytes(&value, sizeof value);
  return true;
}

template <class Leaf>
void addLeaf(Hasher& hasher, std::uint32_t offset, const Leaf& leaf) {
  hasher.value(Tag::Leaf);
  hasher.value(offset);
  std::uint64_t words[8];
  for (openvdb::Index i = 0; i < 8; ++i)
    words[i] = leaf.getValueMask().template getWord<openvdb::Index64>(i);
  hasher.value(words);
  if constexpr (std::is_same<typename Leaf::ValueType, bool>::value) {
    hasher.bytes(leaf.buffer().data(), sizeof words);
  } else {
    hasher.bytes(leaf.buffer().data(), Leaf::SIZE * sizeof(typename Leaf::ValueType));
  }
}

struct NodeHash {
  XXH128_hash_t hash{};
  bool empty = true;
};

template <class Lower, class T>
NodeHash hashLower(Hasher& hasher, const Lower& node, const T& background) {
  hasher.reset();
  NodeHash result;
  for (openvdb::Index i = 0; i < Lower::NUM_VALUES; ++i) {
    const auto& entry = node.getTable()[i];
    if (node.getChildMask().isOn(i)) {
      addLeaf(hasher, i, *entry.getChild());
      result.empty = false;
    } else if (addTile(hasher, i, T(entry.getValue()), node.getValueMask().isOn(i), background)) {
      result.empty = false;
    }
  }
  result.hash = hasher.digest();
  return result;
}

/// The data of an entry of the root node that is hashed.
struct RootEntry {
  openvdb::Coord origin;
  std::string bytes;
};

/// Buffers small writes to a hasher.
struct Bytes {
  std::string text;
  void bytes(const void* data, std::size_t size) {
    text.append(static_cast<const char*>(data), size);
  }
  template <class T>
  void value(const T& x) {
    bytes(&x, sizeof x);
  }
};

/// A child of the root node whose entries come part by part.
class UpperEntries {
public:
  explicit UpperEntries(const openvdb::Coord& origin) : origin_(origin) {}
  const openvdb::Coord& origin() const { return origin_; }

  /// `lowers`: the hashes of the node's children, in order.
  template <class Upper, class T>
  void add(const Upper& node, const NodeHash* lowers, const T& background) {
    for (openvdb::Index i = 0; i < Upper::NUM_VALUES; ++i) {
      const std::size_t begin = bytes_.text.size();
      if (node.getChildMask().isOn(i)) {
        const NodeHash& child = *lowers++;
        if (child.empty)
          continue;
        bytes_.value(Tag::Lower);
        bytes_.value(std::uint32_t(i));
        bytes_.value(child.hash);
      } else if (!addTile(bytes_, i, T(node.getTable()[i].getValue()), node.getValueMask().isOn(i),
                          background)) {
        continue;
      }
      pieces_.push_back({i, begin, bytes_.text.size() - begin});
    }
  }

  /// Adds the node to the root's entries, unless it holds nothing.
  void finish(std::vector<RootEntry>& entries) {
    if (pieces_.empty())
      return;
    std::sort(pieces_.begin(), pieces_.end(),
              [](const Piece& a, const Piece& b) { return a.entry < b.entry; });
    Hasher hasher;
    for (const Piece& piece : pieces_)
      hasher.bytes(bytes_.text.data() + piece.begin, piece.size);
    Bytes bytes;
    bytes.value(Tag::Upper);
    bytes.bytes(origin_.data(), 3 * sizeof(openvdb::Int32));
    bytes.value(hasher.digest());
    entries.push_back({origin_, std::move(bytes.text)});
  }

private:
  struct Piece {
    openvdb::Index entry;
    std::size_t begin, size; ///< in bytes_
  };

  openvdb::Coord origin_;
  Bytes bytes_;
  std::vector<Piece> pieces_;
};

template <class TreeT>
std::vector<NodeHash> hashLowers(const NodeLists<TreeT>& nodes, const TreeT& tree) {
  std::vector<NodeHash> lowers(nodes.lowers.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lowers.size()), [&](const auto& range) {
    Hasher own;
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      lowers[i] = hashLower(own, *nodes.lowers[i], tree.background());
  });
  return lowers;
}

void addHead(Hasher& hasher, const openvdb::GridBase& grid) {
  hasher.text(grid.getName());
  hasher.text(grid.type());
  hasher.text(openvdb::GridBase::gridClassToString(grid.getGridClass()));
  hasher.text(canonicalBytes(grid.transform()));
}

std::string textOf(const XXH128_hash_t& hash) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, hash);
  return {reinterpret_cast<const char*>(canonical.digest), sizeof canonical.digest};
}

} // namespace

struct GridHash::Entries {
  Hasher hasher;
  std::vector<RootEntry> all;
  std::optional<UpperEntries> upper; ///< under way

  void endUpper() {
    if (upper)
      upper->finish(all);
    upper.reset();
  }

  template <class TreeT>
  void add(const TreeT& tree) {
    using T = typename TreeT::ValueType;
    const NodeLists<TreeT> nodes(tree);
    const std::vector<NodeHash> lowers = hashLowers(nodes, tree);
    const NodeHash* next = lowers.data();
    for (const auto* node : nodes.uppers) {
      if (upper && upper->origin() != node->origin())
        endUpper();
      if (!upper)
        upper.emplace(node->origin());
      upper->add(*node, next, tree.background());
      next += node->getChildMask().countOn();
    }
    for (auto tile = tree.root().cbeginValueAll(); tile; ++tile) {
      Bytes bytes;
      if (!addTile(bytes, 0, T(*tile), tile.isValueOn(), tree.background()))
        continue;
      bytes.bytes(tile.getCoord().data(), 3 * sizeof(openvdb::Int32));
      all.push_back({tile.getCoord(), std::move(bytes.text)});
    }
  }
};

GridHash::GridHash(const openvdb::GridBase& grid) : entries_(std::make_unique<Entries>()) {
  addHead(entries_->hasher, grid);
  if (!withKnownGrid(
          grid, [&](const auto& typed) { entries_->hasher.value(typed.constTree().background()); }))
    throw Error(Status::Usage, grid.getName(),
                "grids of type " + grid.type() + " are not supported");
}

GridHash::~GridHash() = default;

void GridHash::add(const openvdb::GridBase& part) {
  withKnownGrid(part, [&](const auto& typed) { entries_->add(typed.constTree()); });
}

std::string GridHash::finish() {
  entries_->endUpper();
  std::sort(entries_->all.begin(), entries_->all.end(),
            [](const RootEntry& a, const RootEntry& b) { return a.origin < b.origin; });
  for (const RootEntry& entry : entries_->all)
    entries_->hasher.bytes(entry.bytes.data(), entry.bytes.size());
  return textOf(entries_->hasher.digest());
}

std::string hashOfGrids(std::vector<std::pair<std::string, std::string>> grids) {
  std::sort(grids.begin(), grids.end(), [](const auto& a, const auto& b) {
    if (a.first != b.first)
      return a.first < b.first;
    return std::memcmp(a.second.data(), b.second.data(), a.second.size()) < 0;
  });
  Hasher hasher;
  for (const auto& grid : grids)
    hasher.bytes(grid.second.data(), grid.second.size());
  std::string text;
  for (const char c : textOf(hasher.digest())) {
    const auto byte = static_cast<unsigned char>(c);
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

std::string hash(const Volume& volume) {
  std::vector<std::pair<std::string, std::string>> grids;
  for (const auto& grid : volume.grids().all) {
    GridHash whole(*grid);
    whole.add(*grid);
    grids.emplace_back(grid->getName(), whole.finish());
  }
  return hashOfGrids(std::move(grids));
}

} // namespace tetvdb
