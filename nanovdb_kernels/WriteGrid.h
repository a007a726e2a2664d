// SPDX-License-Identifier: Apache-2.0
//
// Writes the NanoVDB buffer: grid, tree, root, upper nodes, lower nodes, leaves, breadth first,
// each level in tree order, so that a child's place follows from the bits before it.
#pragma once

#include "Crc32.h"
#include "GridParts.h"
#include "RasterizeTets.h"

#include <cstring>
#include <type_traits>

namespace tetvdb::nano {

template <typename Backend>
class GridWriter {
public:
  GridWriter(Backend& backend, const KeySpace& space, Kind kind, const GridValues& values)
      : b_(backend), space_(space), kind_(kind), values_(values) {}

  /// Numbers the nodes of all levels.
  NodeCounts number(const Entries& leaves, const Entries& lowers, const Entries& uppers) {
    numberLevel(leaves, leaf_, kNode);
    numberLevel(lowers, lower_, kNode);
    numberLevel(uppers, upper_, kNode);
    listRoots(uppers);
    const u64 *leafCount = leaf_.index + leaves.count, *lowerCount = lower_.index + lowers.count,
              *upperCount = upper_.index + uppers.count, *tileCount = tileRank_ + uppers.count;
    NodeCounts* counts = b_.template temp<NodeCounts>(1);
    b_.forEach(
        1, TETVDB_KERNEL(u64) {
          counts->rootTiles = *tileCount;
          counts->uppers = *upperCount;
          counts->lowers = *lowerCount;
          counts->leaves = *leafCount;
        });
    const NodeCounts n = b_.read(counts);
    takeSlots(leaves, leaf_, n.leaves);
    takeSlots(lowers, lower_, n.lowers);
    takeSlots(uppers, upper_, n.uppers);
    b_.dropTemporaries();
    return n;
  }

  /// Takes nodes that are numbered already.
  void take(const LevelNodes& leaf, const LevelNodes& lower, const LevelNodes& upper,
            const RootEntry* roots, u64 rootCount) {
    leaf_ = leaf;
    lower_ = lower;
    upper_ = upper;
    roots_ = roots;
    rootCount_ = rootCount;
  }

  /// Whether leaves have values of their own, whose sums their parents have.
  bool valuesDiffer() const { return values_.varied || values_.narrowBand || values_.variedLeaves; }

  /// Writes the nodes. `buffer`: the share's memory, of l.sizeHere bytes.
  void writeTree(u8* buffer, const BufferLayout& l, const Entries& leaves,
                 const LeafMasks& leafMasks, const u32* table, const LeafSummary* summaries,
                 const InternalNodes& nodes) {
    if (kind_ == Kind::Mask)
      writeFlatLeaves<sizeof(MaskLeaf) / 8>(buffer, l, leafMasks.mask);
    else if (kind_ == Kind::Boolean)
      writeFlatLeaves<sizeof(BoolLeaf) / 8>(buffer, l, leafMasks.mask);
    else if (kind_ == Kind::Vec3f)
      writeValueLeaves<Vector>(buffer, l, leafMasks.mask, table, summaries);
    else
      writeValueLeaves<u32>(buffer, l, leafMasks.mask, table, summaries);
    writeInternal(buffer, l, leaves, nodes);
  }

  /// Writes the nodes above leaves, which `buffer` has. `leaves` and `nodes.lowers` are needed
  /// where values vary alone.
  void writeInternal(u8* buffer, const BufferLayout& l, const Entries& leaves,
                     const InternalNodes& nodes) {
    totals_ = b_.template alloc<u64>(4);
    b_.zero(totals_, 4 * sizeof(u64));
    if (kind_ == Kind::Vec3f) {
      writeNodes<4, Vector>(buffer, l, nodes.lowerMasks, leaves, lower_, leaf_);
      writeNodes<5, Vector>(buffer, l, nodes.upperMasks, nodes.lowers, upper_, lower_);
    } else {
      writeNodes<4, u32>(buffer, l, nodes.lowerMasks, leaves, lower_, leaf_);
      writeNodes<5, u32>(buffer, l, nodes.upperMasks, nodes.lowers, upper_, lower_);
    }
  }

