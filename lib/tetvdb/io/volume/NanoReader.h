// SPDX-License-Identifier: Apache-2.0
//
// Turns a NanoVDB grid's buffer into OpenVDB's nodes, one entry of the root node at a time, or
// less. NanoVDB's own reader trusts what a buffer says: here every offset is checked before it is
// followed. Internal: instantiates both libraries.
#pragma once

#include "tetvdb/io/volume/NodeChecksum.h"
#include "tetvdb/io/volume/NvdbFile.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/NodeBytes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <tbb/parallel_for.h>
#include <type_traits>
#include <utility>
#include <vector>

namespace tetvdb {

template <class BuildT>
struct OpenValue { // the source of OpenVDB's tree
  using Type = BuildT;
};
template <>
struct OpenValue<nanovdb::Vec3f> {
  using Type = openvdb::Vec3s;
};
template <>
struct OpenValue<nanovdb::ValueMask> {
  using Type = openvdb::ValueMask;
};

template <class BuildT>
class NanoReader {
  using NanoRoot = nanovdb::NanoRoot<BuildT>;
  using NanoUpper = nanovdb::NanoUpper<BuildT>;
  using NanoLower = nanovdb::NanoLower<BuildT>;
  using NanoLeaf = nanovdb::NanoLeaf<BuildT>;

public:
  using Grid = openvdb::Grid<typename openvdb::tree::Tree4<typename OpenValue<BuildT>::Type>::Type>;

private:
  using TreeT = typename Grid::TreeType;
  using T = typename TreeT::ValueType;
  using Upper = typename TreeT::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  using Leaf = typename TreeT::LeafNodeType;

public:
  /// Checks the buffer: all offsets, and the checksum. `bytes`: at a multiple of 32; `release`: is
  /// called now and then, for memory that can be read again from a file. Throws Error(Invalid).
  NanoReader(const unsigned char* bytes, const NvdbFile& file, const NvdbFile::Grid& grid,
             std::function<void()> release)
      : bytes_(bytes), size_(grid.size), file_(file), grid_(grid), release_(std::move(release)) {
    std::memcpy(&header_, bytes, sizeof header_);
    check();
  }

  /// The grid without voxels. Throws Error(Invalid).
  typename Grid::Ptr empty() const {
    auto grid = Grid::create(value(at<NanoRoot>(rootAt_)->background()));
    setHeader(*grid);
    return grid;
  }

  /// Goes to the next entry of the root node, by x, then y, then z; false at the end.
  bool begin(openvdb::Coord& origin) {
    if (entry_ == entries_.size())
      return false;
    origin = entries_[entry_++].origin;
    child_ = 0;
    under_ = true;
    return true;
  }

  /// Adds the entry's next lower nodes to `grid`, about `bytes` of them, at least one; at first
  /// also its tiles. False where all have come. In parallel.
  bool read(Grid& grid, std::size_t bytes) {
    if (!under_)
      return false;
    const Entry& entry = entries_[entry_ - 1];
    auto& root = grid.tree().root();
    if (entry.upperAt == 0) {
      const auto* tile = rootData()->tile(entry.tile);
      root.addTile(entry.origin, value(tile->value), tile->state != 0);
      under_ = false;
      return true;
    }
    const auto* from = dataOf(at<NanoUpper>(entry.upperAt));
    auto upper = std::make_unique<Upper>(entry.origin, grid.background(), false);
    if (child_ == 0)
      for (openvdb::Index n = 0; n < Upper::NUM_VALUES; ++n)
        if (!from->mChildMask.isOn(n))
          upper->addTile(n, value(from->mTable[n].value), from->mValueMask.isOn(n));

    struct Job {
      const NanoLower* from;
      openvdb::Index entry;
    };
    std::vector<Job> jobs;
    std::size_t used = 0;
    for (; child_ < Upper::NUM_VALUES && (used == 0 || used < bytes); ++child_)
      if (from->mChildMask.isOn(child_)) {
        jobs.push_back({from->getChild(child_), child_});
        const std::size_t leaves = dataOf(jobs.back().from)->mChildMask.countOn();
        used += nodeBytes_.of(0, 1, leaves) + leaves * sizeof(NanoLeaf); // which are mapped
      }
    while (child_ < Upper::NUM_VALUES && !from->mChildMask.isOn(child_))
      ++child_;
    under_ = child_ < Upper::NUM_VALUES;

    std::vector<std::unique_ptr<Lower>> lowers(jobs.size());
    tbb::parallel_for(std::size_t(0), jobs.size(), [&](std::size_t i) {
      lowers[i] = makeLower(*dataOf(jobs[i].from), upper->offsetToGlobalCoord(jobs[i].entry),
                            grid.background());
    });
    for (auto& lower : lowers)
      upper->addChild(lower.release());
    lowersRead_ += jobs.size();
    releaseAfter(used);
    root.addChild(upper.release());
    return true;
  }

