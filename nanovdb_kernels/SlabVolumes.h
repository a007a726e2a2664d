// SPDX-License-Identifier: Apache-2.0
//
// Volumes that faces cut off the cubes of voxels: a thread for every layer x of a (face, slab) pair
// adds to dense arrays of a batch of slabs; leaves that were met go to the host. Sums are of
// integers, so that order does not matter.
#pragma once

#include "CoverageJob.h"
#include "Team.h"

#include <algorithm>
#include <vector>

namespace tetvdb::nano {

struct GatherShared {
  static constexpr int kThreads = 128, kOccupancy = 64;
};

template <typename Backend>
class SlabVolumes {
public:
  // 128 MB of sums.
  static constexpr u64 kBatchSlabs = 64;

  /// `place`(host, bytes) returns the address of a copy where the backend computes.
  template <typename Place>
  SlabVolumes(Backend& backend, const CoverageJob& job, const Place& place)
      : b_(backend), job_(job) {
    points_ = static_cast<const Vec3d*>(place(job.points, job.pointCount * sizeof(Vec3d)));
    faces_ = static_cast<const u32*>(place(job.faces, job.faceCount * 4 * sizeof(u32)));
    const u64 pairs = job.starts[job.slabCount];
    pairs_ = static_cast<const FaceInSlab*>(place(job.pairs, pairs * sizeof(FaceInSlab)));
    starts_ = static_cast<const u64*>(place(job.starts, (job.slabCount + 1) * sizeof(u64)));
  }

  /// The next batch is computed while the receiver works. Returns the number of leaves.
  u64 run(CoverageReceiver& receiver) {
    const u64 batches = (job_.slabCount + kBatchSlabs - 1) / kBatchSlabs;
    const u64 slabs = std::min(job_.slabCount, kBatchSlabs);
    b_.require(slabs * kLeavesInSlab * 2 * kSumsOfLeaf * sizeof(i64));
    sums_ = b_.template alloc<i64>(slabs * kLeavesInSlab * kSumsOfLeaf);
    met_ = b_.template alloc<u32>(slabs * kLeavesInSlab + 1);
    offset_ = b_.template alloc<u64>(slabs * kLeavesInSlab + 1);
    list_ = b_.template alloc<u32>(slabs * kLeavesInSlab);
    u64 leaves = 0;
    for (u64 n = 0; n < batches; ++n) {
      leaves += launch(n);
      if (n > 0)
        hand(n - 1, receiver);
    }
    if (batches > 0)
      hand(batches - 1, receiver);
    b_.stage("");
    return leaves;
  }

  // Public for nvcc alone, as in LevelBuilder.

  u64 launch(u64 batch) {
    b_.stage("volumes");
    b_.dropTemporaries();
    const u64 first = batch * kBatchSlabs, slabs = slabsOf(batch), entries = slabs * kLeavesInSlab;
    b_.zero(sums_, entries * kSumsOfLeaf * sizeof(i64));
    b_.zero(met_, (entries + 1) * sizeof(u32));
    add(first, slabs);
    b_.stage("leaves");
    b_.scan(met_, offset_, entries);
    const u64 leaves = b_.read(offset_ + entries);
    Landing& landing = landings_[batch % 2];
    if (landing.size < leaves) {
      landing.size = std::min(slabs * kLeavesInSlab, leaves + leaves / 2);
      landing.out = b_.template alloc<i64>(landing.size * kSumsOfLeaf);
    }
    gather(entries, landing.out);
    landing.leaves.resize(leaves);
    numbers_.resize(leaves);
    b_.download(numbers_.data(), list_, leaves);
    landing.starts.assign(slabs + 1, leaves);
    u64 slab = 0;
    for (u64 i = 0; i < leaves; ++i) {
      for (; slab <= numbers_[i] / kLeavesInSlab; ++slab)
        landing.starts[slab] = i;
      landing.leaves[i] = static_cast<u16>(numbers_[i] % kLeavesInSlab);
    }
    if (leaves > 0)
      b_.land(static_cast<int>(batch % 2), reinterpret_cast<const u8*>(landing.out),
              leaves * kSumsOfLeaf * sizeof(i64));
    return leaves;
  }

