// SPDX-License-Identifier: Apache-2.0
//
// Leaves from boundary faces: signed crossings along the z columns, added up from below.
// (face, 128 x 128 columns) -> (face, 8 x 8 columns) -> (face, leaf) pairs by count, scan and fill,
// sorted by leaf; a team walks up each column of leaves with the counts of its 64 columns. Of an
// open soup the triangles over its holes are counted beside, and where voxels have values
// (WindingLeaves.h) the count becomes the whole number nearest to the winding number, as in
// voxelize/BoundaryRaster.cpp.
#pragma once

#include "BoundaryFaces.h"
#include "WindingLeaves.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/FillRule.h"

namespace tetvdb::nano {

/// Leaf masks and the state at the leaf's top, by slot.
struct LeafMasks {
  u64* mask = nullptr; ///< eight words a slot: word x, bit 8 y + z
  u64* top = nullptr;  ///< bit 8 x + y
};

struct WriteLeafGap {
  u64* mask;
  TETVDB_HD void operator()(u64 slot, const u64* top) const {
    for (int x = 0; x < 8; ++x) {
      u64 word = 0;
      for (int y = 0; y < 8; ++y)
        if (*top >> (8 * x + y) & 1)
          word |= u64(0xFF) << (8 * y);
      mask[8 * slot + static_cast<u64>(x)] = word;
    }
  }
};

template <typename Backend>
struct GrowLeaves {
  Backend& b;
  LeafMasks& leaves;
  u64 made;
  WriteLeafGap operator()(u64 slots) const {
    leaves.mask = grown(b, leaves.mask, 8 * made, 8 * slots);
    return {leaves.mask};
  }
};

/// The lowest bits of the eight bytes of a word, as a byte.
TETVDB_HD inline u64 gatherBytes(u64 word) {
  return (word * 0x0102040810204080ull) >> 56;
}

/// Memory beside the buffer that a leaf takes until the tree is written.
constexpr u64 kBytesPerLeaf = 140;

struct WalkShared {
  static constexpr int kThreads = 256, kOccupancy = 32;
  i32 delta[512];        // signed crossings at a voxel: [8][64 columns], so that banks differ
  i32 count[64];         // the winding number below the leaf
  alignas(8) u8 run[64]; // the column's bits
  alignas(8) u8 inside[64];
};

/// The same where holes are filled.
struct OpenWalkShared : WalkShared {
  i32 overHoles[512]; // signed crossings of the triangles over holes
  i32 below[64];      // their sum
  i32 rest[64];       // what the crossings fall short of the count by
  u64 banded;         // the WindingLeaf, or kNotBanded
};
constexpr u64 kNotBanded = ~u64(0);

/// What pairs refer to: faces, then triangles over holes, then WindingLeafs.
struct PairedItems {
  const CrossedFace* columns;
  u64 faces, triangles; ///< faces; triangles of both kinds
  WindingValues winding;
};

/// What a team knows of a leaf's pairs before it adds their crossings.
template <typename Shared>
TETVDB_HD void beginLeaf(const Team&, Shared&) {}
TETVDB_HD inline void beginLeaf(const Team& team, OpenWalkShared& s) {
  for (int i = team.rank(); i < 512; i += team.size())
    s.overHoles[i] = 0;
  if (team.rank() == 0)
    s.banded = kNotBanded;
}

/// Where the crossings of a pair's triangle are added; null for a WindingLeaf.
TETVDB_HD inline i32* sumsOf(const PairedItems&, u32, WalkShared& s) {
  return s.delta;
}
TETVDB_HD inline i32* sumsOf(const PairedItems& items, u32 item, OpenWalkShared& s) {
  if (item < items.faces)
    return s.delta;
  if (item < items.triangles)
    return s.overHoles;
  s.banded = item - items.triangles;
  return nullptr;
}

template <typename Backend>
class FaceRasterizer {
public:
  FaceRasterizer(Backend& backend, const KeySpace& space, FillRule rule)
      : b_(backend), space_(space), rule_(rule) {}

