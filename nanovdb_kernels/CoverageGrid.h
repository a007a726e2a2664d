// SPDX-License-Identifier: Apache-2.0
//
// The coverage of closed faces as a NanoVDB buffer, on any backend: volumes cut off by faces, slab
// by slab -> what is carried up each column -> leaves -> the nodes above them. As fields/Coverage.h
// on the CPU.
#pragma once

#include "BuildLevels.h"
#include "DeviceVoxelizer.h"
#include "SlabVolumes.h"
#include "SummarizeLeaf.h"
#include "WriteGrid.h"
#include "tetvdb/geometry/Exact.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace tetvdb::nano {

/// Sums over leaves; volumes as in SlabVolume.h, in two numbers of which the second counts 2^32.
struct CoverageTotals {
  u64 filled[2], overlap[2]; ///< the first: of leaves that are nodes
  u64 overlapVoxels;
  u64 active; ///< voxels of leaves that are nodes
};

struct ShareShared : SharedLeaf<u32> {
  static constexpr int kThreads = 64, kOccupancy = 16;
  i64 volume[512];
  u64 filled, overlap[2], overlapVoxels;
  u32 some, notFull;
};

/// Arrays of leaves, by slot.
struct ShareLeaves {
  u32* value = nullptr; ///< bits, 512 a leaf
  u64* mask = nullptr;  ///< eight words a leaf
  LeafSummary* summary = nullptr;
  u8* state = nullptr;
};

/// The leaf of `slot`, whose columns have `below` under them and `sums` of faces; null: no face
/// meets it.
TETVDB_HD inline void makeShares(const Team& team, ShareShared& s, const i64* sums,
                                 const i64* below, const ShareLeaves& to, u64 slot,
                                 CoverageTotals* totals) {
  if (team.rank() == 0) {
    s.extremes.clear();
    s.filled = s.overlap[0] = s.overlap[1] = s.overlapVoxels = 0;
    s.some = s.notFull = 0;
  }
  for (int w = team.rank(); w < 8; w += team.size())
    s.active[w] = 0;
  for (int c = team.rank(); c < kColumnsInLeaf; c += team.size()) {
    i64 carry = below[c];
    sumColumn(sums == nullptr ? nullptr : sums + c * kLeafSize, carry, s.volume + c * kLeafSize);
  }
  team.sync();
  u64 filled = 0;
  bool some = false, notFull = false;
  for (int i = team.rank(); i < 512; i += team.size()) {
    i64 volume = s.volume[i];
    if (volume > kWholeVolume) {
      const u64 more = static_cast<u64>(volume - kWholeVolume);
      addTo(&s.overlap[0], more & 0xFFFFFFFFu);
      addTo(&s.overlap[1], more >> 32);
      addTo(&s.overlapVoxels, u64(1));
      volume = kWholeVolume;
    }
    volume = volume < 0 ? 0 : volume;
    s.volume[i] = volume;
    s.value[i] = bitsOf(volume == 0 ? 0.0F : 1.0F);
    filled += static_cast<u64>(volume);
    some = some || volume != 0;
    notFull = notFull || volume != kWholeVolume;
    if (volume != 0)
      orInto(&s.active[i >> 6], u64(1) << (i & 63));
  }
  if (filled != 0)
    addTo(&s.filled, filled);
  if (some)
    orInto(&s.some, 1u);
  if (notFull)
    orInto(&s.notFull, 1u);
  team.sync();
  const bool isNode = s.some != 0 && s.notFull != 0;
  if (team.rank() == 0) {
    to.state[slot] = isNode ? kNode : s.some != 0 ? kFull : kEmpty;
    if (s.overlapVoxels != 0) {
      addTo(&totals->overlap[0], s.overlap[0] & 0xFFFFFFFFu);
      addTo(&totals->overlap[1], s.overlap[1] + (s.overlap[0] >> 32));
      addTo(&totals->overlapVoxels, s.overlapVoxels);
    }
    if (isNode) {
      addTo(&totals->filled[0], s.filled & 0xFFFFFFFFu);
      addTo(&totals->filled[1], s.filled >> 32);
      addTo(&totals->active, countVoxels(s.active));
      ShareRounding rounded;
      for (int i = 0; i < 512; ++i)
        if (s.volume[i] != 0 && s.volume[i] != kWholeVolume)
          s.value[i] = bitsOf(rounded(s.volume[i]));
    }
  }
  team.sync();
  if (!isNode)
    return;
  Extremes<u32> extremes;
  for (int i = team.rank(); i < 512; i += team.size()) {
    if ((s.active[i >> 6] >> (i & 63) & 1) != 0)
      extremes.add(s.value[i], s.value[i], static_cast<u32>(i), true);
    to.value[512 * slot + static_cast<u64>(i)] = s.value[i];
  }
  s.extremes.join(extremes);
  for (int w = team.rank(); w < 8; w += team.size())
    to.mask[8 * slot + static_cast<u64>(w)] = s.active[w];
  team.sync();
  LeafSummary summary;
  summarize(team, s, true, summary);
  if (team.rank() == 0)
    to.summary[slot] = summary;
  team.sync();
}

