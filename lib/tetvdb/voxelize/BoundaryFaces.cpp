// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/BoundaryFaces.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/voxelize/Ownership.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

// Every face belongs to the bucket of its smallest vertex. Three faces of a tet share the tet's
// smallest vertex and travel as one record.
struct TetRecord {
  std::uint32_t v0Sign; // smallest vertex << 1 | 1 where the sorted tet is negative
  std::uint32_t v1, v2, v3;
};
struct FaceRecord {
  std::uint32_t v1Sign; // as above, for the face without v0
  std::uint32_t v2, v3;
};

// Vertices a bucket covers: its hash table (two faces a vertex and tet around it) stays in the
// second cache.
constexpr int kBucketBits = 9;
// Tets a counting task takes, at least; a count is kept for every bucket and chunk.
constexpr std::size_t kMinChunk = 65536;
constexpr std::size_t kMaxChunks = 256;

struct SortedTet {
  std::array<std::uint32_t, 4> v;
  int sign; // orientation in sorted order
};

SortedTet sortTet(const std::uint32_t* tet, int sign) {
  std::array<std::uint32_t, 4> v{tet[0], tet[1], tet[2], tet[3]};
  const auto order = [&](std::size_t i, std::size_t j) {
    const bool swap = v[i] > v[j];
    const std::uint32_t lo = swap ? v[j] : v[i];
    const std::uint32_t hi = swap ? v[i] : v[j];
    v[i] = lo;
    v[j] = hi;
    sign = swap ? -sign : sign;
  };
  order(0, 1);
  order(2, 3);
  order(0, 2);
  order(1, 3);
  order(1, 2);
  return {v, sign};
}

// Open addressing, linear probing; sums of signs by face.
class FaceTable {
public:
  void reset(std::size_t faces) {
    std::size_t size = 64;
    while (size < faces + faces / 2)
      size *= 2;
    entries_.assign(size, Entry{0, 0, kEmpty, 0});
    mask_ = size - 1;
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::int32_t sign) {
    const std::uint64_t key = (std::uint64_t(b) << 32 | c) * 0x9E3779B97F4A7C15ull;
    std::size_t slot = ((key ^ (key >> 29)) + a * 0x85EBCA6Bull) & mask_;
    for (;; slot = (slot + 1) & mask_) {
      Entry& e = entries_[slot];
      if (e.a == a && e.b == b && e.c == c) {
        e.sum += sign;
        return;
      }
      if (e.c == kEmpty) {
        e = {a, b, c, sign};
        return;
      }
    }
  }

  // Appends the faces whose sum is not zero, normals pointing out.
  void collect(std::vector<BoundaryFace>& out) const {
    for (const Entry& e : entries_) {
      if (e.sum > 0)
        out.push_back({e.a, e.b, e.c, e.sum});
      if (e.sum < 0)
        out.push_back({e.a, e.c, e.b, -e.sum});
    }
  }

private:
  // The largest vertex of a face is never kEmpty: vertices are below 2^31.
  static constexpr std::uint32_t kEmpty = 0xFFFFFFFFu;
  struct Entry {
    std::uint32_t a, b, c;
    std::int32_t sum;
  };
  std::vector<Entry> entries_;
  std::size_t mask_ = 0;
};

} // namespace

int tetOrientation(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
                   const LatticePoint& d) {
  const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
  const double vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  const double wx = d.x - a.x, wy = d.y - a.y, wz = d.z - a.z;
  const double xy = vx * wy, yx = vy * wx;
  const double yz = vy * wz, zy = vz * wy;
  const double zx = vz * wx, xz = vx * wz;
  const double det = ux * (yz - zy) + uy * (zx - xz) + uz * (xy - yx);
  // Shewchuk 1997, orient3d's first filter: the differences are exact here, so the error is below
  // (7 + 56 u) u times the permanent, u = 2^-53.
  const double permanent = std::abs(ux) * (std::abs(yz) + std::abs(zy)) +
                           std::abs(uy) * (std::abs(zx) + std::abs(xz)) +
                           std::abs(uz) * (std::abs(xy) + std::abs(yx));
  if (std::abs(det) > 1e-15 * permanent)
    return det > 0 ? 1 : -1;
  return signOf(orientation(a, b, c, d));
}