  /// The leaves of `share` that faces cross. `leafBytes`: of one in the buffer to come. `holes`: of
  /// an open soup; else null.
  Entries run(const LatticePoint* points, const Face* faces, u64 faceCount, const HolesView* holes,
              const RootShare& share, u64 leafBytes, LeafMasks& leaves) {
    if (holes != nullptr) {
      b_.stage("winding");
      WindingLeaves<Backend> winding(b_, *holes, space_);
      items_.winding = winding.run(share);
      banded_ = winding.leaves();
      bandedCount_ = holes->leafCount;
    }
    b_.stage("pairs");
    const u64 holeCount = holes != nullptr ? holes->triangleCount : 0;
    if (faceCount + holeCount + bandedCount_ >= u64(1) << 32)
      throw Error(Status::Limit, "", "the mesh has 2^32 triangles or more", "split it in parts");
    prepare(points, faces, faceCount, holes, holeCount);
    items_ = {columns_, faceCount, faceCount + holeCount, items_.winding};
    pairs(faceCount + holeCount, share);
    b_.stage("walk");
    const Entries e = walk(leaves, leafBytes);
    b_.dropTemporaries();
    return e;
  }

  // Public for nvcc alone, as in LevelBuilder.

  void prepare(const LatticePoint* points, const Face* faces, u64 faceCount, const HolesView* holes,
               u64 holeCount) {
    columns_ = b_.template temp<CrossedFace>(faceCount + holeCount);
    CrossedFace* columns = columns_;
    if (holeCount != 0) {
      FillTriangle* triangles = b_.template temp<FillTriangle>(holeCount);
      b_.upload(triangles, holes->triangles, holeCount * sizeof(FillTriangle));
      b_.forEach(
          holeCount, TETVDB_KERNEL(u64 i) {
            const FillTriangle& t = triangles[i];
            columns[faceCount + i] = CrossedFace(t.a, t.b, t.c, t.weight);
          });
    }
    b_.forEach(
        faceCount, TETVDB_KERNEL(u64 i) {
          const Face f = faces[i];
          columns[i] = CrossedFace(points[f.a], points[f.b], points[f.c], f.weight);
        });
  }

  // Makes the sorted pairs: pairKey_, pairFace_, pairCount_.
  void pairs(u64 faceCount, const RootShare& share) {
    const CrossedFace* columns = columns_;
    const KeySpace space = space_;
    // Blocks of 128 x 128 columns in the face's box.
    u32* count = b_.template temp<u32>(faceCount + 1);
    u64* offset = b_.template temp<u64>(faceCount + 1);
    b_.forEach(
        faceCount + 1, TETVDB_KERNEL(u64 i) {
          if (i == faceCount || !columns[i].crosses) {
            count[i] = 0;
            return;
          }
          const CrossedFace& f = columns[i];
          count[i] = static_cast<u32>(((f.xMax >> 7) - (f.xMin >> 7) + 1) *
                                      ((f.yMax >> 7) - (f.yMin >> 7) + 1));
        });
    b_.scan(count, offset, faceCount);
    const u64 blocks = b_.read(offset + faceCount);
    // Columns of leaves in the part of the box that lies in a block.
    u32* blockFace = b_.template temp<u32>(blocks);
    u32* leafColumns = b_.template temp<u32>(blocks + 1);
    u64* columnOffset = b_.template temp<u64>(blocks + 1);
    b_.forEach(
        blocks + 1, TETVDB_KERNEL(u64 i) {
          leafColumns[i] = 0;
          if (i == blocks)
            return;
          const u64 face = ownerOf(offset, faceCount, i);
          blockFace[i] = static_cast<u32>(face);
          const CrossedFace& f = columns[face];
          i32 box[4];
          blockBox(f, i - offset[face], box);
          i64 low, high;
          const Place place{static_cast<u64>((box[0] >> 3) - space.base[0]),
                            static_cast<u64>((box[2] >> 3) - space.base[1]), 0};
          if (share.has(space, 0, place) && f.range(box[0], box[1], box[2], box[3], low, high))
            leafColumns[i] = static_cast<u32>(((box[1] >> 3) - (box[0] >> 3) + 1) *
                                              ((box[3] >> 3) - (box[2] >> 3) + 1));
        });
    b_.scan(leafColumns, columnOffset, blocks);
    const u64 candidates = b_.read(columnOffset + blocks);
    b_.require(candidates * (2 * sizeof(u32) + 2 * sizeof(u64)));
    // Leaves of each of these.
    u32* leafCount = b_.template temp<u32>(candidates + 1);
    u64* pairOffset = b_.template temp<u64>(candidates + 1);
    u64* firstKey = b_.template temp<u64>(candidates);
    u32* candidateFace = b_.template temp<u32>(candidates);
    b_.forEach(
        candidates + 1, TETVDB_KERNEL(u64 i) {
          leafCount[i] = 0;
          if (i == candidates)
            return;
          const u64 block = ownerOf(columnOffset, blocks, i);
          const u64 face = blockFace[block];
          const CrossedFace& f = columns[face];
          i32 box[4];
          blockBox(f, block - offset[face], box);
          const u64 k = i - columnOffset[block];
          const u64 rows = static_cast<u64>((box[3] >> 3) - (box[2] >> 3) + 1);
          const i64 x = (box[0] >> 3) + static_cast<i64>(k / rows);
          const i64 y = (box[2] >> 3) + static_cast<i64>(k % rows);
          i64 low, high;
          candidateFace[i] = static_cast<u32>(face);
          firstKey[i] = 0;
          if (!f.range(x * 8, x * 8 + 7, y * 8, y * 8 + 7, low, high))
            return;
          low >>= 3;
          high >>= 3;
          leafCount[i] = static_cast<u32>(high - low + 1);
          firstKey[i] =
              columnKey(space, 0,
                        {static_cast<u64>(x - space.base[0]), static_cast<u64>(y - space.base[1]),
                         static_cast<u64>(low - space.base[2])});
        });
    b_.scan(leafCount, pairOffset, candidates);
    const u64 facePairs = b_.read(pairOffset + candidates);
    pairCount_ = facePairs + countBanded();
    // Twice, since sorting takes from one place to another.
    b_.require(2 * pairCount_ * (sizeof(u64) + sizeof(u32)));
    pairKey_ = b_.template temp<u64>(pairCount_);
    pairFace_ = b_.template temp<u32>(pairCount_);
    u64* pairKey = pairKey_;
    u32* pairFace = pairFace_;
    b_.forEach(
        candidates, TETVDB_KERNEL(u64 i) {
          for (u32 k = 0; k < leafCount[i]; ++k) {
            pairKey[pairOffset[i] + k] = firstKey[i] + k;
            pairFace[pairOffset[i] + k] = candidateFace[i];
          }
        });
    placeBanded(facePairs);
    b_.sort(pairKey_, pairFace_, pairCount_, space_.total());
  }

