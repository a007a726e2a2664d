// SPDX-License-Identifier: Apache-2.0
//
// Leaves from tets: into a dense array of leaf masks where the grid is small (no sorting, the road
// for many small tets), or by (tet, leaf) pairs sorted by leaf where every voxel's owner is asked
// for.
#pragma once

#include "RasterizeFaces.h"

namespace tetvdb::nano {

constexpr u32 kNoTet = 0xFFFFFFFFu;

struct OwnerShared {
  u32 owner[512];
  u64 mask[8];
  i32 minValue, maxValue;
};

template <typename Backend>
class TetRasterizer {
public:
  /// `signs`: of the tets; those of 0 own nothing.
  TetRasterizer(Backend& backend, const KeySpace& space, const LatticePoint* points,
                const u32* tets, u64 tetCount, const std::int8_t* signs)
      : b_(backend), space_(space), points_(points), tets_(tets), tetCount_(tetCount),
        signs_(signs) {}

  /// Occupancy by way of the leaves of lower nodes nodeMin..nodeMax (of the key space, inclusive).
  Entries runDense(const u64 (&nodeMin)[3], const u64 (&nodeMax)[3], LeafMasks& leaves) {
    Dense dense;
    for (int k = 0; k < 3; ++k) {
      dense.first[k] = nodeMin[k];
      dense.size[k] = nodeMax[k] - nodeMin[k] + 1;
    }
    const u64 leafCount = dense.size[0] * dense.size[1] * dense.size[2] * 4096;
    dense.mask = b_.template alloc<u64>(8 * leafCount);
    b_.zero(dense.mask, 64 * leafCount);
    const u64 large = rasterizeSmall(dense);
    if (large > 0)
      rasterizeLarge(dense, large);
    return collect(dense, leafCount, leaves);
  }

  /// Owners: value (of the lowest tet that owns the voxel, `values` by tet or the tet's number) for
  /// every voxel. Where `table` of the leaves is null it is left out, and rasterizeOwners() makes
  /// it later.
  Entries runOwners(const i32* values, LeafMasks& leaves, i32*& table, bool keepTable) {
    values_ = values;
    makePairs();
    Entries e = leafEntries();
    leaves.mask = b_.template alloc<u64>(8 * e.count);
    table = keepTable ? b_.template alloc<i32>(512 * e.count) : nullptr;
    e.value = b_.template alloc<i32>(e.count);
    rasterizeOwners(e.count, OwnerSink{leaves.mask, e.state, e.value, nullptr, table, 512, -1});
    return e;
  }

  struct OwnerSink {
    u64* mask;
    u8* state;
    i32* value;
    const u32* leafOf; ///< leaf number of an entry, ~0: none; null: all, in order
    i32* table;        ///< 512 values a leaf, `stride` numbers apart; null: none
    u64 stride;
    i32 background;
  };

  // Public for nvcc alone, as in LevelBuilder.

  struct Dense {
    u64 first[3], size[3];
    u64* mask;
  };

  // Sets voxels lo <= z < hi above z0 of column (x, y).
  TETVDB_HD static void setRun(const Dense& d, const KeySpace& space, i64 x, i64 y, i64 z0, int lo,
                               int hi) {
    const u64 lx = static_cast<u64>((x >> 3) - space.base[0]),
              ly = static_cast<u64>((y >> 3) - space.base[1]);
    const u64 column = ((lx >> 4) - d.first[0]) * d.size[1] + ((ly >> 4) - d.first[1]);
    const int word = static_cast<int>(x & 7), row = static_cast<int>(y & 7);
    for (i64 z = z0 + lo; z < z0 + hi;) {
      const i64 next = (z | 7) + 1 < z0 + hi ? (z | 7) + 1 : z0 + hi;
      const u64 lz = static_cast<u64>((z >> 3) - space.base[2]);
      const u64 node = column * d.size[2] + ((lz >> 4) - d.first[2]);
      const u64 leaf = node << 12 | tableIndex({lx, ly, lz}, 4);
      const u32 bits = ((1u << (next - z)) - 1) << (z & 7);
      u32* half = reinterpret_cast<u32*>(d.mask + 8 * leaf + word) + (row >> 2);
      orInto(half, bits << (8 * (row & 3)));
      z = next;
    }
  }

