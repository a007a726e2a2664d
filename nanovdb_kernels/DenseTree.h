// SPDX-License-Identifier: Apache-2.0
//
// Builds nodes from a dense array of leaf masks. They are numbered in three steps and without a
// sort, since their possible places are known beforehand.
#pragma once

#include "BuildLevels.h"
#include "DenseTets.h"
#include "GridParts.h"

namespace tetvdb::nano {

/// A box of at most 16 lower nodes along an axis meets at most two upper nodes along each.
constexpr int kMaxDenseUppers = 8;

/// The lower nodes of a DenseBox in tree order: upper node by upper node.
struct DenseOrder {
  u64 first[3], length[3][2]; ///< lower nodes of the box in the first and the second upper node

  explicit DenseOrder(const DenseBox& box) {
    for (int k = 0; k < 3; ++k) {
      first[k] = box.first[k];
      const u64 room = 32 - box.first[k] % 32;
      length[k][0] = box.size[k] < room ? box.size[k] : room;
      length[k][1] = box.size[k] - length[k][0];
    }
  }
  TETVDB_HD u64 nodesOf(int upper) const {
    return length[0][upper >> 2] * length[1][upper >> 1 & 1] * length[2][upper & 1];
  }
  TETVDB_HD Place upperAt(int upper) const {
    return {(first[0] >> 5) + static_cast<u64>(upper >> 2),
            (first[1] >> 5) + static_cast<u64>(upper >> 1 & 1),
            (first[2] >> 5) + static_cast<u64>(upper & 1)};
  }
  /// The `number`-th node, and the upper node (x, y, z a bit each) that it is in.
  TETVDB_HD Place at(u64 number, int& upper) const {
    upper = 0;
    while (number >= nodesOf(upper))
      number -= nodesOf(upper++);
    const int bit[3] = {upper >> 2, upper >> 1 & 1, upper & 1};
    const u64 y = length[1][bit[1]], z = length[2][bit[2]];
    const u64 local[3] = {number / z / y, number / z % y, number % z};
    const auto place = [&](int k) {
      return first[k] + (bit[k] != 0 ? length[k][0] : 0) + local[k];
    };
    return {place(0), place(1), place(2)};
  }
};

struct ClassifyShared {
  static constexpr int kThreads = 1024, kOccupancy = 32;
  u32 child[128], tile[128];
  u32 leaves, full;
};

struct NumberShared {
  static constexpr int kThreads = 256, kOccupancy = 8;
  u32 leaves[256], nodes[256], spare[256];
  u32 child[kMaxDenseUppers], tile[kMaxDenseUppers], firstOf[kMaxDenseUppers];
};

/// The counts, to be read by the host.
struct DenseCounts {
  u64 leaves, lowers, uppers;
  u64 tallies[2]; ///< the sums of those given
  u32 errors, unused;
};

/// The tree's nodes above leaves, device arrays in tree order.
struct DenseNodes {
  u64 max = 0;        ///< lower nodes there may be
  NodeMasks<4> lower; ///< by place in tree order
  NodeMasks<5> upper; ///< by upper node of the box that is not empty
  u64* leafFirst;     ///< by place: mixed leaves before it
  LevelNodes leaf, lowers, uppers;
  RootEntry* roots;
  DenseCounts* counts;
};

template <typename Backend>
class DenseTree {
public:
  /// `share`: root columns that are wanted.
  DenseTree(Backend& backend, const KeySpace& space, const DenseBox& box, const RootShare& share)
      : b_(backend), space_(space), box_(box), order_(box), share_(share) {}

  /// Finds and numbers the lower and upper nodes. `tallies`: two times kTallies numbers.
  DenseNodes number(const u64* tallies, const u32* errors) {
    DenseNodes n;
    n.max = box_.nodes();
    classify(n);
    numberNodes(n, tallies, errors);
    return n;
  }