  /// The same as a grid of its own; null where all have come.
  typename Grid::Ptr part(std::size_t bytes) {
    auto grid = empty();
    return read(*grid, bytes) ? grid : nullptr;
  }

  /// The share of the nodes that has been read.
  double share() const { return lowers_ == 0 ? 1 : double(lowersRead_) / double(lowers_); }

private:
  struct Entry {
    openvdb::Coord origin;
    std::uint64_t upperAt; ///< 0: a tile
    std::uint32_t tile;
  };

  [[noreturn]] void fail(const std::string& what) const { file_.fail(grid_, what); }

  void releaseAfter(std::size_t bytes) {
    constexpr std::size_t kBetween = std::size_t(8) << 20;
    used_ += bytes;
    if (used_ < kBetween || !release_)
      return;
    release_();
    used_ = 0;
  }

  template <class Node>
  const Node* at(std::uint64_t offset) const {
    return reinterpret_cast<const Node*>(bytes_ + offset);
  }
  template <class Node>
  static const typename Node::DataType* dataOf(const Node* node) {
    return reinterpret_cast<const typename Node::DataType*>(node);
  }
  const typename NanoRoot::DataType* rootData() const {
    return at<typename NanoRoot::DataType>(rootAt_);
  }
  template <class V>
  static T value(const V& nano) {
    if constexpr (std::is_same<V, nanovdb::Vec3f>::value)
      return T(nano[0], nano[1], nano[2]);
    else if constexpr (std::is_same<V, bool>::value)
      return *reinterpret_cast<const unsigned char*>(&nano) != 0; // any byte of the file
    else
      return T(nano);
  }

  /// Offset of a node that lies `distance` from the one at `from`; throws unless it is within the
  /// buffer.
  std::uint64_t child(std::uint64_t from, std::int64_t distance, std::uint64_t size) const {
    constexpr std::uint64_t kAlignment = 32;
    const std::uint64_t to = from + static_cast<std::uint64_t>(distance);
    if (to % kAlignment != 0 || to < first_ || to > size_ || size > size_ - to)
      fail("a node lies outside its grid");
    return to;
  }

  /// A node that is used twice would let a small file grow without bound: nodes of a level cannot
  /// be more than fit into the file, nor other than the tree says.
  void requireCount(int level, std::uint64_t count, std::uint64_t size, bool all) const {
    if (count > header_.nodeCount[level] || count > size_ / size)
      fail("there are more nodes than announced");
    if (all && count != header_.nodeCount[level])
      fail("nodes are missing");
  }

  /// Checks that all offsets that the conversion and the checksum follow lie within the buffer, and
  /// the checksum. Memory: 8 bytes a lower node.
  void check() {
    checkRoot();
    std::vector<std::uint64_t> uppers, lowers;
    for (const Entry& entry : entries_)
      if (entry.upperAt != 0)
        uppers.push_back(entry.upperAt);
    requireCount(2, uppers.size(), sizeof(NanoUpper), true);
    for (const std::uint64_t upperAt : uppers) {
      const auto* upper = dataOf(at<NanoUpper>(upperAt));
      for (std::uint32_t n = 0; n < NanoUpper::SIZE; ++n)
        if (upper->mChildMask.isOn(n))
          lowers.push_back(child(upperAt, upper->mTable[n].child, sizeof(NanoLower)));
      requireCount(1, lowers.size(), sizeof(NanoLower), false);
    }
    requireCount(1, lowers.size(), sizeof(NanoLower), true);
    lowers_ = lowers.size();

    const bool summed = hasNodeSum();
    NodeChecksum nodes;
    if (summed) {
      addSums(uppers, sizeof(NanoUpper), nodes);
      addSums(lowers, sizeof(NanoLower), nodes);
    }
    checkLeaves(lowers, summed, nodes);
    if (summed && lowers.size() + uppers.size() > 0 &&
        static_cast<std::uint32_t>(nodes.value()) != header_.checksum >> 32)
      failChecksum();
    std::sort(entries_.begin(), entries_.end(),
              [](const Entry& a, const Entry& b) { return a.origin < b.origin; });
    for (std::size_t i = 1; i < entries_.size(); ++i)
      if (entries_[i].origin == entries_[i - 1].origin)
        fail("two root entries have the same place");
  }