  TETVDB_HD static bool load(const LatticePoint* points, const u32* tets, const std::int8_t* signs,
                             u64 t, TetColumns& tet) {
    if (signs[t] == 0)
      return false;
    for (int k = 0; k < 4; ++k)
      tet.v[k] = points[tets[4 * t + static_cast<u64>(k)]];
    return true;
  }

  // A thread a tet of up to 64 columns; returns how many are larger, listed in large_.
  u64 rasterizeSmall(const Dense& dense) {
    const KeySpace space = space_;
    const LatticePoint* points = points_;
    const u32* tets = tets_;
    const std::int8_t* signs = signs_;
    u32* isLarge = b_.template alloc<u32>(tetCount_ + 1);
    const u64 n = tetCount_;
    b_.forEach(
        n + 1, TETVDB_KERNEL(u64 t) {
          isLarge[t] = 0;
          TetColumns tet;
          if (t == n || !load(points, tets, signs, t, tet))
            return;
          const VoxelBounds box = boundsOf(tet.v);
          if (box.empty())
            return;
          const i64 columns = (box.max[0] - box.min[0] + 1) * (box.max[1] - box.min[1] + 1);
          if (columns > 64) {
            isLarge[t] = 1;
            return;
          }
          prepareTet(tet);
          const i64 z0 = box.min[2];
          const int span = static_cast<int>(box.max[2] - z0 + 1);
          for (i64 x = box.min[0]; x <= box.max[0]; ++x)
            for (i64 y = box.min[1]; y <= box.max[1]; ++y) {
              int lo, hi;
              if (ownedRun(tet, x, y, z0, span, lo, hi))
                setRun(dense, space, x, y, z0, lo, hi);
            }
        });
    u64* rank = b_.template alloc<u64>(n + 1);
    b_.scan(isLarge, rank, n);
    const u64 count = b_.read(rank + n);
    if (count == 0)
      return 0;
    large_ = b_.template alloc<u32>(count);
    u32* large = large_;
    b_.forEach(
        n, TETVDB_KERNEL(u64 t) {
          if (isLarge[t])
            large[rank[t]] = static_cast<u32>(t);
        });
    return count;
  }

  // A thread a column of a tet.
  void rasterizeLarge(const Dense& dense, u64 count) {
    const KeySpace space = space_;
    const LatticePoint* points = points_;
    const u32 *tets = tets_, *large = large_;
    const std::int8_t* signs = signs_;
    TetColumns* prepared = b_.template alloc<TetColumns>(count);
    u32* columns = b_.template alloc<u32>(count + 1);
    u64* offset = b_.template alloc<u64>(count + 1);
    b_.forEach(
        count + 1, TETVDB_KERNEL(u64 i) {
          columns[i] = 0;
          if (i == count)
            return;
          TetColumns tet;
          load(points, tets, signs, large[i], tet);
          prepareTet(tet);
          prepared[i] = tet;
          const VoxelBounds box = boundsOf(tet.v);
          columns[i] =
              static_cast<u32>((box.max[0] - box.min[0] + 1) * (box.max[1] - box.min[1] + 1));
        });
    b_.scan(columns, offset, count);
    const u64 total = b_.read(offset + count);
    b_.forEach(
        total, TETVDB_KERNEL(u64 i) {
          const u64 k = ownerOf(offset, count, i);
          const TetColumns& tet = prepared[k];
          const VoxelBounds box = boundsOf(tet.v);
          const u64 local = i - offset[k], rows = static_cast<u64>(box.max[1] - box.min[1] + 1);
          const i64 x = box.min[0] + static_cast<i64>(local / rows);
          const i64 y = box.min[1] + static_cast<i64>(local % rows);
          const i64 z0 = box.min[2];
          int lo, hi;
          if (ownedRun(tet, x, y, z0, static_cast<int>(box.max[2] - z0 + 1), lo, hi))
            setRun(dense, space, x, y, z0, lo, hi);
        });
  }

