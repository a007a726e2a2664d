// SPDX-License-Identifier: Apache-2.0
//
// Builds the levels from leaves to the root. Inside is represented in two ways: by the masks of
// nodes that faces or tets meet (entries), and between two entries of a column by the state at the
// top of the lower one. A gap whose columns of children agree is a run of tiles or empty; a gap
// whose columns differ is filled with nodes. The same holds on all three levels: 8x8 columns of
// voxels in a leaf, 16x16 of leaves in a lower node, 32x32 of lower nodes in an upper one.
#pragma once

#include "KeySpace.h"

#include <type_traits>

namespace tetvdb::nano {

enum : u8 { kEmpty = 0, kNode = 1, kFull = 2 };   ///< states of an entry
enum : u8 { kInsideBelow = 1, kInsideAbove = 2 }; ///< edges of an entry
constexpr u32 kMinusZero = 0x80000000u;           ///< bits of a float

/// Entries of one level in column order. Payload (masks) lies at `slot`.
struct Entries {
  u64 count = 0;
  u64* key = nullptr; ///< column keys, ascending
  u32* slot = nullptr;
  u8* state = nullptr;  ///< by slot
  i32* value = nullptr; ///< by slot: of a full entry; null where all values are the same
  u8* edge = nullptr;   ///< by position in column order
  u64 slots = 0;
  // The same entries in tree order.
  u64* treeKey = nullptr;
  u32* position = nullptr; ///< in column order
};

/// Child and tile bits of internal nodes, by slot: kColumns words of 2^kLog2 bits each, the column
/// (x, y) of children at x * 2^kLog2 + y. As bytes this is a NanoVDB mask.
template <int kLog2>
struct NodeMasks {
  static constexpr int kSide = 1 << kLog2;
  static constexpr int kColumns = kSide * kSide;
  static constexpr int kTopWords = kColumns / 64;
  static constexpr u64 kWords = u64(kColumns) * kSide / 64;
  u64* child = nullptr; ///< kWords a slot
  u64* tile = nullptr;
  u64* top = nullptr; ///< kTopWords a slot: which columns are inside at the node's top
  /// Children of slot s are begin[s] .. begin[s + 1] in tree order; of slots from `made` on (they
  /// fill gaps) there are none.
  u64* begin = nullptr;
  u64 made = 0;
};

/// Makes room for more slots and writes those that fill gaps.
template <int kLog2>
struct WriteNodeGap {
  u64 *child, *tile;
  TETVDB_HD void operator()(u64 slot, const u64* top) const {
    using Masks = NodeMasks<kLog2>;
    for (u64 w = 0; w < Masks::kWords; ++w)
      child[slot * Masks::kWords + w] = tile[slot * Masks::kWords + w] = 0;
    for (int c = 0; c < Masks::kColumns; ++c)
      if (top[c >> 6] >> (c & 63) & 1)
        tile[slot * Masks::kWords + static_cast<u64>(c * Masks::kSide / 64)] |=
            ((u64(1) << Masks::kSide) - 1) << (c * Masks::kSide % 64);
  }
};

template <typename Backend>
u64* grown(Backend& b, const u64* words, u64 count, u64 newCount) {
  u64* more = b.template alloc<u64>(newCount);
  b.forEach(
      count, TETVDB_KERNEL(u64 i) { more[i] = words[i]; });
  return more;
}

template <typename Backend, int kLog2>
struct GrowNodes {
  Backend& b;
  NodeMasks<kLog2>& masks;
  WriteNodeGap<kLog2> operator()(u64 slots) const {
    constexpr u64 words = NodeMasks<kLog2>::kWords;
    masks.child = grown(b, masks.child, masks.made * words, slots * words);
    masks.tile = grown(b, masks.tile, masks.made * words, slots * words);
    return {masks.child, masks.tile};
  }
};

template <int kLog2>
struct NodeShared {
  static constexpr int kThreads = 256, kOccupancy = 16;
  static constexpr int kColumns = NodeMasks<kLog2>::kColumns;
  u32 child[kColumns], tile[kColumns];
  u8 seen[kColumns], top[kColumns];
  i32 minValue, maxValue;
  u32 some, notFull;
};

/// Runs of keys that agree but for their lowest bits.
struct Groups {
  u64 items = 0, count = 0;
  const u32* head = nullptr; ///< by item: whether a group begins
  const u64* rank = nullptr; ///< by item: groups that begin before it
};

/// The groups of n keys, the lowest `shift` bits left out; temporaries.
template <typename Backend>
Groups groupsOf(Backend& b, const u64* keys, u64 n, int shift) {
  u32* head = b.template temp<u32>(n + 1);
  u64* rank = b.template temp<u64>(n + 1);
  b.forEach(
      n + 1, TETVDB_KERNEL(u64 i) {
        head[i] = i < n && (i == 0 || keys[i] >> shift != keys[i - 1] >> shift);
      });
  b.scan(head, rank, n);
  return {n, b.read(rank + n), head, rank};
}

/// Writes where the groups begin and, last, how many items there are; each(group, first item).
template <typename Backend, typename Each>
void forGroups(Backend& b, const Groups& groups, u64* begin, const Each& each) {
  b.forEach(
      groups.items + 1, TETVDB_KERNEL(u64 i) {
        if (i == groups.items) {
          begin[groups.count] = i;
        } else if (groups.head[i]) {
          const u64 group = groups.rank[i];
          begin[group] = i;
          each(group, i);
        }
      });
}

/// Nodes are numbered in 32 bits.
inline void checkCount(u64 count) {
  if (count >= 0xFFFFFFFFu)
    throw Error(Status::Limit, "", "the grid has 2^32 leaves or more", "use larger voxels");
}

/// The nodes above leaves.
struct InternalNodes {
  Entries lowers, uppers;
  NodeMasks<4> lowerMasks;
  NodeMasks<5> upperMasks;
};

/// Error bits that kernels raise.
enum : u32 { kBadPoint = 1, kLongTet = 2, kNotClosed = 4, kBadIndex = 8 };

template <typename Backend>
class LevelBuilder {
public:
  /// `areFloats`: values of entries are the bits of floats, of which 0 and -0 are the same.
  /// `classes`: where not null, values are places in it, those with equal numbers the same.
  LevelBuilder(Backend& backend, const KeySpace& space, bool carries, bool areFloats, u32* errors,
               const u32* classes = nullptr)
      : b_(backend), space_(space), carries_(carries), areFloats_(areFloats), errors_(errors),
        classes_(classes) {}