  void checkRoot() {
    const std::uint64_t rootOffset = header_.nodeOffset[3];
    const std::uint64_t room = size_ - kNvdbTreeAt;
    if (rootOffset % 32 != 0 || rootOffset < 64 || rootOffset > room ||
        sizeof(typename NanoRoot::DataType) > room - rootOffset)
      fail("the root node lies outside its grid");
    rootAt_ = kNvdbTreeAt + rootOffset;
    using Tile = std::decay_t<decltype(*rootData()->tile(0))>;
    first_ = rootAt_ + sizeof(typename NanoRoot::DataType);
    const std::uint64_t tiles = rootData()->mTableSize;
    if (tiles > (size_ - first_) / sizeof(Tile))
      fail("the root node lies outside its grid");
    first_ += tiles * sizeof(Tile);
    for (std::uint32_t i = 0; i < tiles; ++i) {
      const auto* tile = rootData()->tile(i);
      const nanovdb::Coord key = std::decay_t<decltype(*rootData())>::KeyToCoord(tile->key);
      entries_.push_back({openvdb::Coord(key[0] & ~0xFFF, key[1] & ~0xFFF, key[2] & ~0xFFF),
                          tile->child == 0 ? 0 : child(rootAt_, tile->child, sizeof(NanoUpper)),
                          i});
    }
  }

  /// Whether the checksum of the nodes has to be right, after a look at that of grid, tree and
  /// root. Either may be missing. Newer minor versions of NanoVDB may compute both in another way.
  bool hasNodeSum() const {
    constexpr std::uint32_t absent = 0xFFFFFFFF;
    if ((header_.version >> 10 & 0x7FF) != NANOVDB_MINOR_VERSION_NUMBER)
      return false;
    const auto head = static_cast<std::uint32_t>(header_.checksum);
    const auto tail = static_cast<std::uint32_t>(header_.checksum >> 32);
    if (head == absent && tail == absent)
      return false;
    constexpr std::uint64_t skipped = 16; // magic and checksum
    const std::uint64_t headSize = first_ - header_.nodeOffset[3] + 64;
    if (static_cast<std::uint32_t>(NodeChecksum::of(bytes_ + skipped, headSize - skipped)) != head)
      failChecksum();
    return tail != absent;
  }
  [[noreturn]] void failChecksum() const {
    fail("the checksum of grid '" + name() + "' does not match");
  }

  void addSums(const std::vector<std::uint64_t>& nodes, std::size_t size, NodeChecksum& sum) {
    constexpr std::size_t kAtOnce = 256;
    for (std::size_t begin = 0; begin < nodes.size(); begin += kAtOnce) {
      std::vector<std::uint64_t> sums(std::min(kAtOnce, nodes.size() - begin));
      tbb::parallel_for(std::size_t(0), sums.size(), [&](std::size_t i) {
        sums[i] = NodeChecksum::of(bytes_ + nodes[begin + i], size);
      });
      sum.add(sums);
      releaseAfter(sums.size() * size);
    }
  }

  void checkLeaves(const std::vector<std::uint64_t>& lowers, bool summed, NodeChecksum& sum) {
    std::uint64_t leaves = 0;
    std::vector<std::uint64_t> own;
    for (const std::uint64_t lowerAt : lowers) {
      const auto* lower = dataOf(at<NanoLower>(lowerAt));
      own.clear();
      for (std::uint32_t n = 0; n < NanoLower::SIZE; ++n)
        if (lower->mChildMask.isOn(n))
          own.push_back(child(lowerAt, lower->mTable[n].child, sizeof(NanoLeaf)));
      leaves += own.size();
      if (summed)
        addSums(own, sizeof(NanoLeaf), sum);
      requireCount(0, leaves, sizeof(NanoLeaf), false);
    }
    requireCount(0, leaves, sizeof(NanoLeaf), true);
  }