  // The leaves that are not empty, in tree order.
  Entries collect(const Dense& dense, u64 leafCount, LeafMasks& leaves) {
    u32* some = b_.template alloc<u32>(leafCount + 1);
    u64* rank = b_.template alloc<u64>(leafCount + 1);
    b_.forEach(
        leafCount + 1, TETVDB_KERNEL(u64 i) {
          u64 any = 0;
          if (i < leafCount)
            for (int w = 0; w < 8; ++w)
              any |= dense.mask[8 * i + static_cast<u64>(w)];
          some[i] = any != 0;
        });
    b_.scan(some, rank, leafCount);
    Entries e;
    e.count = e.slots = b_.read(rank + leafCount);
    e.key = nullptr; // no order by columns is needed
    e.slot = b_.template alloc<u32>(e.count);
    e.state = b_.template alloc<u8>(e.count);
    e.treeKey = b_.template alloc<u64>(e.count);
    e.position = b_.template alloc<u32>(e.count);
    leaves.mask = b_.template alloc<u64>(8 * e.count);
    const KeySpace space = space_;
    u32 *slots = e.slot, *positions = e.position;
    u8* states = e.state;
    u64 *treeKeys = e.treeKey, *masks = leaves.mask;
    b_.forEach(
        leafCount, TETVDB_KERNEL(u64 i) {
          if (!some[i])
            return;
          const u64 r = rank[i], node = i >> 12;
          const u64 x = dense.first[0] + node / (dense.size[1] * dense.size[2]);
          const u64 y = dense.first[1] + node / dense.size[2] % dense.size[1];
          const u64 z = dense.first[2] + node % dense.size[2];
          u64 all = ~u64(0);
          for (u64 w = 0; w < 8; ++w) {
            const u64 word = dense.mask[8 * i + w];
            all &= word;
            masks[8 * r + w] = word;
          }
          treeKeys[r] = treeKey(space, 1, {x, y, z}) << 12 | (i & 4095);
          slots[r] = positions[r] = static_cast<u32>(r);
          states[r] = all == ~u64(0) ? kFull : kNode;
        });
    b_.sort(e.treeKey, e.position, e.count, space_.total());
    return e;
  }