  void add(u64 first, u64 slabs) {
    const Vec3d* points = points_;
    const u32* faces = faces_;
    const FaceInSlab* pairs = pairs_;
    const u64* starts = starts_ + first;
    const u64 begin = job_.starts[first], end = job_.starts[first + slabs];
    i64* sums = sums_;
    u32* met = met_;
    b_.forEach((end - begin) * kLeafSize, TETVDB_KERNEL(u64 i) {
      const u64 pair = begin + i / kLeafSize;
      const int layer = static_cast<int>(i % kLeafSize);
      const FaceInSlab at = pairs[pair];
      const u32* const f = faces + 4 * u64(at.face);
      double sign;
      const Polygon polygon =
          polygonInSlab(points[f[0]], points[f[1]], points[f[2]], static_cast<i32>(f[3]), at, sign);
      if (polygon.high(0) < layer || polygon.low(0) > layer + 1)
        return;
      const u64 leaves = ownerOf(starts, slabs, pair) * kLeavesInSlab;
      // All layers are cut off, so that each is what the one thread of the CPU has.
      cutAlong(polygon, 0, 0, kLeafSize - 1, [&](int x, const Polygon& slice) {
        if (x != layer)
          return;
        addSlice(x, slice, sign, [&](int leaf, int voxel, i64 volume, i64 area) {
          const u64 place = leaves + static_cast<u64>(leaf);
          i64* const own = sums + place * kSumsOfLeaf + voxel;
          met[place] = 1;
          addSigned(own, volume);
          addSigned(own + kSumsOfLeaf / 2, area);
        });
      });
    });
  }

  // The leaves that were met, one behind the other.
  void gather(u64 entries, i64* out) {
    const u32* met = met_;
    const u64* offset = offset_;
    const i64* sums = sums_;
    u32* list = list_;
    b_.template forTeams<GatherShared>(
        entries, 128, TETVDB_KERNEL(const Team& team, u64 entry, GatherShared&) {
          if (met[entry] == 0)
            return;
          const u64 place = offset[entry];
          if (team.rank() == 0)
            list[place] = static_cast<u32>(entry);
          for (u64 i = static_cast<u64>(team.rank()); i < kSumsOfLeaf;
               i += static_cast<u64>(team.size()))
            out[place * kSumsOfLeaf + i] = sums[entry * kSumsOfLeaf + i];
        });
  }

  /// Two's complement: a sum of the same bits without a sign.
  TETVDB_HD static void addSigned(i64* p, i64 v) {
    addTo(reinterpret_cast<u64*>(p), static_cast<u64>(v));
  }

private:
  // A batch that is being copied to the host.
  struct Landing {
    i64* out = nullptr;
    u64 size = 0; // leaves
    std::vector<u64> starts;
    std::vector<u16> leaves;
  };

  u64 slabsOf(u64 batch) const {
    return std::min(kBatchSlabs, job_.slabCount - batch * kBatchSlabs);
  }

  void hand(u64 n, CoverageReceiver& receiver) {
    const Landing& landing = landings_[n % 2];
    CoverageBatch batch;
    batch.firstSlab = n * kBatchSlabs;
    batch.slabCount = slabsOf(n);
    batch.starts = landing.starts.data();
    batch.leaves = landing.leaves.data();
    if (!landing.leaves.empty())
      batch.sums = reinterpret_cast<const i64*>(b_.landed(static_cast<int>(n % 2)));
    receiver.take(batch);
  }

  Backend& b_;
  const CoverageJob& job_;
  const Vec3d* points_ = nullptr;
  const u32* faces_ = nullptr;
  const FaceInSlab* pairs_ = nullptr;
  const u64* starts_ = nullptr;
  i64* sums_ = nullptr;
  u32* met_ = nullptr; // leaves
  u64* offset_ = nullptr;
  u32* list_ = nullptr;
  std::vector<u32> numbers_;
  Landing landings_[2];
};

} // namespace tetvdb::nano