/// The source of a leaf in a gap is that of the leaf below the gap.
struct WriteShareGap {
  u64* source;
  const u64* tops;
  TETVDB_HD void operator()(u64 slot, const u64* top) const { source[slot] = source[top - tops]; }
};

template <typename Backend>
struct GrowShares {
  Backend& b;
  u64*& source;
  const u64* tops;
  u64 made;
  WriteShareGap operator()(u64 slots) const {
    source = grown(b, source, made, slots);
    return {source, tops};
  }
};

template <typename Backend>
class CoverageGrid {
public:
  /// `place` as for SlabVolumes.
  template <typename Place>
  CoverageGrid(Backend& backend, const CoverageJob& job, const Place& place)
      : b_(backend), job_(job), volumes_(backend, job, place) {}

  /// The buffer is the backend's memory.
  Result run() {
    b_.stage("volumes");
    chooseSpace();
    totals_ = b_.template alloc<CoverageTotals>(1);
    b_.zero(totals_, sizeof *totals_);
    errors_ = b_.template alloc<u32>(1);
    b_.zero(errors_, sizeof *errors_);
    makeBatches();
    if (b_.read(errors_) != 0)
      throw std::logic_error("the boundary does not close: volume was carried out of it");
    const Result result = write();
    b_.stage("");
    return result;
  }

  // Public only because of nvcc, as in LevelBuilder.

  // Leaves of a batch that are not alike all over without a face that meets them.
  struct Made {
    u64 count = 0;
    ShareLeaves leaves;
    u64 *key = nullptr, *source = nullptr, *top = nullptr;
  };

  void chooseSpace() {
    i64 low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    for (u64 slab = 0; slab < job_.slabCount; ++slab) {
      const FaceInSlab& at = job_.pairs[job_.starts[slab]];
      const i64 first[3] = {at.x, i64(at.y) * 16, i64(at.z) * 16};
      for (int k = 0; k < 3; ++k) {
        const i64 last = first[k] + (k == 0 ? 0 : 15);
        low[k] = slab == 0 ? first[k] : std::min(low[k], first[k]);
        high[k] = slab == 0 ? last : std::max(high[k], last);
      }
    }
    space_ = spaceAround(low, high);
  }

  void makeBatches() {
    constexpr u64 kBatch = SlabVolumes<Backend>::kBatchSlabs;
    const u64 all = job_.slabCount, slabs = std::min(all, kBatch);
    if (all == 0)
      return;
    b_.require(all * kColumnsInSlab * sizeof(i64));
    above_ = b_.template alloc<i64>(all * kColumnsInSlab);
    below_ = b_.template alloc<i64>(slabs * kLeavesInSlab * kColumnsInLeaf);
    volumes_.begin();
    for (u64 first = 0; first < all; first += kBatch) {
      const u64 count = std::min(kBatch, all - first);
      b_.stage("volumes");
      volumes_.sum(first, count);
      b_.stage("leaves");
      carryUp(first, count);
      makeLeaves(first, count);
      b_.dropTemporaries();
    }
  }

  /// Whether a slab is the lowest of those at its x and y.
  TETVDB_HD static bool isLowest(const FaceInSlab* pairs, const u64* starts, u64 slab) {
    return slab == 0 || !pairs[starts[slab]].sameStack(pairs[starts[slab - 1]]);
  }

  // What is below each leaf of the slabs, and above each slab: nothing above the last at an x and
  // y.
  void carryUp(u64 first, u64 slabs) {
    const FaceInSlab* pairs = volumes_.pairs();
    const u64 *starts = volumes_.starts(), all = job_.slabCount;
    const u32* met = volumes_.met();
    const i64* sums = volumes_.sums();
    i64 *below = below_, *above = above_;
    u32* errors = errors_;
    b_.forEach(
        slabs * kColumnsInSlab, TETVDB_KERNEL(u64 i) {
          const u64 head = i / kColumnsInSlab, column = i % kColumnsInSlab;
          const bool lowest = isLowest(pairs, starts, first + head);
          if (head > 0 && !lowest)
            return; // a thread that began below does it
          const u64 c = column % kColumnsInLeaf;
          i64 carry = lowest ? 0 : above[(first + head - 1) * kColumnsInSlab + column];
          for (u64 slab = head;
               slab < slabs && (slab == head || !isLowest(pairs, starts, first + slab)); ++slab) {
            for (u64 z = 0; z < kNodeSize / kLeafSize; ++z) {
              const u64 leaf = slab * kLeavesInSlab + column / kColumnsInLeaf * 16 + z;
              below[leaf * kColumnsInLeaf + c] = carry;
              i64 unused[kLeafSize];
              if (met[leaf] != 0)
                sumColumn(sums + leaf * kSumsOfLeaf + c * kLeafSize, carry, unused);
            }
            if (first + slab + 1 == all || isLowest(pairs, starts, first + slab + 1)) {
              if (carry <= -kOpenVolume || carry >= kOpenVolume)
                orInto(errors, u32(kNotClosed));
              carry = 0;
            }
            above[(first + slab) * kColumnsInSlab + column] = carry;
          }
        });
  }