  // The leaves that have values, which all lie in the share.
  u64 countBanded() {
    if (bandedCount_ == 0)
      return 0;
    const u64 count = bandedCount_;
    const WindingValues winding = items_.winding;
    u32* has = b_.template temp<u32>(count + 1);
    bandedOffset_ = b_.template temp<u64>(count + 1);
    b_.forEach(
        count + 1, TETVDB_KERNEL(u64 i) { has[i] = i < count && winding.octants[i] != 0; });
    b_.scan(has, bandedOffset_, count);
    return b_.read(bandedOffset_ + count);
  }
  void placeBanded(u64 first) {
    const u64* offset = bandedOffset_;
    u64* pairKey = pairKey_ + first;
    u32* pairFace = pairFace_ + first;
    const u32 number = static_cast<u32>(items_.triangles);
    const WindingLeaf* banded = banded_;
    const KeySpace space = space_;
    b_.forEach(
        bandedCount_, TETVDB_KERNEL(u64 i) {
          if (offset[i + 1] == offset[i])
            return;
          pairKey[offset[i]] =
              columnKey(space, 0, WindingLeaves<Backend>::placeOf(space, banded[i]));
          pairFace[offset[i]] = number + static_cast<u32>(i);
        });
  }

  // Box (x0, x1, y0, y1, inclusive) of the columns of a face in its k-th block.
  TETVDB_HD static void blockBox(const CrossedFace& f, u64 k, i32 (&box)[4]) {
    const u64 rows = static_cast<u64>((f.yMax >> 7) - (f.yMin >> 7) + 1);
    const i32 x = (f.xMin >> 7) + static_cast<i32>(k / rows);
    const i32 y = (f.yMin >> 7) + static_cast<i32>(k % rows);
    box[0] = x * 128 > f.xMin ? x * 128 : f.xMin;
    box[1] = x * 128 + 127 < f.xMax ? x * 128 + 127 : f.xMax;
    box[2] = y * 128 > f.yMin ? y * 128 : f.yMin;
    box[3] = y * 128 + 127 < f.yMax ? y * 128 + 127 : f.yMax;
  }