  /// Inserts the nodes that fill gaps whose columns differ, sets edges and tree order. `top`:
  /// kTopWords words a slot. grow(slots) makes room for the payload of that many slots in all and
  /// returns a functor write(slot, topOfNodeBelow) that fills one.
  template <int kTopWords, typename Grow>
  void closeGaps(int level, Entries& e, const u64* top, const Grow& grow) {
    if (carries_)
      fillGaps<kTopWords>(level, e, top, grow);
    else
      e.edge = zeroed(e.count);
    if (e.treeKey == nullptr)
      toTreeOrder(level, e);
    b_.dropTemporaries();
  }

  /// The nodes above leaves whose gaps are closed.
  InternalNodes nodesAbove(const Entries& leaves) {
    InternalNodes n;
    checkCount(leaves.count);
    n.lowers = parents<4>(0, leaves, n.lowerMasks);
    closeGaps<4>(1, n.lowers, n.lowerMasks.top, GrowNodes<Backend, 4>{b_, n.lowerMasks});
    checkCount(n.lowers.count);
    n.uppers = parents<5>(1, n.lowers, n.upperMasks);
    closeGaps<16>(2, n.uppers, n.upperMasks.top, GrowNodes<Backend, 5>{b_, n.upperMasks});
    return n;
  }

