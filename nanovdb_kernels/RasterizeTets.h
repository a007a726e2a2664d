// SPDX-License-Identifier: Apache-2.0
//
// Leaves from tets: into a dense array of leaf masks where the grid is small (no sorting, the road
// for many small tets), or by (tet, leaf) pairs sorted by leaf where every voxel's owner is asked
// for.
#pragma once

#include "RasterizeFaces.h"

namespace tetvdb::nano {

constexpr u32 kNoTet = 0xFFFFFFFFu;

/// Sums over the values of a leaf's active voxels.
struct LeafSummary {
  i32 min, max;
  double count, mean, squares; ///< squares: of the distances from the mean
};

/// Owners of a leaf's voxels at [z * kOwnerRow + 8 x + y]: columns side by side, rows apart, so
/// that neither a warp of columns nor one of voxels in order meets itself in a bank.
constexpr int kOwnerRow = 68;
constexpr int kOwnerParts = 64; // of the sums, whose order is fixed

constexpr int kStaged = 16; // tets that a team looks at together

struct OwnerShared {
  static constexpr int kThreads = 64, kOccupancy = 28;
  TetPlanes tet[kStaged];
  u32 id[kStaged];
  u32 owner[8 * kOwnerRow];
  alignas(8) u8 run[64]; // a column's bits: eight of them are a word of the mask
  i32 minValue, maxValue;
  u32 count[kOwnerParts];
  i64 sum[kOwnerParts];
  double squares[kOwnerParts];
};

template <typename Backend>
class TetRasterizer {
public:
  /// `signs`: of the tets; those of 0 own nothing.
  TetRasterizer(Backend& backend, const KeySpace& space, const LatticePoint* points,
                const u32* tets, u64 tetCount, const std::int8_t* signs)
      : b_(backend), space_(space), points_(points), tets_(tets), tetCount_(tetCount),
        signs_(signs) {}

  /// Occupancy by way of the leaves of lower nodes nodeMin..nodeMax (of the key space, inclusive):
  /// first beginDense(), then addDense() for all tets, in parts, then endDense().
  void beginDense(const u64 (&nodeMin)[3], const u64 (&nodeMax)[3]) {
    for (int k = 0; k < 3; ++k) {
      dense_.first[k] = nodeMin[k];
      dense_.size[k] = nodeMax[k] - nodeMin[k] + 1;
    }
    denseLeaves_ = dense_.size[0] * dense_.size[1] * dense_.size[2] * 4096;
    dense_.mask = b_.template temp<u64>(8 * denseLeaves_);
    b_.zero(dense_.mask, 64 * denseLeaves_);
    isLarge_ = b_.template temp<u32>(tetCount_ + 1);
    b_.zero(isLarge_ + tetCount_, sizeof(u32));
  }
  void addDense(u64 begin, u64 end) { rasterizeSmall(begin, end); }
  Entries endDense(LeafMasks& leaves) {
    const u64 large = listLarge();
    if (large > 0)
      rasterizeLarge(dense_, large);
    b_.stage("collect");
    const Entries e = collect(dense_, denseLeaves_, leaves);
    b_.dropTemporaries();
    return e;
  }

  /// The value (of the lowest tet that owns the voxel: `values` by tet, or the tet's number) of
  /// every voxel, 512 an entry to `table`, and their sums.
  Entries runOwners(const i32* values, i32 background, LeafMasks& leaves, i32*& table,
                    LeafSummary*& summaries) {
    b_.stage("pairs");
    makePairs();
    Entries e = leafEntries();
    leaves.mask = b_.template alloc<u64>(8 * e.count);
    table = b_.template alloc<i32>(512 * e.count);
    summaries = b_.template alloc<LeafSummary>(e.count);
    e.value = b_.template alloc<i32>(e.count);
    b_.stage("owners");
    rasterizeOwners(e, values, background, leaves.mask, table, summaries);
    b_.dropTemporaries();
    return e;
  }

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

  // Corners and box of tet t; false where it owns nothing.
  TETVDB_HD static bool load(const LatticePoint* points, const u32* tets, const std::int8_t* signs,
                             u64 t, LatticePoint (&v)[4], VoxelBounds& box) {
    if (signs[t] == 0)
      return false;
    for (int k = 0; k < 4; ++k)
      v[k] = points[tets[4 * t + static_cast<u64>(k)]];
    box = boundsOf(v);
    return !box.empty();
  }