  /// Writes the head of the grid, which precedes the nodes. `buffer`: the whole grid's; upper nodes
  /// are read there.
  void writeHead(u8* buffer, const BufferLayout& l, const nanovdb::GridData& header,
                 const RootParts& parts) {
    if (kind_ == Kind::Vec3f)
      writeHeadOf<Vector>(buffer, l, header, parts);
    else
      writeHeadOf<u32>(buffer, l, header, parts);
  }

  /// The input of writeHead(), in the backend's memory.
  RootParts roots() const { return {roots_, rootCount_, upper_.voxels, upper_.moments, totals_}; }

  // Public only because of nvcc, as in LevelBuilder.

  void listRoots(const Entries& uppers) {
    const u64 n = uppers.count;
    u32* some = b_.template temp<u32>(n + 1);
    u64* rank = b_.template alloc<u64>(n + 1);
    RootEntry* roots = b_.template alloc<RootEntry>(n);
    const u32 *positions = uppers.position, *slots = uppers.slot;
    const u8* states = uppers.state;
    const u64 *keys = uppers.treeKey, *index = upper_.index;
    const i32* values = uppers.value;
    b_.forEach(
        n + 1, TETVDB_KERNEL(u64 j) { some[j] = j < n && states[slots[positions[j]]] != kEmpty; });
    b_.scan(some, rank, n);
    b_.forEach(
        n, TETVDB_KERNEL(u64 j) {
          const u32 slot = slots[positions[j]];
          roots[j] = {keys[j], index[j], rank[j], values == nullptr ? 0 : values[slot],
                      states[slot]};
        });
    tileRank_ = rank;
    roots_ = roots;
    rootCount_ = n;
  }

  void numberLevel(const Entries& e, LevelNodes& nodes, u8 which) {
    u32* some = b_.template temp<u32>(e.count + 1);
    u64* index = b_.template alloc<u64>(e.count + 1);
    const u32 *positions = e.position, *slots = e.slot;
    const u8* states = e.state;
    const u64 n = e.count;
    b_.forEach(
        n + 1, TETVDB_KERNEL(u64 j) { some[j] = j < n && states[slots[positions[j]]] == which; });
    b_.scan(some, index, n);
    nodes.index = index;
  }

  void takeSlots(const Entries& e, LevelNodes& nodes, u64 count) {
    u32* nodeSlot = b_.template alloc<u32>(count);
    nodes.nodeSlot = nodeSlot;
    nodes.voxels = b_.template alloc<u64>(count);
    nodes.moments = valuesDiffer() ? b_.template alloc<Moments>(count) : nullptr;
    const u64* index = nodes.index;
    const u32 *positions = e.position, *slots = e.slot;
    const u8* states = e.state;
    u64* placeKey = b_.template alloc<u64>(count);
    nodes.key = placeKey;
    const u64* treeKeys = e.treeKey;
    b_.forEach(
        e.count, TETVDB_KERNEL(u64 j) {
          const u32 slot = slots[positions[j]];
          if (states[slot] != kNode)
            return;
          nodeSlot[index[j]] = slot;
          placeKey[index[j]] = treeKeys[j];
        });
  }

  TETVDB_HD static u64 headWord(const KeySpace& space, u64 key, const u64* mask, u32 w) {
    i32 origin[3];
    originOf(space, 0, placeOfTreeKey(space, 0, key), origin);
    alignas(MaskLeaf) u8 leaf[sizeof(MaskLeaf)];
    leafBox(mask, origin, reinterpret_cast<MaskLeaf&>(leaf));
    u64 word[2];
    memcpy(word, leaf, sizeof word);
    return word[w];
  }