  /// The nodes of the next level: the parents of the children.
  template <int kLog2>
  Entries parents(int childLevel, const Entries& children, NodeMasks<kLog2>& masks) {
    const int level = childLevel + 1;
    const u64* keys = children.treeKey;
    const Groups groups = groupsOf(b_, keys, children.count, 3 * kLog2);
    const u64 m = groups.count;
    Entries e;
    e.count = e.slots = m;
    u64* begin = b_.template alloc<u64>(m + 1);
    u64* nodeTreeKey = b_.template alloc<u64>(m);
    e.key = b_.template alloc<u64>(m);
    e.slot = b_.template alloc<u32>(m);
    const KeySpace space = space_;
    u64* columnKeys = e.key;
    u32* slots = e.slot;
    forGroups(
        b_, groups, begin, TETVDB_KERNEL(u64 r, u64 i) {
          const u64 key = keys[i] >> (3 * kLog2);
          nodeTreeKey[r] = key;
          columnKeys[r] = columnKey(space, level, placeOfTreeKey(space, level, key));
          slots[r] = static_cast<u32>(r);
        });
    e.state = b_.template alloc<u8>(m);
    e.value = children.value == nullptr ? nullptr : b_.template alloc<i32>(m);
    masks.child = b_.template alloc<u64>(m * masks.kWords);
    masks.tile = b_.template alloc<u64>(m * masks.kWords);
    masks.top = b_.template alloc<u64>(m * masks.kTopWords);
    masks.begin = begin;
    masks.made = m;
    markChildren<kLog2>(childLevel, children, begin, nodeTreeKey, e, masks);
    if (!carries_) { // no gaps will be filled, so this is their order
      e.treeKey = nodeTreeKey;
      e.position = e.slot;
    } else if (level < 2) {
      b_.sort(e.key, e.slot, m, space_.total() - 3 * levelShift(level));
    }
    b_.dropTemporaries();
    return e;
  }

  // The rest would be private, but nvcc allows device lambdas only in public functions.

  u8* zeroed(u64 n) {
    u8* p = b_.template alloc<u8>(n);
    b_.zero(p, n);
    return p;
  }

  void toTreeOrder(int level, Entries& e) {
    const KeySpace space = space_;
    e.treeKey = b_.template alloc<u64>(e.count);
    e.position = b_.template alloc<u32>(e.count);
    u64* treeKeys = e.treeKey;
    u32* positions = e.position;
    const u64* keys = e.key;
    b_.forEach(
        e.count, TETVDB_KERNEL(u64 i) {
          treeKeys[i] = treeKey(space, level, placeOfColumnKey(space, level, keys[i]));
          positions[i] = static_cast<u32>(i);
        });
    if (level < 2)
      b_.sort(e.treeKey, e.position, e.count, space_.total() - 3 * levelShift(level));
  }

  template <int kTopWords>
  TETVDB_HD static int uniformTop(const u64* top) { // 0 outside, 1 inside, 2 they differ
    bool all = true, none = true;
    for (int w = 0; w < kTopWords; ++w) {
      all = all && top[w] == ~u64(0);
      none = none && top[w] == 0;
    }
    return none ? 0 : all ? 1 : 2;
  }

