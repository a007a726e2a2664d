// SPDX-License-Identifier: Apache-2.0
//
// Volumes that faces cut off the cubes of voxels: a thread for every layer x of a (face, slab) pair
// adds to dense arrays of a batch of slabs. Sums are of integers, so that order does not matter.
#pragma once

#include "CoverageJob.h"
#include "Team.h"

#include <algorithm>

namespace tetvdb::nano {

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

  /// Allocates the arrays.
  void begin() {
    const u64 slabs = std::min(job_.slabCount, kBatchSlabs);
    b_.require(slabs * kLeavesInSlab * kSumsOfLeaf * sizeof(i64));
    sums_ = b_.template alloc<i64>(slabs * kLeavesInSlab * kSumsOfLeaf);
    met_ = b_.template alloc<u32>(slabs * kLeavesInSlab);
  }

  /// Sums up slabs first .. first + slabs - 1, at most kBatchSlabs of them.
  void sum(u64 first, u64 slabs) {
    const u64 leaves = slabs * kLeavesInSlab;
    b_.zero(sums_, leaves * kSumsOfLeaf * sizeof(i64));
    b_.zero(met_, leaves * sizeof(u32));
    add(first, slabs);
  }

  const i64* sums() const {
    return sums_;
  }                                       ///< kSumsOfLeaf a leaf (SlabVolume.h), 256 leaves a slab
  const u32* met() const { return met_; } ///< by leaf: whether a face meets it
  const FaceInSlab* pairs() const { return pairs_; }
  const u64* starts() const { return starts_; } ///< of slabs, in pairs()

  // Public for nvcc alone, as in LevelBuilder.

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

  /// Two's complement: a sum of the same bits without a sign.
  TETVDB_HD static void addSigned(i64* p, i64 v) {
    addTo(reinterpret_cast<u64*>(p), static_cast<u64>(v));
  }

private:
  Backend& b_;
  const CoverageJob& job_;
  const Vec3d* points_ = nullptr;
  const u32* faces_ = nullptr;
  const FaceInSlab* pairs_ = nullptr;
  const u64* starts_ = nullptr;
  i64* sums_ = nullptr;
  u32* met_ = nullptr; // leaves
};

} // namespace tetvdb::nano