  /// 0 where columns have nothing below them, all bits where all are inside; else another number.
  TETVDB_HD static u64 topOf(const i64* columns) {
    bool none = true, whole = true;
    for (int c = 0; c < kColumnsInLeaf; ++c) {
      none = none && columns[c] == 0;
      whole = whole && columns[c] == kWholeVolume;
    }
    return none ? 0 : whole ? ~u64(0) : 1;
  }

  void makeLeaves(u64 first, u64 slabs) {
    const u64 entries = slabs * kLeavesInSlab;
    const u32* met = volumes_.met();
    const i64 *below = below_, *above = above_, *sums = volumes_.sums();
    u64* tops = b_.template temp<u64>(entries); // of what is below
    u32* listed = b_.template temp<u32>(entries + 1);
    u64* place = b_.template temp<u64>(entries + 1);
    b_.forEach(
        entries, TETVDB_KERNEL(u64 i) {
          tops[i] = topOf(below + i * kColumnsInLeaf);
          listed[i] = met[i] != 0 || tops[i] == 1 ? 1u : 0u;
        });
    b_.scan(listed, place, entries);
    Made made;
    made.count = b_.read(place + entries);
    if (made.count == 0)
      return;
    made.leaves = newLeaves(made.count);
    made.key = b_.template alloc<u64>(made.count);
    made.source = b_.template alloc<u64>(made.count);
    made.top = b_.template alloc<u64>(made.count);
    const KeySpace space = space_;
    const FaceInSlab* pairs = volumes_.pairs();
    const u64* starts = volumes_.starts();
    CoverageTotals* totals = totals_;
    b_.forEach(
        entries, TETVDB_KERNEL(u64 i) {
          if (listed[i] == 0)
            return;
          const u64 leaf = i % kLeavesInSlab, slab = first + i / kLeavesInSlab, slot = place[i];
          const FaceInSlab at = pairs[starts[slab]];
          made.key[slot] =
              columnKey(space, 0,
                        {static_cast<u64>(at.x - space.base[0]),
                         static_cast<u64>(i64(at.y) * 16 - space.base[1]) + leaf / 16,
                         static_cast<u64>(i64(at.z) * 16 - space.base[2]) + leaf % 16});
          made.source[slot] = slab * kColumnsInSlab + leaf / 16 * kColumnsInLeaf;
          made.top[slot] = leaf % 16 < 15 ? tops[i + 1] : topOf(above + made.source[slot]);
        });
    b_.template forTeams<ShareShared>(
        entries, ShareShared::kThreads, TETVDB_KERNEL(const Team& team, u64 i, ShareShared& s) {
          if (listed[i] == 0)
            return;
          makeShares(team, s, met[i] == 0 ? nullptr : sums + i * kSumsOfLeaf,
                     below + i * kColumnsInLeaf, made.leaves, place[i], totals);
        });
    made_.push_back(made);
  }

  ShareLeaves newLeaves(u64 count) {
    b_.require(count * (512 * sizeof(u32) + 8 * sizeof(u64) + sizeof(LeafSummary)));
    return {b_.template alloc<u32>(512 * count), b_.template alloc<u64>(8 * count),
            b_.template alloc<LeafSummary>(count), b_.template alloc<u8>(count)};
  }

  // All batches' arrays behind one another.
  template <typename T>
  void join(T* to, T* Made::*array, u64 perLeaf = 1) {
    for (const Made& made : made_)
      to = copyBehind(to, made.*array, made.count * perLeaf);
  }
  template <typename T>
  void join(T* to, T* ShareLeaves::*array, u64 perLeaf = 1) {
    for (const Made& made : made_)
      to = copyBehind(to, made.leaves.*array, made.count * perLeaf);
  }
  template <typename T>
  T* copyBehind(T* to, const T* from, u64 count) {
    b_.forEach(
        count, TETVDB_KERNEL(u64 i) { to[i] = from[i]; });
    return to + count;
  }