  /// Lists the mixed leaves, once their number is known.
  void list(DenseNodes& n, u64 leaves) {
    n.leaf.nodeSlot = b_.template alloc<u32>(leaves);
    n.leaf.key = b_.template alloc<u64>(leaves);
    n.leaf.voxels = b_.template alloc<u64>(leaves);
    u32* slots = const_cast<u32*>(n.leaf.nodeSlot);
    u64* keys = const_cast<u64*>(n.leaf.key);
    const u64 *child = n.lower.child, *leafFirst = n.leafFirst;
    const DenseBox box = box_;
    const DenseOrder order = order_;
    const KeySpace space = space_;
    b_.template forTeams<ListShared>(
        n.max, 256, TETVDB_KERNEL(const Team& team, u64 number, ListShared& s) {
          if (leafFirst[number] == leafFirst[number + 1])
            return;
          for (int w = team.rank(); w < 64; w += team.size())
            s.before[w] = static_cast<u32>(bitCount(child[number * 64 + static_cast<u64>(w)]));
          team.sync();
          sumsBefore(team, s.before, s.spare, 64);
          int upper;
          const Place place = order.at(number, upper);
          const u64 key = treeKey(space, 1, place) << 12, node = nodeInBox(box, place) << 12;
          for (u32 leaf = static_cast<u32>(team.rank()); leaf < 4096;
               leaf += static_cast<u32>(team.size())) {
            const u64 word = child[number * 64 + (leaf >> 6)], bit = u64(1) << (leaf & 63);
            if ((word & bit) == 0)
              continue;
            const u64 at = leafFirst[number] + s.before[leaf >> 6] +
                           static_cast<u64>(bitCount(word & (bit - 1)));
            slots[at] = static_cast<u32>(node | leaf);
            keys[at] = key | leaf;
          }
          team.sync();
        });
  }

  // Public only because of nvcc, as in LevelBuilder.

  struct ListShared {
    static constexpr int kThreads = 256, kOccupancy = 32;
    u32 before[64], spare[64];
  };

  TETVDB_HD static u64 nodeInBox(const DenseBox& box, const Place& p) {
    return ((p.x - box.first[0]) * box.size[1] + (p.y - box.first[1])) * box.size[2] +
           (p.z - box.first[2]);
  }

  // Which leaves of a node are mixed, which full.
  void classify(DenseNodes& n) {
    n.lower.child = b_.template alloc<u64>(n.max * 64);
    n.lower.tile = b_.template alloc<u64>(n.max * 64);
    leafCount_ = b_.template temp<u32>(n.max);
    state_ = b_.template temp<u8>(n.max);
    u32* leafCount = leafCount_;
    u8* state = state_;
    auto *child = reinterpret_cast<u32*>(n.lower.child),
         *tile = reinterpret_cast<u32*>(n.lower.tile);
    const DenseBox box = box_;
    const DenseOrder order = order_;
    const KeySpace space = space_;
    const RootShare share = share_;
    b_.template forTeams<ClassifyShared>(
        n.max, ClassifyShared::kThreads,
        TETVDB_KERNEL(const Team& team, u64 number, ClassifyShared& s) {
          for (int w = team.rank(); w < 128; w += team.size())
            s.child[w] = s.tile[w] = 0;
          if (team.rank() == 0)
            s.leaves = s.full = 0;
          team.sync();
          int upper;
          const Place place = order.at(number, upper);
          if (share.has(space, 1, place)) {
            const u64* masks = box.mask + (nodeInBox(box, place) << 15);
            for (int leaf = team.rank(); leaf < 4096; leaf += team.size()) {
              u64 any = 0, all = ~u64(0);
              for (int w = 0; w < 8; ++w) {
                const u64 word = masks[8 * leaf + w];
                any |= word;
                all &= word;
              }
              if (all == ~u64(0))
                orInto(&s.tile[leaf >> 5], 1u << (leaf & 31));
              else if (any != 0)
                orInto(&s.child[leaf >> 5], 1u << (leaf & 31));
            }
          }
          team.sync();
          u32 leaves = 0, full = 0;
          for (int w = team.rank(); w < 128; w += team.size()) {
            child[number * 128 + static_cast<u64>(w)] = s.child[w];
            tile[number * 128 + static_cast<u64>(w)] = s.tile[w];
            leaves += static_cast<u32>(bitCount(s.child[w]));
            full += static_cast<u32>(bitCount(s.tile[w]));
          }
          if ((leaves | full) != 0) {
            addTo(&s.leaves, leaves);
            addTo(&s.full, full);
          }
          team.sync();
          if (team.rank() == 0) {
            leafCount[number] = s.leaves;
            state[number] = s.full == 4096 ? kFull : (s.leaves | s.full) != 0 ? kNode : kEmpty;
          }
          team.sync();
        });
  }