  // Sets the run of column (dx, dy) of a tet's box.
  TETVDB_HD static void rasterizeColumn(const Dense& dense, const KeySpace& space,
                                        const TetPlanes& tet, const TetSource& source,
                                        const double (&rows)[4], int dx, int dy) {
    int lo, hi;
    if (ownedRun(tet, source, rows, dx, dy, tet.min[2], tet.max[2] - tet.min[2] + 1, lo, hi))
      setRun(dense, space, tet.min[0] + dx, tet.min[1] + dy, tet.min[2], lo, hi);
  }

  // A thread a tet of up to 64 columns; larger ones are marked.
  void rasterizeSmall(u64 begin, u64 end) {
    const Dense dense = dense_;
    const KeySpace space = space_;
    const LatticePoint* points = points_;
    const u32* tets = tets_;
    const std::int8_t* signs = signs_;
    u32* isLarge = isLarge_;
    b_.forEach(
        end - begin, TETVDB_KERNEL(u64 i) {
          const u64 t = begin + i;
          isLarge[t] = 0;
          LatticePoint v[4];
          VoxelBounds box;
          if (!load(points, tets, signs, t, v, box))
            return;
          if ((box.max[0] - box.min[0] + 1) * (box.max[1] - box.min[1] + 1) > 64) {
            isLarge[t] = 1;
            return;
          }
          TetPlanes tet;
          preparePlanes(v, signs[t], box, tet);
          const TetSource source{points, tets + 4 * t};
          // One loop over all columns: threads of a warp differ in how many rows they have.
          double rows[4] = {tet.base[0], tet.base[1], tet.base[2], tet.base[3]};
          const int width = tet.max[0] - tet.min[0], height = tet.max[1] - tet.min[1];
          for (int dx = 0, dy = 0; dx <= width;) {
            rasterizeColumn(dense, space, tet, source, rows, dx, dy);
            if (++dy > height) {
              dy = 0;
              ++dx;
              for (int f = 0; f < 4; ++f)
                rows[f] = tet.base[f] + tet.slopeX[f] * dx;
            }
          }
        });
  }

  // How many tets are marked; lists them in large_.
  u64 listLarge() {
    const u32* isLarge = isLarge_;
    const u64 n = tetCount_;
    u64* rank = b_.template temp<u64>(n + 1);
    b_.scan(isLarge, rank, n);
    const u64 count = b_.read(rank + n);
    if (count == 0)
      return 0;
    large_ = b_.template temp<u32>(count);
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
    TetPlanes* prepared = b_.template temp<TetPlanes>(count);
    u32* columns = b_.template temp<u32>(count + 1);
    u64* offset = b_.template temp<u64>(count + 1);
    b_.forEach(
        count + 1, TETVDB_KERNEL(u64 i) {
          columns[i] = 0;
          if (i == count)
            return;
          LatticePoint v[4];
          VoxelBounds box;
          load(points, tets, signs, large[i], v, box);
          preparePlanes(v, signs[large[i]], box, prepared[i]);
          columns[i] =
              static_cast<u32>((box.max[0] - box.min[0] + 1) * (box.max[1] - box.min[1] + 1));
        });
    b_.scan(columns, offset, count);
    const u64 total = b_.read(offset + count);
    b_.forEach(
        total, TETVDB_KERNEL(u64 i) {
          const u64 k = ownerOf(offset, count, i);
          const TetPlanes& tet = prepared[k];
          const u32 local = static_cast<u32>(i - offset[k]),
                    height = static_cast<u32>(tet.max[1] - tet.min[1] + 1);
          const int dx = static_cast<int>(local / height), dy = static_cast<int>(local % height);
          double rows[4];
          for (int f = 0; f < 4; ++f)
            rows[f] = tet.base[f] + tet.slopeX[f] * dx;
          rasterizeColumn(dense, space, tet, {points, tets + 4 * u64(large[k])}, rows, dx, dy);
        });
  }