  // Leaves of a mask or bool grid: a thread a word of eight bytes, so that writes are together.
  template <u32 kWords>
  void writeFlatLeaves(u8* buffer, const BufferLayout& l, const u64* masks) {
    const KeySpace space = space_;
    const u32* nodeSlot = leaf_.nodeSlot;
    const u64* keys = leaf_.key;
    u64* voxels = leaf_.voxels;
    u64* out = reinterpret_cast<u64*>(buffer + l.leafHere);
    b_.forEach(
        l.leaves * kWords, TETVDB_KERNEL(u64 i) {
          const u64 leaf = i / kWords;
          const u32 w = static_cast<u32>(i - leaf * kWords);
          const u64* mask = masks + 8 * u64(nodeSlot[leaf]);
          u64 word = 0;
          if (w < 2)
            word = headWord(space, keys[leaf], mask, w);
          else if (w < 10)
            word = mask[w - 2];
          else if (kWords == sizeof(BoolLeaf) / 8 && w < 18)
            word = mask[w - 10];
          out[i] = word;
          if (w == 0)
            voxels[leaf] = countVoxels(mask);
        });
  }

  // Leaves of values: a warp a leaf. Without a table, all active values are the same.
  template <typename V>
  void writeValueLeaves(u8* buffer, const BufferLayout& l, const u64* masks, const u32* table,
                        const LeafSummary* summaries) {
    using Leaf = typename NodesOf<V>::Leaf;
    const KeySpace space = space_;
    const GridValues values = values_;
    const bool isFloat = kind_ == Kind::Float;
    const u32* nodeSlot = leaf_.nodeSlot;
    const u64* keys = leaf_.key;
    u64* voxels = leaf_.voxels;
    Moments* moments = leaf_.moments;
    const V* all = reinterpret_cast<const V*>(table);
    auto* out = reinterpret_cast<Leaf*>(buffer + l.leafHere);
    b_.template forTeams<NoShared>(
        l.leaves, 32, TETVDB_KERNEL(const Team& team, u64 leaf, NoShared&) {
          const u64 slot = nodeSlot[leaf];
          const u64* mask = masks + 8 * slot;
          Leaf& node = out[leaf];
          u64* head = reinterpret_cast<u64*>(&node);
          for (int w = team.rank(); w < 10; w += team.size())
            head[w] = w < 2 ? headWord(space, keys[leaf], mask, static_cast<u32>(w)) : mask[w - 2];
          if (team.rank() == 0) {
            voxels[leaf] = countVoxels(mask);
            // Between the mask and the values.
            u64* const from = head + 10;
            memset(from, 0,
                   static_cast<u64>(reinterpret_cast<u8*>(node.mValues) -
                                    reinterpret_cast<u8*>(from)));
            if (all == nullptr) {
              summarize(values, node);
            } else {
              const LeafSummary sum = summaries[slot];
              moments[leaf] = {sum.count, sum.mean, sum.squares};
              summarize(sum, all + 512 * slot, isFloat, node);
            }
          }
          u64* to = reinterpret_cast<u64*>(node.mValues);
          if (all != nullptr) {
            const u64* from = reinterpret_cast<const u64*>(all + 512 * slot);
            for (u32 w = static_cast<u32>(team.rank()); w < sizeof(V) * 64;
                 w += static_cast<u32>(team.size()))
              to[w] = from[w];
          } else {
            for (int w = team.rank(); w < 256; w += team.size()) {
              const u64 two = mask[w >> 5] >> (2 * (w & 31)) & 3;
              to[w] = u64((two & 2) != 0 ? values.inside : values.background) << 32 |
                      ((two & 1) != 0 ? values.inside : values.background);
            }
          }
        });
  }

