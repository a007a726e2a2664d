// SPDX-License-Identifier: Apache-2.0
//
// Makes leaves from tets by (tet, leaf) pairs sorted by leaf, if the owner of every voxel is
// needed.
#pragma once

#include "RasterizeFaces.h"

namespace tetvdb::nano {

constexpr u32 kNoTet = 0xFFFFFFFFu;

/// Sums over the values of a leaf's active voxels.
struct LeafSummary {
  i32 min, max;                ///< in order; of vectors: their voxels
  double count, mean, squares; ///< squares: of the distances from the mean
};

/// Owners of a leaf's voxels at [z * kOwnerRow + 8 x + y]: columns side by side, rows apart, so
/// that neither a warp of columns nor one of voxels in order meets itself in a bank.
constexpr int kOwnerRow = 68;
constexpr int kOwnerParts = 64; // of the sums, whose order is fixed

constexpr int kStaged = 16; // tets that a team tests together

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

  /// The value (of the lowest tet that owns the voxel: `values` by tet, or the tet's number) of
  /// every voxel, 512 an entry to `table`, and their sums.
  Entries runOwners(const i32* values, u32 background, const RootShare& share, LeafMasks& leaves,
                    const u32*& valueTable, const LeafSummary*& leafSummaries) {
    b_.stage("pairs");
    makePairs(share);
    Entries e = leafEntries();
    leaves.mask = b_.template alloc<u64>(8 * e.count);
    u32* const table = b_.template alloc<u32>(512 * e.count);
    auto* const summaries = b_.template alloc<LeafSummary>(e.count);
    valueTable = table;
    leafSummaries = summaries;
    e.value = b_.template alloc<i32>(e.count);
    b_.stage("owners");
    rasterizeOwners(e, values, background, leaves.mask, table, summaries);
    b_.dropTemporaries();
    return e;
  }

  // Public only because of nvcc, as in LevelBuilder.

  // Corners and box of tet t; false where it owns nothing.
  TETVDB_HD static bool load(const LatticePoint* points, const u32* tets, const std::int8_t* signs,
                             u64 t, LatticePoint (&v)[4], TetBox& box) {
    if (signs[t] == 0)
      return false;
    for (int k = 0; k < 4; ++k)
      v[k] = points[tets[4 * t + static_cast<u64>(k)]];
    box = voxelBox(boxOf(v[0], v[1], v[2], v[3]));
    return !box.empty();
  }

  // (tet, leaf) pairs by tree key: of the leaves that the tet's box meets, those that it may own
  // voxels of.
  void makePairs(const RootShare& share) {
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
          TetBox box;
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
          const Place place{static_cast<u64>(leaf[0] - space.base[0]),
                            static_cast<u64>(leaf[1] - space.base[1]),
                            static_cast<u64>(leaf[2] - space.base[2])};
          if (!share.has(space, 0, place) || outsideBox(tet, low, high))
            return;
          kept[i] = 1;
          owner[i] = static_cast<u32>(t);
          keys[i] = treeKey(space, 0, place);
        });
    u64* rank = b_.template temp<u64>(candidates + 1);
    b_.scan(kept, rank, candidates);
    pairCount_ = b_.read(rank + candidates);
    b_.require(2 * pairCount_ * (sizeof(u64) + sizeof(u32)));
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
    const Groups groups = groupsOf(b_, pairKey_, pairCount_, 0);
    // The table of owners twice: in the buffer as well.
    b_.require(groups.count * (kBytesPerLeaf + 2 * sizeof(ValueLeaf)));
    Entries e;
    e.count = e.slots = groups.count;
    e.slot = b_.template alloc<u32>(e.count);
    e.position = e.slot;
    e.state = b_.template alloc<u8>(e.count);
    e.treeKey = b_.template alloc<u64>(e.count);
    leafBegin_ = b_.template temp<u64>(e.count + 1);
    const u64* pairKey = pairKey_;
    u64* treeKeys = e.treeKey;
    u32* slots = e.slot;
    forGroups(
        b_, groups, leafBegin_, TETVDB_KERNEL(u64 group, u64 first) {
          treeKeys[group] = pairKey[first];
          slots[group] = static_cast<u32>(group);
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

  void rasterizeOwners(const Entries& e, const i32* values, u32 background, u64* masks, u32* table,
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
            // Each column belongs to one member. Tets are fetched together, since the team would
            // have to wait for each one.
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
            i32 value = static_cast<i32>(background);
            if (t != kNoTet) {
              value = valueOf(t);
              low = value < low ? value : low;
              high = value > high ? value : high;
            }
            table[entry * 512 + static_cast<u64>(i)] = static_cast<u32>(value);
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
  TetPlanes* prepared_ = nullptr;
  u64* pairKey_ = nullptr;
  u32* pairTet_ = nullptr;
  u64 pairCount_ = 0;
  u64* leafBegin_ = nullptr;
};

} // namespace tetvdb::nano