  Result write() {
    b_.stage("levels");
    u64 count = 0;
    for (const Made& made : made_)
      count += made.count;
    checkCount(count);
    Entries leaves;
    leaves.count = leaves.slots = count;
    leaves.key = b_.template alloc<u64>(count);
    leaves.slot = b_.template alloc<u32>(count);
    leaves.state = b_.template alloc<u8>(count);
    u64* tops = b_.template alloc<u64>(count);
    source_ = b_.template alloc<u64>(count);
    join(leaves.key, &Made::key);
    join(leaves.state, &ShareLeaves::state);
    join(tops, &Made::top);
    join(source_, &Made::source);
    u32* slots = leaves.slot;
    b_.forEach(
        count, TETVDB_KERNEL(u64 i) { slots[i] = static_cast<u32>(i); });
    b_.sort(leaves.key, leaves.slot, count, space_.total());
    LevelBuilder<Backend> levels(b_, space_, true, true, errors_);
    levels.template closeGaps<1>(0, leaves, tops, GrowShares<Backend>{b_, source_, tops, count});
    const ShareLeaves all = fillGaps(leaves, count);
    const InternalNodes nodes = levels.nodesAbove(leaves);
    if (b_.read(errors_) != 0)
      throw std::logic_error("the boundary does not close: a column of leaves has no end");

    b_.stage("tree");
    GridValues values{bitsOf(1.0F), 0};
    values.variedLeaves = true;
    GridWriter<Backend> writer(b_, space_, Kind::Float, values);
    const NodeCounts counts = writer.number(leaves, nodes.lowers, nodes.uppers);
    const BufferLayout layout = layoutOf(Kind::Float, counts);
    u8* buffer = b_.output(layout.size);
    writer.writeTree(buffer, layout, leaves, LeafMasks{all.mask, nullptr}, all.value, all.summary,
                     nodes);
    writer.writeHead(buffer, layout,
                     gridHeader(Kind::Float, nanovdb::GridClass::FogVolume, job_.name,
                                job_.voxelSize, job_.origin),
                     writer.roots());
    Result result;
    result.bytes = buffer;
    result.counts = countsOf(counts, layout.size, buffer);
    return result;
  }

  // Values of all leaves, also of those that fill gaps.
  ShareLeaves fillGaps(Entries& leaves, u64 made) {
    b_.stage("leaves");
    ShareLeaves all = newLeaves(leaves.slots);
    join(all.value, &ShareLeaves::value, 512);
    join(all.mask, &ShareLeaves::mask, 8);
    join(all.summary, &ShareLeaves::summary);
    all.state = leaves.state;
    const u64* source = source_;
    const i64* above = above_;
    CoverageTotals* totals = totals_;
    b_.template forTeams<ShareShared>(
        leaves.slots - made, ShareShared::kThreads,
        TETVDB_KERNEL(const Team& team, u64 i, ShareShared& s) {
          makeShares(team, s, nullptr, above + source[made + i], all, made + i, totals);
        });
    b_.stage("levels");
    return all;
  }

  Counts countsOf(const NodeCounts& nodes, u64 bytes, const u8* buffer) {
    const auto* tree = reinterpret_cast<const TreeData*>(buffer + sizeof(nanovdb::GridData));
    const CoverageTotals sums = b_.read(totals_);
    const u64 active = b_.read(reinterpret_cast<const u64*>(&tree->mVoxelCount));
    const auto volume = [](const u64(&parts)[2]) {
      return (Int128(parts[1]) << 32) + Int128(parts[0]);
    };
    constexpr auto whole = static_cast<double>(kWholeVolume);
    Counts counts;
    counts.boundaryFaces = job_.faceCount;
    counts.leaves = nodes.leaves;
    counts.lowerNodes = nodes.lowers;
    counts.upperNodes = nodes.uppers;
    counts.rootTiles = nodes.rootTiles - nodes.uppers;
    counts.bufferBytes = bytes;
    counts.coverage.filled =
        static_cast<double>(volume(sums.filled) + Int128(active - sums.active) * kWholeVolume) /
        whole;
    counts.coverage.overlap = static_cast<double>(volume(sums.overlap)) / whole;
    counts.coverage.overlapVoxels = sums.overlapVoxels;
    return counts;
  }

private:
  Backend& b_;
  const CoverageJob& job_;
  SlabVolumes<Backend> volumes_;
  KeySpace space_{};
  i64 *below_ = nullptr, *above_ = nullptr; // by leaf of a batch; by slab
  std::vector<Made> made_;
  u64* source_ = nullptr; // by slot: where what is above its leaf's slab begins, of its columns
  CoverageTotals* totals_ = nullptr;
  u32* errors_ = nullptr;
};

} // namespace tetvdb::nano