  template <int kLog2, typename V>
  void writeNodes(u8* buffer, const BufferLayout& l, const NodeMasks<kLog2>& masks,
                  const Entries& children, LevelNodes& nodes, const LevelNodes& below) {
    constexpr int level = kLog2 == 4 ? 1 : 2;
    using Lower = typename NodesOf<V>::Lower;
    using Node = std::conditional_t<kLog2 == 4, Lower, typename NodesOf<V>::Upper>;
    constexpr int kChildren = 1 << (3 * kLog2);
    using Shared = WriteShared<kLog2, V>;
    constexpr int kWords = Shared::kWords;
    const u64 count = level == 1 ? l.lowers : l.uppers;
    const u64 at = level == 1 ? l.lower : l.upper, childAt = level == 1 ? l.leaf : l.lower;
    u8* const here = buffer + (level == 1 ? l.lowerHere : l.upperHere);
    const u8* const childrenHere = buffer + (level == 1 ? l.leafHere : l.lowerHere);
    const u64 childSize = level == 1 ? nodeSizes(kind_).leaf : sizeof(Lower);
    const int childSide = level == 1 ? 8 : 128;
    const u64 *childMask = masks.child, *tileMask = masks.tile, *begin = masks.begin;
    const u64 made = masks.made;
    const u32* nodeSlot = nodes.nodeSlot;
    const u64* keys = nodes.key;
    u64* voxels = nodes.voxels;
    Moments* moments = nodes.moments;
    const u64 *childIndex = below.index, *childVoxels = below.voxels;
    const Moments* childMoments = below.moments;
    const u32 *childPositions = children.position, *childSlots = children.slot;
    const u8* childStates = children.state;
    const i32* childValues = children.value;
    const u64* childKeys = children.treeKey;
    const Kind kind = kind_;
    const bool isFloat = kind_ == Kind::Float;
    const GridValues values = values_;
    const bool differ = valuesDiffer();
    const KeySpace space = space_;
    u64* totals = totals_;
    b_.template forTeams<Shared>(
        count, Shared::kThreads, TETVDB_KERNEL(const Team& team, u64 number, Shared& s) {
          const u64 slot = nodeSlot[number];
          Node& node = *reinterpret_cast<Node*>(here + number * sizeof(Node));
          i32 origin[3];
          originOf(space, level, placeOfTreeKey(space, level, keys[number]), origin);
          for (int w = team.rank(); w < kWords; w += team.size()) {
            s.child[w] = childMask[slot * kWords + static_cast<u64>(w)];
            s.tile[w] = tileMask[slot * kWords + static_cast<u64>(w)];
            wordsOf(node.mChildMask)[w] = s.child[w];
            wordsOf(node.mValueMask)[w] = values.narrowBand ? 0 : s.tile[w];
            s.before[w] = static_cast<u32>(bitCount(s.child[w]));
          }
          if (team.rank() == 0) {
            clearBounds(s);
            s.voxels = s.tiles = s.low32 = 0;
          }
          team.sync();
          sumsBefore(team, s.before, s.spare, kWords);
          const u64 first = slot < made ? begin[slot] : 0, end = slot < made ? begin[slot + 1] : 0;
          const auto numberOf = [&](u64 j) { return childIndex == nullptr ? j : childIndex[j]; };
          const u64 firstChild = slot < made ? numberOf(first) : 0;
          const u64 toChildren = childAt - (at + number * sizeof(Node));
          for (int i = team.rank(); i < kChildren; i += team.size()) {
            const u64 bit = u64(1) << (i & 63), child = s.child[i >> 6];
            if ((child & bit) != 0) {
              const u64 index =
                  firstChild + s.before[i >> 6] + static_cast<u64>(bitCount(child & (bit - 1)));
              setChild<V>(node.mTable[i], toChildren + index * childSize);
              continue;
            }
            const bool inside = (s.tile[i >> 6] & bit) != 0;
            setEntry(node.mTable[i], valueFrom<V>(inside ? values.inside : values.background));
          }
          // Active tiles: their box, and how many.
          for (int w = team.rank(); w < kWords; w += team.size()) {
            const u64 tile = s.tile[w];
            if (tile == 0 || values.narrowBand)
              continue;
            addTo(&s.tiles, static_cast<u32>(bitCount(tile)));
            for (int half = 0; half < 64; half += 1 << kLog2) {
              const u64 run = tile >> half & (kLog2 == 4 ? 0xFFFFull : 0xFFFFFFFFull);
              if (run == 0)
                continue;
              const int n = w * 64 + half, x = n >> (2 * kLog2),
                        y = n >> kLog2 & ((1 << kLog2) - 1);
              const int from[3] = {x, y, lowestBit(run)}, to[3] = {x, y, highestBit(run)};
              for (int a = 0; a < 3; ++a) {
                minInto(&s.low[a], origin[a] + from[a] * childSide);
                maxInto(&s.high[a], origin[a] + to[a] * childSide + childSide - 1);
              }
            }
          }
          team.sync();
          const double tileVoxels = static_cast<double>(childSide) * childSide * childSide;
          // Sums of doubles are made in a fixed number of parts; without them all members take
          // part.
          const int parts = differ ? kParts : team.size();
          Extremes<V> extremes;
          for (int p = team.rank(); p < parts; p += team.size()) {
            i32 low[3] = {0x7FFFFFFF, 0x7FFFFFFF, 0x7FFFFFFF};
            i32 high[3] = {-0x7FFFFFFF - 1, -0x7FFFFFFF - 1, -0x7FFFFFFF - 1};
            u64 sum = 0;
            Moments part{0, 0, 0};
            if (values.variedLeaves && p == 0 && s.tiles != 0) {
              const V value = valueFrom<V>(values.inside);
              extremes.add(value, value, 0xFFFFFFFEu, isFloat);
              addMoments(part, {s.tiles * tileVoxels, statisticOf(value, isFloat), 0});
            }
            for (u64 j = first + static_cast<u64>(p); j < end; j += static_cast<u64>(parts)) {
              const u64 child = numberOf(j);
              if (numberOf(j + 1) != child) { // the entry is a node
                const u8* bytes = childrenHere + child * childSize;
                i32 from[3], to[3];
                if (level == 1) {
                  const MaskLeaf& leaf = *reinterpret_cast<const MaskLeaf*>(bytes);
                  for (u32 a = 0; a < 3; ++a) {
                    from[a] = leaf.mBBoxMin[a];
                    to[a] = leaf.mBBoxMin[a] + leaf.mBBoxDif[a];
                  }
                } else {
                  const Lower& lower = *reinterpret_cast<const Lower*>(bytes);
                  for (u32 a = 0; a < 3; ++a) {
                    from[a] = lower.mBBox[0][a];
                    to[a] = lower.mBBox[1][a];
                  }
                }
                for (u32 a = 0; a < 3; ++a) {
                  low[a] = from[a] < low[a] ? from[a] : low[a];
                  high[a] = to[a] > high[a] ? to[a] : high[a];
                }
                sum += childVoxels[child];
                if (differ) {
                  using Child = std::conditional_t<level == 1, typename NodesOf<V>::Leaf, Lower>;
                  const auto& of = *reinterpret_cast<const Child*>(bytes);
                  extremes.add(of.mMinimum, of.mMaximum, static_cast<u32>(j - first), isFloat);
                  addMoments(part, childMoments[child]);
                }
              } else if (values.varied) {
                const u32 childSlot = childSlots[childPositions[j]];
                if (childStates[childSlot] != kFull)
                  continue;
                const V value = tileValue<V>(values, childValues[childSlot]);
                setEntry(node.mTable[childKeys[j] & (kChildren - 1)], value);
                extremes.add(value, value, static_cast<u32>(j - first), isFloat);
                addMoments(part, {tileVoxels, statisticOf(value, isFloat), 0});
              }
            }
            if (low[0] <= high[0])
              for (int a = 0; a < 3; ++a) {
                minInto(&s.low[a], low[a]);
                maxInto(&s.high[a], high[a]);
              }
            if (sum != 0 && level == 1)
              addTo(&s.low32, static_cast<u32>(sum));
            else if (sum != 0)
              addTo(&s.voxels, sum);
            if (differ)
              s.part[p] = part;
          }
          if (differ)
            s.extremes.join(extremes);
          team.sync();
          if (team.rank() == 0) {
            for (u32 a = 0; a < 3; ++a) {
              node.mBBox[0][a] = s.low[a];
              node.mBBox[1][a] = s.high[a];
            }
            node.mFlags = 2;
            const u64 side = static_cast<u64>(childSide);
            voxels[number] = s.voxels + s.low32 + s.tiles * side * side * side;
            addTo(totals + level, u64(s.tiles));
            memset(&node.mMinimum, 0,
                   static_cast<u64>(reinterpret_cast<u8*>(node.mTable) -
                                    reinterpret_cast<u8*>(&node.mMinimum)));
            if (differ)
              setMoments(node, moments[number] = sumParts(s));
            else
              setUniform(node, kind, values, static_cast<const V*>(nullptr));
          }
          team.sync();
          if (differ)
            setExtremes(team, s.extremes, extremes, isFloat, node);
          team.sync();
        });
  }