  std::unique_ptr<Lower> makeLower(const typename NanoLower::DataType& node,
                                   const openvdb::Coord& origin, const T& background) const {
    auto lower = std::make_unique<Lower>(origin, background, false);
    for (openvdb::Index n = 0; n < Lower::NUM_VALUES; ++n) {
      if (!node.mChildMask.isOn(n)) {
        lower->addTile(n, value(node.mTable[n].value), node.mValueMask.isOn(n));
        continue;
      }
      const NanoLeaf& from = *node.getChild(n);
      auto* leaf = new Leaf(lower->offsetToGlobalCoord(n), background, false);
      lower->addLeaf(leaf);
      for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
        if constexpr (std::is_same<BuildT, nanovdb::ValueMask>::value) {
          if (dataOf(&from)->mValueMask.isOn(i))
            leaf->setValueOn(i);
        } else {
          leaf->setValueOnly(i, value(dataOf(&from)->getValue(i)));
          leaf->setActiveState(i, dataOf(&from)->mValueMask.isOn(i));
        }
      }
    }
    return lower;
  }

  std::string name() const { return {header_.name, ::strnlen(header_.name, sizeof header_.name)}; }

  void setHeader(Grid& grid) const {
    grid.setName(name());
    switch (header_.gridClass) {
    case 1:
      grid.setGridClass(openvdb::GRID_LEVEL_SET);
      break;
    case 2:
      grid.setGridClass(openvdb::GRID_FOG_VOLUME);
      break;
    case 3:
      grid.setGridClass(openvdb::GRID_STAGGERED);
      break;
    default:
      break;
    }
    // The matrix as the file has it; NanoVDB's converters before 12.0.1 lose rotations.
    const double* m = header_.matrix;
    bool diagonal = true;
    for (int i = 0; i < 9; ++i) {
      if (!std::isfinite(m[i]))
        fail("the transform is not finite");
      if (i % 4 != 0 && m[i] != 0)
        diagonal = false;
    }
    const double* t = header_.translation;
    if (diagonal && m[0] > 0 && m[4] > 0 && m[8] > 0) {
      grid.setTransform(makeTransform({{m[0], m[4], m[8]}, {t[0], t[1], t[2]}}));
    } else {
      // OpenVDB multiplies row vectors from the left, NanoVDB column vectors from the right.
      const openvdb::Mat4d matrix(m[0], m[3], m[6], 0., m[1], m[4], m[7], 0., m[2], m[5], m[8], 0.,
                                  t[0], t[1], t[2], 1.);
      grid.setTransform(openvdb::math::Transform::createLinearTransform(matrix));
    }
  }

  const unsigned char* bytes_;
  std::uint64_t size_;
  const NvdbFile& file_;
  const NvdbFile::Grid& grid_;
  std::function<void()> release_;
  NvdbGrid header_;
  std::uint64_t rootAt_ = 0;
  std::uint64_t first_ = 0; ///< where nodes may begin
  std::vector<Entry> entries_;
  std::uint64_t lowers_ = 0, lowersRead_ = 0;
  std::size_t used_ = 0; ///< bytes since the last release
  const NodeBytes nodeBytes_ = openvdbNodeBytes<TreeT>();

  std::size_t entry_ = 0;    ///< behind the one under way
  openvdb::Index child_ = 0; ///< of it, the next
  bool under_ = false;       ///< something of it is to come
};

/// Calls f(reader) with the reader of the grid's type, as NanoReader(). Throws Error(Invalid).
template <class F>
auto withNanoReader(const unsigned char* bytes, const NvdbFile& file, const NvdbFile::Grid& grid,
                    const std::function<void()>& release, const F& f) {
  NvdbGrid header;
  std::memcpy(&header, bytes, sizeof header);
  if ((header.magic != kNvdbMagic && header.magic != kNvdbGridMagic) ||
      header.gridSize != grid.size || header.version >> 21 != NANOVDB_MAJOR_VERSION_NUMBER)
    file.fail(grid, "is not a grid of NanoVDB " + std::to_string(NANOVDB_MAJOR_VERSION_NUMBER));
  const auto read = [&](auto build) {
    NanoReader<decltype(build)> reader(bytes, file, grid, release);
    return f(reader);
  };
  switch (header.gridType) {
  case 1:
    return read(float());
  case 2:
    return read(double());
  case 4:
    return read(std::int32_t());
  case 5:
    return read(std::int64_t());
  case 6:
    return read(nanovdb::Vec3f());
  case 8:
    return read(nanovdb::ValueMask());
  case 11:
    return read(bool());
  default:
    file.fail(grid, "a grid's type (" + std::to_string(header.gridType) + ") is not supported");
  }
}

} // namespace tetvdb