  // (tet, leaf) pairs by tree key: of the leaves that the tet's box meets, those that it may own
  // voxels of.
  void makePairs() {
    const KeySpace space = space_;
    const LatticePoint* points = points_;
    const u32* tets = tets_;
    const std::int8_t* signs = signs_;
    const u64 n = tetCount_;
    prepared_ = b_.template alloc<TetColumns>(n);
    TetColumns* prepared = prepared_;
    u32* count = b_.template alloc<u32>(n + 1);
    u64* offset = b_.template alloc<u64>(n + 1);
    b_.forEach(
        n + 1, TETVDB_KERNEL(u64 t) {
          count[t] = 0;
          TetColumns tet;
          if (t == n || !load(points, tets, signs, t, tet))
            return;
          const VoxelBounds box = boundsOf(tet.v);
          if (box.empty())
            return;
          prepareTet(tet);
          prepared[t] = tet;
          u64 leaves = 1;
          for (int k = 0; k < 3; ++k)
            leaves *= static_cast<u64>((box.max[k] >> 3) - (box.min[k] >> 3) + 1);
          count[t] = leaves < 0xFFFFFFFFu ? static_cast<u32>(leaves) : 0xFFFFFFFFu;
        });
    b_.scan(count, offset, n);
    const u64 candidates = b_.read(offset + n);
    u64* keys = b_.template alloc<u64>(candidates);
    u32* kept = b_.template alloc<u32>(candidates + 1);
    u32* owner = b_.template alloc<u32>(candidates);
    b_.forEach(
        candidates + 1, TETVDB_KERNEL(u64 i) {
          kept[i] = 0;
          if (i == candidates)
            return;
          const u64 t = ownerOf(offset, n, i);
          const TetColumns& tet = prepared[t];
          const VoxelBounds box = boundsOf(tet.v);
          const u64 rows = static_cast<u64>((box.max[1] >> 3) - (box.min[1] >> 3) + 1),
                    heights = static_cast<u64>((box.max[2] >> 3) - (box.min[2] >> 3) + 1);
          const u64 k = i - offset[t];
          const i64 leaf[3] = {(box.min[0] >> 3) + static_cast<i64>(k / (rows * heights)),
                               (box.min[1] >> 3) + static_cast<i64>(k / heights % rows),
                               (box.min[2] >> 3) + static_cast<i64>(k % heights)};
          i64 low[3], high[3];
          for (int a = 0; a < 3; ++a) {
            low[a] = leaf[a] * 8 > box.min[a] ? leaf[a] * 8 : box.min[a];
            high[a] = leaf[a] * 8 + 7 < box.max[a] ? leaf[a] * 8 + 7 : box.max[a];
          }
          if (outsideBox(tet, low, high))
            return;
          kept[i] = 1;
          owner[i] = static_cast<u32>(t);
          keys[i] = treeKey(space, 0,
                            {static_cast<u64>(leaf[0] - space.base[0]),
                             static_cast<u64>(leaf[1] - space.base[1]),
                             static_cast<u64>(leaf[2] - space.base[2])});
        });
    u64* rank = b_.template alloc<u64>(candidates + 1);
    b_.scan(kept, rank, candidates);
    pairCount_ = b_.read(rank + candidates);
    pairKey_ = b_.template alloc<u64>(pairCount_);
    pairTet_ = b_.template alloc<u32>(pairCount_);
    u64* pairKey = pairKey_;
    u32* pairTet = pairTet_;
    b_.forEach(
        candidates, TETVDB_KERNEL(u64 i) {
          if (!kept[i])
            return;
          pairKey[rank[i]] = keys[i];
          pairTet[rank[i]] = owner[i];
        });
    b_.sort(pairKey_, pairTet_, pairCount_, space_.total());
  }

  Entries leafEntries() {
    const u64 n = pairCount_;
    const u64* pairKey = pairKey_;
    u32* head = b_.template alloc<u32>(n + 1);
    u64* rank = b_.template alloc<u64>(n + 1);
    b_.forEach(
        n + 1,
        TETVDB_KERNEL(u64 i) { head[i] = i < n && (i == 0 || pairKey[i] != pairKey[i - 1]); });
    b_.scan(head, rank, n);
    Entries e;
    e.count = e.slots = b_.read(rank + n);
    e.slot = b_.template alloc<u32>(e.count);
    e.position = e.slot;
    e.state = b_.template alloc<u8>(e.count);
    e.treeKey = b_.template alloc<u64>(e.count);
    leafBegin_ = b_.template alloc<u64>(e.count + 1);
    u64 *begin = leafBegin_, *treeKeys = e.treeKey;
    u32* slots = e.slot;
    const u64 leaves = e.count;
    b_.forEach(
        n + 1, TETVDB_KERNEL(u64 i) {
          if (i == n) {
            begin[leaves] = n;
          } else if (head[i]) {
            begin[rank[i]] = i;
            treeKeys[rank[i]] = pairKey[i];
            slots[rank[i]] = static_cast<u32>(rank[i]);
          }
        });
    leafKey_ = treeKeys;
    return e;
  }