  template <int kTopWords, typename Grow>
  void fillGaps(int level, Entries& e, const u64* top, const Grow& grow) {
    const u64 n = e.count;
    const int height = heightBits(space_, level);
    u32* gap = b_.template temp<u32>(n + 1);
    u64* before = b_.template temp<u64>(n + 1);
    const u64* keys = e.key;
    const u32* slots = e.slot;
    u32* errors = errors_;
    // At the root tiles are entries as well.
    const bool tilesToo = level == 2;
    b_.forEach(
        n + 1, TETVDB_KERNEL(u64 i) {
          gap[i] = 0;
          if (i == n)
            return;
          const int above = uniformTop<kTopWords>(top + u64(slots[i]) * kTopWords);
          if (above == 0)
            return;
          if (i + 1 == n || keys[i + 1] >> height != keys[i] >> height)
            orInto(errors, u32(kNotClosed));
          else if (above == 2 || tilesToo)
            gap[i] = static_cast<u32>(keys[i + 1] - keys[i] - 1);
        });
    b_.scan(gap, before, n);
    const u64 added = b_.read(before + n);
    if (added > 0) {
      const u64 m = n + added, firstNew = e.slots;
      u64* newKeys = b_.template alloc<u64>(m);
      u32* newSlots = b_.template alloc<u32>(m);
      u8* states = b_.template alloc<u8>(firstNew + added);
      i32* values = e.value == nullptr ? nullptr : b_.template alloc<i32>(firstNew + added);
      const u8* oldStates = e.state;
      const i32* oldValues = e.value;
      b_.forEach(
          firstNew, TETVDB_KERNEL(u64 s) {
            states[s] = oldStates[s];
            if (values != nullptr)
              values[s] = oldValues[s];
          });
      b_.forEach(
          n, TETVDB_KERNEL(u64 i) {
            newKeys[i + before[i]] = keys[i];
            newSlots[i + before[i]] = slots[i];
          });
      const auto write = grow(firstNew + added);
      b_.forEach(
          added, TETVDB_KERNEL(u64 j) {
            const u64 i = ownerOf(before, n, j);
            const u64 slot = firstNew + j;
            const u64 at = i + 1 + j; // entries up to i and gaps before this one
            newKeys[at] = keys[i] + 1 + (j - before[i]);
            newSlots[at] = static_cast<u32>(slot);
            const u64* below = top + u64(slots[i]) * kTopWords;
            states[slot] = uniformTop<kTopWords>(below) == 1 ? kFull : kNode;
            if (values != nullptr)
              values[slot] = 0;
            write(slot, below);
          });
      e.count = m;
      e.slots = firstNew + added;
      e.key = newKeys;
      e.slot = newSlots;
      e.state = states;
      e.value = values;
    }
    e.edge = b_.template alloc<u8>(e.count);
    u8* edges = e.edge;
    const u64* allKeys = e.key;
    const u32* allSlots = e.slot;
    // There is no gap above an entry that was added.
    const u64 oldSlots = e.slots - added;
    b_.forEach(
        e.count, TETVDB_KERNEL(u64 i) {
          const auto insideAbove = [&](u64 k) {
            return allSlots[k] < oldSlots &&
                   uniformTop<kTopWords>(top + u64(allSlots[k]) * kTopWords) == 1;
          };
          u8 edge = insideAbove(i) ? kInsideAbove : 0;
          if (i > 0 && allKeys[i - 1] >> height == allKeys[i] >> height && insideAbove(i - 1))
            edge |= kInsideBelow;
          edges[i] = edge;
        });
  }