  // The leaves that are not empty, in tree order.
  Entries collect(const Dense& dense, u64 leafCount, LeafMasks& leaves) {
    u32* some = b_.template temp<u32>(leafCount + 1);
    u64* rank = b_.template temp<u64>(leafCount + 1);
    b_.forEach(
        leafCount + 1, TETVDB_KERNEL(u64 i) {
          u64 any = 0;
          if (i < leafCount)
            for (u64 w = 0; w < 8; ++w)
              any |= dense.mask[8 * i + w];
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
    prepared_ = b_.template temp<TetPlanes>(n);
    TetPlanes* prepared = prepared_;
    u32* count = b_.template temp<u32>(n + 1);
    u64* offset = b_.template temp<u64>(n + 1);
    b_.forEach(
        n + 1, TETVDB_KERNEL(u64 t) {
          count[t] = 0;
          LatticePoint v[4];
          VoxelBounds box;
          if (t == n || !load(points, tets, signs, t, v, box))
            return;
          TetPlanes tet;
          preparePlanes(v, signs[t], box, tet);
          prepared[t] = tet;
          u64 leaves = 1;
          for (int k = 0; k < 3; ++k)
            leaves *= static_cast<u64>((box.max[k] >> 3) - (box.min[k] >> 3) + 1);
          count[t] = leaves < 0xFFFFFFFFu ? static_cast<u32>(leaves) : 0xFFFFFFFFu;
        });
    b_.scan(count, offset, n);
    const u64 candidates = b_.read(offset + n);
    u64* keys = b_.template temp<u64>(candidates);
    u32* kept = b_.template temp<u32>(candidates + 1);
    u32* owner = b_.template temp<u32>(candidates);
    b_.forEach(
        candidates + 1, TETVDB_KERNEL(u64 i) {
          kept[i] = 0;
          if (i == candidates)
            return;
          const u64 t = ownerOf(offset, n, i);
          const TetPlanes& tet = prepared[t];
          const u32 rows = static_cast<u32>((tet.max[1] >> 3) - (tet.min[1] >> 3) + 1),
                    heights = static_cast<u32>((tet.max[2] >> 3) - (tet.min[2] >> 3) + 1);
          const u32 k = static_cast<u32>(i - offset[t]);
          const i64 leaf[3] = {(tet.min[0] >> 3) + i64(k / heights / rows),
                               (tet.min[1] >> 3) + i64(k / heights % rows),
                               (tet.min[2] >> 3) + i64(k % heights)};
          i64 low[3], high[3];
          for (int a = 0; a < 3; ++a) {
            low[a] = leaf[a] * 8 > tet.min[a] ? leaf[a] * 8 : i64(tet.min[a]);
            high[a] = leaf[a] * 8 + 7 < tet.max[a] ? leaf[a] * 8 + 7 : i64(tet.max[a]);
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
    u64* rank = b_.template temp<u64>(candidates + 1);
    b_.scan(kept, rank, candidates);
    pairCount_ = b_.read(rank + candidates);
    pairKey_ = b_.template temp<u64>(pairCount_);
    pairTet_ = b_.template temp<u32>(pairCount_);
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
    u32* head = b_.template temp<u32>(n + 1);
    u64* rank = b_.template temp<u64>(n + 1);
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
    leafBegin_ = b_.template temp<u64>(e.count + 1);
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
    return e;
  }

  // Calls own(place, tet) for the voxels of column (x, y) of the leaf that the tet owns.
  template <typename Own>
  TETVDB_HD static void ownColumn(const TetPlanes& tet, const TetSource& source,
                                  const i32 (&origin)[3], int x, int y, const Own& own) {
    const int dx = origin[0] + x - tet.min[0], dy = origin[1] + y - tet.min[1];
    if (dx < 0 || dx > tet.max[0] - tet.min[0] || dy < 0 || dy > tet.max[1] - tet.min[1])
      return;
    double rows[4];
    for (int f = 0; f < 4; ++f)
      rows[f] = tet.base[f] + tet.slopeX[f] * dx;
    int lo, hi;
    if (!ownedRun(tet, source, rows, dx, dy, origin[2], 8, lo, hi))
      return;
    for (int z = lo; z < hi; ++z)
      own(z * kOwnerRow + x * 8 + y);
  }

  void rasterizeOwners(const Entries& e, const i32* values, i32 background, u64* masks, i32* table,
                       LeafSummary* summaries) {
    const KeySpace space = space_;
    const LatticePoint* points = points_;
    const u32* tets = tets_;
    const TetPlanes* prepared = prepared_;
    const u32* pairTet = pairTet_;
    const u64 *begin = leafBegin_, *keys = e.treeKey;
    u8* states = e.state;
    i32* leafValues = e.value;
    b_.template forTeams<OwnerShared>(
        e.count, 64, TETVDB_KERNEL(const Team& team, u64 entry, OwnerShared& s) {
          for (int i = team.rank(); i < 8 * kOwnerRow; i += team.size())
            s.owner[i] = kNoTet;
          if (team.rank() == 0) {
            s.minValue = 0x7FFFFFFF;
            s.maxValue = -0x7FFFFFFF - 1;
          }
          team.sync();
          i32 origin[3];
          originOf(space, 0, placeOfTreeKey(space, 0, keys[entry]), origin);
          const u64 first = begin[entry], end = begin[entry + 1];
          if (end - first <= 64) {
            // A column is one member's alone. Tets are fetched together, for one by one the team
            // would wait for each.
            for (u64 k = first; k < end; k += kStaged) {
              const int count = end - k < kStaged ? static_cast<int>(end - k) : kStaged;
              constexpr int kWords = sizeof(TetPlanes) / 8;
              for (int w = team.rank(); w < count * kWords; w += team.size()) {
                const u32 t = pairTet[k + static_cast<u64>(w / kWords)];
                reinterpret_cast<u64*>(s.tet)[w] =
                    reinterpret_cast<const u64*>(prepared + t)[w % kWords];
                if (w % kWords == 0)
                  s.id[w / kWords] = t;
              }
              team.sync();
              for (int i = 0; i < count; ++i) {
                const u32 t = s.id[i];
                for (int c = team.rank(); c < 64; c += team.size())
                  ownColumn(s.tet[i], {points, tets + 4 * u64(t)}, origin, c >> 3, c & 7,
                            [&](int place) {
                              if (t < s.owner[place])
                                s.owner[place] = t;
                            });
              }
              team.sync();
            }
          } else {
            for (u64 k = first + static_cast<u64>(team.rank()); k < end;
                 k += static_cast<u64>(team.size())) {
              const u32 t = pairTet[k];
              const TetPlanes& tet = prepared[t];
              const i32 xl = tet.min[0] - origin[0], xh = tet.max[0] - origin[0];
              const i32 yl = tet.min[1] - origin[1], yh = tet.max[1] - origin[1];
              for (int x = xl > 0 ? xl : 0; x <= (xh < 7 ? xh : 7); ++x)
                for (int y = yl > 0 ? yl : 0; y <= (yh < 7 ? yh : 7); ++y)
                  ownColumn(tet, {points, tets + 4 * u64(t)}, origin, x, y,
                            [&](int place) { minInto(&s.owner[place], t); });
            }
          }
          team.sync();
          const auto valueOf = [&](u32 t) {
            return values == nullptr ? static_cast<i32>(t) : values[t];
          };
          // One (y, z) slab of 64 voxels after another; a member has its column's.
          i32 low = 0x7FFFFFFF, high = -0x7FFFFFFF - 1;
          for (int i = team.rank(); i < 512; i += team.size()) {
            const u32 t = s.owner[(i & 7) * kOwnerRow + (i >> 3)];
            i32 value = background;
            if (t != kNoTet) {
              value = valueOf(t);
              low = value < low ? value : low;
              high = value > high ? value : high;
            }
            table[entry * 512 + static_cast<u64>(i)] = value;
          }
          if (low <= high) {
            minInto(&s.minValue, low);
            maxInto(&s.maxValue, high);
          }
          team.sync();
          for (int p = team.rank(); p < kOwnerParts; p += team.size()) {
            u32 count = 0, run = 0;
            i64 sum = 0;
            double squares = 0;
            for (int z = 0; z < 8; ++z) {
              const u32 t = s.owner[z * kOwnerRow + p];
              if (t == kNoTet)
                continue;
              const i64 above = i64(valueOf(t)) - s.minValue;
              ++count;
              run |= 1u << z;
              sum += above;
              squares += static_cast<double>(above) * static_cast<double>(above);
            }
            s.count[p] = count;
            s.run[p] = static_cast<u8>(run);
            s.sum[p] = sum;
            s.squares[p] = squares;
          }
          team.sync();
          for (int i = team.rank(); i < 8; i += team.size())
            masks[8 * entry + static_cast<u64>(i)] = reinterpret_cast<const u64*>(s.run)[i];
          if (team.rank() == 0) {
            u32 count = 0;
            i64 sum = 0;
            double squares = 0;
            for (int p = 0; p < kOwnerParts; ++p) {
              count += s.count[p];
              sum += s.sum[p];
              squares += s.squares[p];
            }
            const double mean = count == 0 ? 0 : static_cast<double>(sum) / count;
            const double rest = squares - mean * static_cast<double>(sum);
            summaries[entry] = {s.minValue, s.maxValue, static_cast<double>(count),
                                mean + s.minValue, rest > 0 ? rest : 0};
            states[entry] = count == 0                                 ? kEmpty
                            : count == 512 && s.minValue == s.maxValue ? kFull
                                                                       : kNode;
            leafValues[entry] = s.minValue;
          }
          team.sync();
        });
  }

private:
  Backend& b_;
  KeySpace space_;
  const LatticePoint* points_;
  const u32* tets_;
  u64 tetCount_;
  const std::int8_t* signs_;
  Dense dense_{};
  u64 denseLeaves_ = 0;
  u32 *isLarge_ = nullptr, *large_ = nullptr;
  TetPlanes* prepared_ = nullptr;
  u64* pairKey_ = nullptr;
  u32* pairTet_ = nullptr;
  u64 pairCount_ = 0;
  u64* leafBegin_ = nullptr;
};

} // namespace tetvdb::nano