  template <typename V>
  void writeHeadOf(u8* buffer, const BufferLayout& l, const nanovdb::GridData& header,
                   const RootParts& parts) {
    using Root = typename NodesOf<V>::Root;
    using Upper = typename NodesOf<V>::Upper;
    using Tile = typename Root::Tile;
    using Shared = HeadShared<V>;
    const RootEntry* entries = parts.entries;
    const u64* upperVoxels = parts.voxels;
    const Moments* upperMoments = parts.moments;
    const u64* totals = parts.totals;
    const u64 n = parts.count;
    const Kind kind = kind_;
    const bool isFloat = kind_ == Kind::Float;
    const GridValues values = values_;
    const bool differ = valuesDiffer();
    const KeySpace space = space_;
    b_.template forTeams<Shared>(
        1, kParts, TETVDB_KERNEL(const Team& team, u64, Shared& s) {
          auto& root = *reinterpret_cast<Root*>(buffer + l.root);
          auto* tiles = reinterpret_cast<Tile*>(&root + 1);
          for (int w = team.rank(); w < static_cast<int>(sizeof header / 8); w += team.size())
            reinterpret_cast<u64*>(buffer)[w] = reinterpret_cast<const u64*>(&header)[w];
          if (team.rank() == 0) {
            clearBounds(s);
            s.voxels = 0;
          }
          team.sync();
          Extremes<V> extremes;
          for (int p = team.rank(); p < kParts; p += team.size()) {
            Moments part{0, 0, 0};
            for (u64 j = static_cast<u64>(p); j < n; j += kParts) {
              const RootEntry entry = entries[j];
              if (entry.state == kEmpty)
                continue;
              i32 origin[3];
              originOf(space, 2, placeOfTreeKey(space, 2, entry.key), origin);
              Tile& tile = tiles[entry.rank]; // its padding is zeros too
              memset(static_cast<void*>(&tile), 0, sizeof tile);
              tile.key = Root::CoordToKey(
                  typename nanovdb::NanoRoot<V>::CoordType(origin[0], origin[1], origin[2]));
              i32 from[3], to[3];
              u64 voxels = u64(1) << 36;
              if (entry.state == kNode) {
                const u64 at = l.upper + entry.upper * sizeof(Upper);
                const auto& upper = *reinterpret_cast<const Upper*>(buffer + at);
                tile.child = static_cast<i64>(at - l.root);
                for (u32 a = 0; a < 3; ++a) {
                  from[a] = upper.mBBox[0][a];
                  to[a] = upper.mBBox[1][a];
                }
                voxels = upperVoxels[entry.upper];
                if (differ) {
                  addMoments(part, upperMoments[entry.upper]);
                  extremes.add(upper.mMinimum, upper.mMaximum, static_cast<u32>(j), isFloat);
                }
              } else if (values.narrowBand) {
                tile.value = valueFrom<V>(values.inside);
                continue;
              } else {
                tile.state = 1;
                tile.value =
                    values.varied ? tileValue<V>(values, entry.value) : valueFrom<V>(values.inside);
                if (differ) {
                  addMoments(part,
                             {static_cast<double>(voxels), statisticOf(tile.value, isFloat), 0});
                  extremes.add(tile.value, tile.value, static_cast<u32>(j), isFloat);
                }
                for (int a = 0; a < 3; ++a) {
                  from[a] = origin[a];
                  to[a] = origin[a] + 4095;
                }
              }
              for (int a = 0; a < 3; ++a) {
                minInto(&s.low[a], from[a]);
                maxInto(&s.high[a], to[a]);
              }
              addTo(&s.voxels, voxels);
            }
            s.part[p] = part;
          }
          s.extremes.join(extremes);
          team.sync();
          const bool empty = l.rootTiles == 0;
          if (team.rank() == 0) {
            memset(static_cast<void*>(&root), 0, sizeof root);
            for (u32 a = 0; a < 3; ++a) {
              root.mBBox[0][a] = empty ? 0x7FFFFFFF : s.low[a];
              root.mBBox[1][a] = empty ? -0x7FFFFFFF - 1 : s.high[a];
            }
            root.mTableSize = static_cast<u32>(l.rootTiles);
            root.mBackground = valueFrom<V>(values.background);
            if (empty)
              root.mMinimum = root.mMaximum = root.mBackground;
            else if (differ)
              setMoments(root, sumParts(s));
            else
              setUniform(root, kind, values, static_cast<const V*>(nullptr));
            auto& grid = *reinterpret_cast<nanovdb::GridData*>(buffer);
            grid.mGridSize = l.size;
            if (!empty) {
              flagsOf(grid) |= u32(nanovdb::GridFlags::HasBBox);
              for (int a = 0; a < 3; ++a) {
                const double scale = grid.mMap.mMatD[4 * a], at = grid.mMap.mVecD[a];
                grid.mWorldBBox[0][a] = at + scale * s.low[a];
                grid.mWorldBBox[1][a] = at + scale * (static_cast<double>(s.high[a]) + 1);
              }
            }
            auto& tree = *reinterpret_cast<TreeData*>(&grid + 1);
            const u64 at[4] = {l.leaf, l.lower, l.upper, l.root};
            for (int level = 0; level < 4; ++level)
              tree.mNodeOffset[level] = at[level] - sizeof grid;
            tree.mNodeCount[0] = static_cast<u32>(l.leaves);
            tree.mNodeCount[1] = static_cast<u32>(l.lowers);
            tree.mNodeCount[2] = static_cast<u32>(l.uppers);
            tree.mTileCount[0] = static_cast<u32>(totals[1]);
            tree.mTileCount[1] = static_cast<u32>(totals[2]);
            tree.mTileCount[2] = values.narrowBand ? 0 : static_cast<u32>(l.rootTiles - l.uppers);
            tree.mVoxelCount = s.voxels;
          }
          team.sync();
          if (differ && !empty)
            setExtremes(team, s.extremes, extremes, isFloat, root);
          team.sync();
          // NanoVDB's partial checksum: grid, tree and root but for magic and checksum.
          const u64 size = l.upper - 16, chunk = (size + kParts - 1) / kParts;
          for (int p = team.rank(); p < kParts; p += team.size()) {
            const u64 from =
                static_cast<u64>(p) * chunk < size ? static_cast<u64>(p) * chunk : size;
            const u64 to = from + chunk < size ? from + chunk : size;
            // Each is computed as if zeros followed, so that the sums of the parts need no order.
            s.crc[p] = crcMultiply(crcPower(size - to), crcOf(buffer + 16 + from, to - from));
            if (p == 0)
              s.crcStart = crcMultiply(crcPower(size), 0xFFFFFFFFu);
          }
          team.sync();
          if (team.rank() == 0) {
            u32 crc = s.crcStart;
            for (int p = 0; p < kParts; ++p)
              crc ^= s.crc[p];
            checksumOf(*reinterpret_cast<nanovdb::GridData*>(buffer)) =
                u64(0xFFFFFFFFu) << 32 | (crc ^ 0xFFFFFFFFu);
          }
          team.sync();
        });
  }

private:
  Backend& b_;
  KeySpace space_;
  Kind kind_;
  GridValues values_;
  LevelNodes leaf_, lower_, upper_;
  const u64* tileRank_ = nullptr;
  const RootEntry* roots_ = nullptr;
  u64 rootCount_ = 0;
  u64* totals_ = nullptr;
};

} // namespace tetvdb::nano