  template <int kLog2>
  void markChildren(int childLevel, const Entries& children, const u64* begin, const u64* nodeKeys,
                    Entries& e, const NodeMasks<kLog2>& masks) {
    constexpr int kSide = 1 << kLog2;
    constexpr int kColumns = kSide * kSide;
    constexpr u32 kWhole = kSide == 32 ? ~u32(0) : (u32(1) << kSide) - 1;
    using Column = std::conditional_t<kLog2 == 4, u16, u32>;
    const KeySpace space = space_;
    const bool carries = carries_, areFloats = areFloats_;
    const u32* classes = classes_;
    const int height = heightBits(space_, childLevel);
    const u64 n = children.count;
    const u64 *treeKeys = children.treeKey, *columnKeys = children.key;
    const u32 *positions = children.position, *slots = children.slot;
    const u8 *states = children.state, *edges = children.edge;
    const i32* values = children.value;
    u8* nodeStates = e.state;
    i32* nodeValues = e.value;
    auto* childOut = reinterpret_cast<Column*>(masks.child);
    auto* tileOut = reinterpret_cast<Column*>(masks.tile);
    u64* topOut = masks.top;
    using Shared = NodeShared<kLog2>;
    b_.template forTeams<Shared>(
        e.count, kLog2 == 4 ? 64 : 256, TETVDB_KERNEL(const Team& team, u64 node, Shared& s) {
          for (int c = team.rank(); c < kColumns; c += team.size()) {
            s.child[c] = s.tile[c] = 0;
            s.seen[c] = s.top[c] = 0;
          }
          if (team.rank() == 0) {
            s.minValue = 0x7FFFFFFF;
            s.maxValue = -0x7FFFFFFF - 1;
            s.some = s.notFull = 0;
          }
          team.sync();
          const u64 first = begin[node], end = begin[node + 1];
          for (u64 j = first + static_cast<u64>(team.rank()); j < end;
               j += static_cast<u64>(team.size())) {
            const u64 key = treeKeys[j];
            const u32 column = static_cast<u32>(key >> kLog2) & (kColumns - 1);
            const u32 z = static_cast<u32>(key) & (kSide - 1);
            const u32 position = positions[j];
            const u32 slot = slots[position];
            const u8 state = states[slot], edge = edges[position];
            if (state == kNode) {
              orInto(&s.child[column], u32(1) << z);
            } else if (state == kFull) {
              orInto(&s.tile[column], u32(1) << z);
              if (values != nullptr) {
                const u32 bits = static_cast<u32>(values[slot]);
                const i32 value = classes != nullptr ? static_cast<i32>(classes[bits])
                                  : areFloats && bits == kMinusZero ? 0
                                                                    : values[slot];
                minInto(&s.minValue, value);
                maxInto(&s.maxValue, value);
              }
            }
            if (j == first || treeKeys[j - 1] >> kLog2 != key >> kLog2) {
              s.seen[column] = 1;
              if (edge & kInsideBelow)
                orInto(&s.tile[column], (u32(1) << z) - 1);
            }
            const bool last = j + 1 == end || treeKeys[j + 1] >> kLog2 != key >> kLog2;
            if (edge & kInsideAbove) {
              const u32 next = last ? kSide : static_cast<u32>(treeKeys[j + 1]) & (kSide - 1);
              const u32 upTo = next == 32 ? ~u32(0) : (u32(1) << next) - 1;
              orInto(&s.tile[column], upTo & ~((u32(2) << z) - 1));
              if (last)
                s.top[column] = 1;
            }
          }
          team.sync();
          const Place place = placeOfTreeKey(space, childLevel + 1, nodeKeys[node]);
          for (int c = team.rank(); c < kColumns; c += team.size()) {
            if (carries && s.seen[c] == 0) {
              // The column has the state at the top of the nearest entry below.
              const u64 x = place.x << kLog2 | static_cast<u64>(c >> kLog2);
              const u64 y = place.y << kLog2 | static_cast<u64>(c & (kSide - 1));
              const u64 key = columnKey(space, childLevel, {x, y, place.z << kLog2});
              u64 low = 0, high = n; // the first entry at or above is in low..high
              while (low < high) {
                const u64 mid = low + (high - low) / 2;
                if (columnKeys[mid] < key)
                  low = mid + 1;
                else
                  high = mid;
              }
              if (low > 0 && columnKeys[low - 1] >> height == key >> height &&
                  (edges[low - 1] & kInsideAbove) != 0) {
                s.tile[c] = kWhole;
                s.top[c] = 1;
              }
            }
            const u32 child = s.child[c], tile = s.tile[c];
            childOut[node * kColumns + static_cast<u64>(c)] = static_cast<Column>(child);
            tileOut[node * kColumns + static_cast<u64>(c)] = static_cast<Column>(tile);
            if ((child | tile) != 0)
              orInto(&s.some, 1u);
            if (child != 0 || tile != kWhole)
              orInto(&s.notFull, 1u);
          }
          team.sync();
          for (int w = team.rank(); w < kColumns / 64; w += team.size()) {
            u64 word = 0;
            for (int i = 0; i < 64; ++i)
              word |= u64(s.top[w * 64 + i]) << i;
            topOut[node * (kColumns / 64) + static_cast<u64>(w)] = word;
          }
          if (team.rank() == 0) {
            const bool oneValue = values == nullptr || s.minValue == s.maxValue;
            nodeStates[node] = s.some == 0 ? kEmpty : s.notFull == 0 && oneValue ? kFull : kNode;
            if (nodeValues != nullptr)
              nodeValues[node] = values[slots[positions[first]]];
          }
          team.sync();
        });
  }

private:
  Backend& b_;
  KeySpace space_;
  bool carries_, areFloats_;
  u32* errors_;
  const u32* classes_;
};

} // namespace tetvdb::nano