  Entries walk(LeafMasks& leaves, u64 leafBytes) {
    const Groups groups = groupsOf(b_, pairKey_, pairCount_, 0);
    // Masks, keys in two orders, states and numbers, and at last the leaf itself: at least so much.
    b_.require(groups.count * (kBytesPerLeaf + leafBytes));
    Entries e;
    e.count = e.slots = groups.count;
    e.key = b_.template alloc<u64>(e.count);
    e.slot = b_.template alloc<u32>(e.count);
    e.state = b_.template alloc<u8>(e.count);
    u64* begin = b_.template temp<u64>(e.count + 1);
    const u64* pairKey = pairKey_;
    u64* keys = e.key;
    u32* slots = e.slot;
    forGroups(
        b_, groups, begin, TETVDB_KERNEL(u64 leaf, u64 first) {
          keys[leaf] = pairKey[first];
          slots[leaf] = static_cast<u32>(leaf);
        });
    const Groups columns = groupsOf(b_, e.key, e.count, heightBits(space_, 0));
    u64* columnBegin = b_.template temp<u64>(columns.count + 1);
    forGroups(b_, columns, columnBegin, TETVDB_KERNEL(u64, u64){});
    const u64 leafCount = e.count, columnCount = columns.count;
    leaves.mask = b_.template alloc<u64>(8 * leafCount);
    leaves.top = b_.template alloc<u64>(leafCount);
    // Many faces a column: a larger team shares them.
    const int teamSize = pairCount_ > 128 * columnCount ? 256 : 32;
    if (items_.triangles > items_.faces)
      rasterizeColumns<OpenWalkShared>(columnBegin, columnCount, begin, e, leaves, teamSize);
    else
      rasterizeColumns<WalkShared>(columnBegin, columnCount, begin, e, leaves, teamSize);
    return e;
  }

  template <typename Shared>
  void rasterizeColumns(const u64* columnBegin, u64 columnCount, const u64* begin, Entries& e,
                        const LeafMasks& leaves, int teamSize) {
    const PairedItems items = items_;
    const u32* pairFace = pairFace_;
    const u64* keys = e.key;
    u8* states = e.state;
    u64 *masks = leaves.mask, *tops = leaves.top;
    const KeySpace space = space_;
    const FillRule rule = rule_;
    b_.template forTeams<Shared>(
        columnCount, teamSize, TETVDB_KERNEL(const Team& team, u64 column, Shared& s) {
          for (int c = team.rank(); c < 64; c += team.size())
            clearColumn(s, c);
          const u64 first = columnBegin[column], end = columnBegin[column + 1];
          for (u64 leaf = first; leaf < end; ++leaf) {
            for (int i = team.rank(); i < 512; i += team.size())
              s.delta[i] = 0;
            beginLeaf(team, s);
            team.sync();
            i32 origin[3];
            originOf(space, 0, placeOfColumnKey(space, 0, keys[leaf]), origin);
            const u64 pairBegin = begin[leaf], pairEnd = begin[leaf + 1];
            if (pairEnd - pairBegin <= 8) {
              for (u64 k = pairBegin; k < pairEnd; ++k) {
                i32* const sums = sumsOf(items, pairFace[k], s);
                if (sums == nullptr)
                  continue;
                const CrossedFace& f = items.columns[pairFace[k]];
                const bool whole = coversLeaf(f, origin);
                for (int c = team.rank(); c < 64; c += team.size())
                  addCrossing(f, origin, c >> 3, c & 7, whole, sums);
              }
            } else {
              for (u64 k = pairBegin + static_cast<u64>(team.rank()); k < pairEnd;
                   k += static_cast<u64>(team.size())) {
                i32* const sums = sumsOf(items, pairFace[k], s);
                if (sums == nullptr)
                  continue;
                const CrossedFace& f = items.columns[pairFace[k]];
                const i32 xLow = f.xMin - origin[0], xHigh = f.xMax - origin[0];
                const i32 yLow = f.yMin - origin[1], yHigh = f.yMax - origin[1];
                for (int x = xLow > 0 ? xLow : 0; x <= (xHigh < 7 ? xHigh : 7); ++x)
                  for (int y = yLow > 0 ? yLow : 0; y <= (yHigh < 7 ? yHigh : 7); ++y)
                    addCrossing(f, origin, x, y, false, sums);
              }
            }
            team.sync();
            for (int c = team.rank(); c < 64; c += team.size()) {
              i32 count = s.count[c];
              u32 run = 0;
              for (int z = 0; z < 8; ++z) {
                count += s.delta[z * 64 + c];
                correct(items, s, c, z, count);
                run |= u32(isInside(count, rule)) << z;
              }
              s.count[c] = count;
              s.run[c] = static_cast<u8>(run);
              s.inside[c] = isInside(count, rule);
            }
            team.sync();
            // Eight columns' bytes are a mask's word.
            for (int x = team.rank(); x < 8; x += team.size())
              masks[8 * leaf + static_cast<u64>(x)] = reinterpret_cast<const u64*>(s.run)[x];
            if (team.rank() == 0) {
              u64 top = 0, any = 0, all = ~u64(0);
              for (int x = 0; x < 8; ++x) {
                const u64 word = reinterpret_cast<const u64*>(s.run)[x];
                any |= word;
                all &= word;
                top |= gatherBytes(reinterpret_cast<const u64*>(s.inside)[x]) << (8 * x);
              }
              tops[leaf] = top;
              states[leaf] = any == 0 ? kEmpty : all == ~u64(0) ? kFull : kNode;
            }
            team.sync();
          }
        });
  }