  void rasterizeOwners(u64 count, const OwnerSink& sink) {
    const KeySpace space = space_;
    const TetColumns* prepared = prepared_;
    const u32* pairTet = pairTet_;
    const u64 *begin = leafBegin_, *keys = leafKey_;
    const i32* values = values_;
    b_.template forTeams<OwnerShared>(
        count, 64, TETVDB_KERNEL(const Team& team, u64 entry, OwnerShared& s) {
          const u64 leaf = sink.leafOf == nullptr ? entry : sink.leafOf[entry];
          if (leaf == kNoTet)
            return;
          for (int i = team.rank(); i < 512; i += team.size())
            s.owner[i] = kNoTet;
          for (int i = team.rank(); i < 8; i += team.size())
            s.mask[i] = 0;
          if (team.rank() == 0) {
            s.minValue = 0x7FFFFFFF;
            s.maxValue = -0x7FFFFFFF - 1;
          }
          team.sync();
          i32 origin[3];
          originOf(space, 0, placeOfTreeKey(space, 0, keys[entry]), origin);
          const u64 first = begin[entry], end = begin[entry + 1];
          if (end - first <= 64) {
            for (u64 k = first; k < end; ++k) {
              const u32 t = pairTet[k];
              const TetColumns& tet = prepared[t];
              for (int c = team.rank(); c < 64; c += team.size())
                own(tet, t, origin, c >> 3, c & 7, s.owner);
            }
          } else {
            for (u64 k = first + static_cast<u64>(team.rank()); k < end;
                 k += static_cast<u64>(team.size())) {
              const u32 t = pairTet[k];
              const TetColumns& tet = prepared[t];
              const VoxelBounds box = boundsOf(tet.v);
              const i64 xl = box.min[0] - origin[0], xh = box.max[0] - origin[0];
              const i64 yl = box.min[1] - origin[1], yh = box.max[1] - origin[1];
              for (int x = xl > 0 ? static_cast<int>(xl) : 0; x <= (xh < 7 ? xh : 7); ++x)
                for (int y = yl > 0 ? static_cast<int>(yl) : 0; y <= (yh < 7 ? yh : 7); ++y)
                  own(tet, t, origin, x, y, s.owner);
            }
          }
          team.sync();
          for (int i = team.rank(); i < 512; i += team.size()) {
            const u32 t = s.owner[i];
            i32 value = sink.background;
            if (t != kNoTet) {
              value = values == nullptr ? static_cast<i32>(t) : values[t];
              orInto(&s.mask[i >> 6], u64(1) << (i & 63));
              minInto(&s.minValue, value);
              maxInto(&s.maxValue, value);
            }
            if (sink.table != nullptr)
              sink.table[leaf * sink.stride + static_cast<u64>(i)] = value;
          }
          team.sync();
          if (sink.mask != nullptr) {
            for (int i = team.rank(); i < 8; i += team.size())
              sink.mask[8 * entry + static_cast<u64>(i)] = s.mask[i];
            if (team.rank() == 0) {
              bool any = false, all = true;
              for (int i = 0; i < 8; ++i) {
                any = any || s.mask[i] != 0;
                all = all && s.mask[i] == ~u64(0);
              }
              sink.state[entry] = !any ? kEmpty : all && s.minValue == s.maxValue ? kFull : kNode;
              sink.value[entry] = s.minValue;
            }
          }
          team.sync();
        });
  }

  TETVDB_HD static void own(const TetColumns& tet, u32 t, const i32 (&origin)[3], int x, int y,
                            u32* owner) {
    int lo, hi;
    if (!ownedRun(tet, origin[0] + x, origin[1] + y, origin[2], 8, lo, hi))
      return;
    for (int z = lo; z < hi; ++z)
      minInto(&owner[(x * 8 + y) * 8 + z], t);
  }

private:
  Backend& b_;
  KeySpace space_;
  const LatticePoint* points_;
  const u32* tets_;
  u64 tetCount_;
  const std::int8_t* signs_;
  const i32* values_ = nullptr;
  u32* large_ = nullptr;
  TetColumns* prepared_ = nullptr;
  u64* pairKey_ = nullptr;
  u32* pairTet_ = nullptr;
  u64 pairCount_ = 0;
  u64 *leafBegin_ = nullptr, *leafKey_ = nullptr;
};

} // namespace tetvdb::nano