Boundary boundaryFaces(const SnappedMesh& mesh, Progress& progress) {
  if (mesh.points.size() >= (std::size_t(1) << 31))
    throw Error(Status::Limit, "", "the mesh has more than 2^31 points", "split it in parts");
  const std::size_t buckets = (mesh.points.size() >> kBucketBits) + 1;
  const std::size_t chunkSize = std::max(kMinChunk, mesh.tetCount / kMaxChunks + 1);
  const std::size_t chunks = (mesh.tetCount + chunkSize - 1) / chunkSize;

  // Counts of records by (bucket, chunk), turned into offsets: the order of records within a bucket
  // is that of the tets.
  std::vector<std::uint32_t> tetCounts(buckets * chunks), faceCounts(buckets * chunks);
  std::vector<std::int8_t> signs(mesh.tetCount);
  std::atomic<std::uint64_t> flipped{0}, dropped{0};
  std::atomic<bool> tooLong{false};

  const auto eachTet = [&](std::size_t chunk, auto&& visit) {
    const std::size_t begin = chunk * chunkSize;
    const std::size_t end = std::min(begin + chunkSize, mesh.tetCount);
    for (std::size_t t = begin; t != end; ++t)
      visit(t, mesh.tets + 4 * t);
  };

  tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
    progress.check();
    std::uint64_t negative = 0, flat = 0;
    std::vector<std::uint32_t> tetCount(buckets), faceCount(buckets);
    eachTet(chunk, [&](std::size_t t, const std::uint32_t* v) {
      const LatticePoint& a = mesh.points[v[0]];
      const LatticePoint& b = mesh.points[v[1]];
      const LatticePoint& c = mesh.points[v[2]];
      const LatticePoint& d = mesh.points[v[3]];
      const auto extent = [&](double LatticePoint::*k) {
        return std::max({a.*k, b.*k, c.*k, d.*k}) - std::min({a.*k, b.*k, c.*k, d.*k});
      };
      if (std::max({extent(&LatticePoint::x), extent(&LatticePoint::y), extent(&LatticePoint::z)}) >
          kMaxTetExtent)
        tooLong = true;
      const int sign = tooLong.load(std::memory_order_relaxed) ? 0 : tetOrientation(a, b, c, d);
      signs[t] = static_cast<std::int8_t>(sign);
      negative += sign < 0;
      flat += sign == 0;
      if (sign == 0)
        return;
      const std::uint32_t lo01 = std::min(v[0], v[1]), hi01 = std::max(v[0], v[1]);
      const std::uint32_t lo23 = std::min(v[2], v[3]), hi23 = std::max(v[2], v[3]);
      const std::uint32_t first = std::min(lo01, lo23);
      const std::uint32_t second = std::min({std::max(lo01, lo23), hi01, hi23});
      ++tetCount[first >> kBucketBits];
      ++faceCount[second >> kBucketBits];
    });
    for (std::size_t i = 0; i < buckets; ++i) {
      tetCounts[i * chunks + chunk] = tetCount[i];
      faceCounts[i * chunks + chunk] = faceCount[i];
    }
    flipped += negative;
    dropped += flat;
  });
  if (tooLong)
    throw Error(Status::Limit, "", "a tet is longer than 2^20 voxels", "use larger voxels");

  const auto scan = [](std::vector<std::uint32_t>& counts) {
    std::uint64_t sum = 0;
    for (std::uint32_t& count : counts) {
      const std::uint32_t own = count;
      count = static_cast<std::uint32_t>(sum);
      sum += own;
    }
    return static_cast<std::size_t>(sum);
  };
  const std::size_t tetTotal = scan(tetCounts), faceTotal = scan(faceCounts);

  const std::unique_ptr<TetRecord[]> tetRecords(new TetRecord[tetTotal]);
  const std::unique_ptr<FaceRecord[]> faceRecords(new FaceRecord[faceTotal]);
  tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
    progress.check();
    std::vector<std::uint32_t> nextTet(buckets), nextFace(buckets);
    for (std::size_t i = 0; i < buckets; ++i) {
      nextTet[i] = tetCounts[i * chunks + chunk];
      nextFace[i] = faceCounts[i * chunks + chunk];
    }
    eachTet(chunk, [&](std::size_t t, const std::uint32_t* v) {
      if (signs[t] == 0)
        return;
      const SortedTet s = sortTet(v, signs[t]);
      const std::uint32_t negative = s.sign < 0;
      tetRecords[nextTet[s.v[0] >> kBucketBits]++] = {s.v[0] << 1 | negative, s.v[1], s.v[2],
                                                      s.v[3]};
      faceRecords[nextFace[s.v[1] >> kBucketBits]++] = {s.v[1] << 1 | negative, s.v[2], s.v[3]};
    });
  });
  std::vector<std::int8_t>().swap(signs);

  const auto bucketEnd = [&](const std::vector<std::uint32_t>& offsets, std::size_t bucket,
                             std::size_t total) {
    return bucket + 1 < buckets ? std::size_t(offsets[(bucket + 1) * chunks]) : total;
  };
  std::vector<std::vector<BoundaryFace>> found(buckets);
  tbb::enumerable_thread_specific<FaceTable> tables;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, buckets, 4), [&](const auto& range) {
    progress.check();
    FaceTable& table = tables.local();
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const std::size_t tetBegin = chunks ? tetCounts[i * chunks] : 0;
      const std::size_t tetEnd = chunks ? bucketEnd(tetCounts, i, tetTotal) : 0;
      const std::size_t faceBegin = chunks ? faceCounts[i * chunks] : 0;
      const std::size_t faceEnd = chunks ? bucketEnd(faceCounts, i, faceTotal) : 0;
      if (tetBegin == tetEnd && faceBegin == faceEnd)
        continue;
      table.reset(3 * (tetEnd - tetBegin) + (faceEnd - faceBegin));
      // A sorted tet of positive orientation has outward normals on 0 1 3 and 1 2 3, inward ones
      // on 0 1 2 and 0 2 3.
      for (std::size_t k = tetBegin; k != tetEnd; ++k) {
        const TetRecord& r = tetRecords[k];
        const std::uint32_t v0 = r.v0Sign >> 1;
        const std::int32_t sign = (r.v0Sign & 1) ? -1 : 1;
        table.add(v0, r.v1, r.v2, -sign);
        table.add(v0, r.v1, r.v3, sign);
        table.add(v0, r.v2, r.v3, -sign);
      }
      for (std::size_t k = faceBegin; k != faceEnd; ++k) {
        const FaceRecord& r = faceRecords[k];
        table.add(r.v1Sign >> 1, r.v2, r.v3, (r.v1Sign & 1) ? -1 : 1);
      }
      table.collect(found[i]);
    }
  });

  Boundary boundary;
  boundary.flipped = flipped;
  boundary.dropped = dropped;
  std::size_t total = 0;
  for (const auto& faces : found)
    total += faces.size();
  boundary.faces.reserve(total);
  for (const auto& faces : found)
    boundary.faces.insert(boundary.faces.end(), faces.begin(), faces.end());
  return boundary;
}

} // namespace tetvdb