  // A column's sums below the lowest leaf.
  TETVDB_HD static void clearColumn(WalkShared& s, int c) { s.count[c] = 0; }
  TETVDB_HD static void clearColumn(OpenWalkShared& s, int c) {
    s.count[c] = s.below[c] = s.rest[c] = 0;
  }

  // Makes the count at a voxel of column c, whose crossings were added, the whole number nearest to
  // the winding number; z ascends.
  TETVDB_HD static void correct(const PairedItems&, WalkShared&, int, int, i32&) {}
  TETVDB_HD static void correct(const PairedItems& items, OpenWalkShared& s, int c, int z,
                                i32& count) {
    s.below[c] += s.overHoles[z * 64 + c];
    const double* value =
        s.banded == kNotBanded ? nullptr : items.winding.at(s.banded, c >> 3, c & 7, z);
    if (value == nullptr)
      return;
    const i32 crossings = count - s.rest[c];
    s.rest[c] = nearestWinding(crossings - s.below[c] + *value) - crossings;
    count = crossings + s.rest[c];
  }

  // Whether all columns of a leaf are certainly inside the face seen along z.
  TETVDB_HD static bool coversLeaf(const CrossedFace& f, const i32 (&origin)[3]) {
    if (origin[0] < f.xMin || origin[0] + 7 > f.xMax || origin[1] < f.yMin ||
        origin[1] + 7 > f.yMax)
      return false;
    for (int k = 0; k < 3; ++k) {
      const LatticePoint& p = f.p[k];
      const LatticePoint& q = f.p[k == 2 ? 0 : k + 1];
      const double b = q.x - p.x, d = q.y - p.y;
      const double x = static_cast<double>(origin[0] + (d > 0 ? 7 : 0)) * kUnits - p.x,
                   y = static_cast<double>(origin[1] + (b > 0 ? 0 : 7)) * kUnits - p.y;
      const double left = b * y, right = d * x;
      if (!(left - right > (absolute(left) + absolute(right)) * 0x1p-51))
        return false;
    }
    return true;
  }

  TETVDB_HD static void addCrossing(const CrossedFace& f, const i32 (&origin)[3], int x, int y,
                                    bool inside, i32* delta) {
    const i64 vx = i64(origin[0]) + x, vy = i64(origin[1]) + y;
    if (!inside &&
        (vx < f.xMin || vx > f.xMax || vy < f.yMin || vy > f.yMax || !crossesColumn(f, vx, vy)))
      return;
    const i64 z = crossingFrom(f, vx, vy, origin[2], 8);
    if (z >= 0 && z < 8)
      addTo(&delta[static_cast<int>(z) * 64 + x * 8 + y], f.weight);
  }

private:
  Backend& b_;
  KeySpace space_;
  FillRule rule_;
  CrossedFace* columns_ = nullptr;
  PairedItems items_{};
  const WindingLeaf* banded_ = nullptr; // with or without values
  u64 bandedCount_ = 0;
  u64* bandedOffset_ = nullptr;
  u64* pairKey_ = nullptr;
  u32* pairFace_ = nullptr;
  u64 pairCount_ = 0;
};

} // namespace tetvdb::nano