  // Numbers the lower nodes and their leaves, makes the upper nodes' masks and root entries.
  void numberNodes(DenseNodes& n, const u64* tallies, const u32* errors) {
    const u64 max = n.max;
    n.leafFirst = b_.template alloc<u64>(max + 1);
    u32* nodeSlot = b_.template alloc<u32>(max);
    u64* nodeKey = b_.template alloc<u64>(max);
    n.lowers = {nullptr, nodeSlot, nodeKey, b_.template alloc<u64>(max), nullptr};
    constexpr u64 kWords = NodeMasks<5>::kWords;
    n.upper.child = b_.template alloc<u64>(2 * kMaxDenseUppers * kWords);
    n.upper.tile = n.upper.child + kMaxDenseUppers * kWords;
    b_.zero(n.upper.child, 2 * kMaxDenseUppers * kWords * sizeof(u64));
    n.upper.begin = b_.template alloc<u64>(kMaxDenseUppers + 1);
    u64* upperKeys = b_.template alloc<u64>(2 * kMaxDenseUppers);
    u32* slots = b_.template alloc<u32>(kMaxDenseUppers);
    n.roots = b_.template alloc<RootEntry>(kMaxDenseUppers);
    n.lower.begin = n.leafFirst;
    n.lower.made = max;
    n.upper.made = kMaxDenseUppers;
    n.uppers = {nullptr, slots, upperKeys, upperKeys + kMaxDenseUppers, nullptr};
    RootEntry* roots = n.roots;
    n.counts = b_.template alloc<DenseCounts>(1);
    u64 *leafFirst = n.leafFirst, *upperBegin = n.upper.begin;
    DenseCounts* counts = n.counts;
    const u32* leafCount = leafCount_;
    const u8* state = state_;
    auto *upperChild = reinterpret_cast<u32*>(n.upper.child),
         *upperTile = reinterpret_cast<u32*>(n.upper.tile);
    const KeySpace space = space_;
    const DenseOrder order = order_;
    b_.template forTeams<NumberShared>(
        1, 256, TETVDB_KERNEL(const Team& team, u64, NumberShared& s) {
          constexpr int kPieces = 256;
          const u64 chunk = (max + kPieces - 1) / kPieces;
          for (int u = team.rank(); u < kMaxDenseUppers; u += team.size())
            s.child[u] = s.tile[u] = 0;
          team.sync();
          for (int p = team.rank(); p < kPieces; p += team.size()) {
            s.leaves[p] = s.nodes[p] = 0;
            for (u64 i = static_cast<u64>(p) * chunk;
                 i < max && i < static_cast<u64>(p + 1) * chunk; ++i) {
              s.leaves[p] += leafCount[i];
              s.nodes[p] += state[i] == kNode;
              if (state[i] == kEmpty)
                continue;
              int upper;
              order.at(i, upper);
              addTo(state[i] == kNode ? &s.child[upper] : &s.tile[upper], 1u);
            }
          }
          team.sync();
          const u32 leaves = sumsBefore(team, s.leaves, s.spare, kPieces);
          const u32 nodes = sumsBefore(team, s.nodes, s.spare, kPieces);
          if (team.rank() == 0) {
            u32 uppers = 0, before = 0;
            for (int u = 0; u < kMaxDenseUppers; ++u) {
              s.firstOf[u] = uppers;
              if ((s.child[u] | s.tile[u]) == 0)
                continue;
              upperBegin[uppers] = before;
              slots[uppers] = uppers;
              upperKeys[uppers] = treeKey(space, 2, order.upperAt(u));
              roots[uppers] = {upperKeys[uppers], uppers, uppers, 0, kNode};
              before += s.child[u];
              ++uppers;
            }
            upperBegin[uppers] = before;
            leafFirst[max] = leaves;
            counts->leaves = leaves;
            counts->lowers = nodes;
            counts->uppers = uppers;
            counts->errors = *errors;
            counts->unused = 0;
          }
          for (int which = team.rank(); which < 2; which += team.size()) {
            u64 sum = 0;
            for (u64 i = 0; i < kTallies; ++i)
              sum += tallies[static_cast<u64>(which) * kTallies + i];
            counts->tallies[which] = sum;
          }
          team.sync();
          for (int p = team.rank(); p < kPieces; p += team.size()) {
            u64 leaf = s.leaves[p], node = s.nodes[p];
            for (u64 i = static_cast<u64>(p) * chunk;
                 i < max && i < static_cast<u64>(p + 1) * chunk; ++i) {
              leafFirst[i] = leaf;
              leaf += leafCount[i];
              if (state[i] == kEmpty)
                continue;
              int upper;
              const Place place = order.at(i, upper);
              const u64 at = s.firstOf[upper], child = tableIndex(place, 5);
              orInto((state[i] == kNode ? upperChild : upperTile) + at * 1024 + (child >> 5),
                     1u << (child & 31));
              if (state[i] != kNode)
                continue;
              nodeSlot[node] = static_cast<u32>(i);
              nodeKey[node] = treeKey(space, 1, place);
              ++node;
            }
          }
          team.sync();
        });
  }

private:
  Backend& b_;
  KeySpace space_;
  DenseBox box_;
  DenseOrder order_;
  RootShare share_;
  u32* leafCount_ = nullptr;
  u8* state_ = nullptr;
};

} // namespace tetvdb::nano
