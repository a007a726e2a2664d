// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/BoundaryFaces.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/JoinedVectors.h"
#include "tetvdb/geometry/Ownership.h"
#include "tetvdb/geometry/TetBox.h"
#include "tetvdb/voxelize/FaceSums.h"
#include "tetvdb/voxelize/VertexSums.h"

#include <algorithm>
#include <atomic>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

// Tets a counting task takes, at least; a count is kept for every bucket and chunk.
constexpr std::size_t kMinChunk = 65536;
constexpr std::size_t kMaxChunks = 256;
// Bytes for the sums of all threads together.
constexpr std::size_t kSumBytes = std::size_t(1) << 29;

class BoundaryFinder {
public:
  BoundaryFinder(const SnappedMesh& mesh, Progress& progress)
      : mesh_(mesh), progress_(progress), open_(mesh.pointCount) {}

  Boundary run() {
    findOpenVertices();
    Boundary boundary;
    boundary.faces = matchFaces();
    if (!closes(boundary.faces, mesh_.pointCount)) {
      std::fill(open_.begin(), open_.end(), std::uint8_t(1));
      boundary.faces = matchFaces();
    }
    boundary.flipped = flipped_;
    boundary.dropped = dropped_;
    return boundary;
  }

private:
  void findOpenVertices() {
    const LatticePoint& low = mesh_.boxMin;
    const LatticePoint& high = mesh_.boxMax;
    const bool checkExtents =
        std::max({high.x - low.x, high.y - low.y, high.z - low.z}) > kMaxTetExtent;
    const std::size_t points = mesh_.pointCount;
    const std::size_t affordable = std::max<std::size_t>(kSumBytes / (8 * points + 1), 1);
    const std::size_t parts =
        std::min(affordable, static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
    std::vector<LargeVector<std::uint64_t>> sums(parts);
    tbb::parallel_for(
        std::size_t(0), parts,
        [&](std::size_t part) {
          sums[part].assign(points, 0);
          const std::size_t begin = mesh_.tetCount / parts * part;
          const std::size_t end =
              part + 1 == parts ? mesh_.tetCount : begin + mesh_.tetCount / parts;
          for (std::size_t t = begin; t < end; t += kMinChunk) {
            progress_.check();
            sumFaces(t, std::min(t + kMinChunk, end), checkExtents, sums[part].data());
          }
        },
        tbb::simple_partitioner());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points, 65536), [&](const auto& range) {
      for (std::size_t v = range.begin(); v != range.end(); ++v) {
        std::uint64_t sum = 0;
        for (const LargeVector<std::uint64_t>& part : sums)
          sum += part[v];
        open_[v] = sum != 0;
      }
    });
  }

  void sumFaces(std::size_t begin, std::size_t end, bool checkExtents, std::uint64_t* sums) {
    if (checkExtents)
      for (std::size_t t = begin; t != end; ++t)
        checkExtent(mesh_.tets + 4 * t);
    const OrientationCounts counts = addToVertexSums(mesh_, begin, end, sums);
    flipped_ += counts.flipped;
    dropped_ += counts.dropped;
  }

  void checkExtent(const std::uint32_t* v) const {
    if (boxOf(mesh_.points[v[0]], mesh_.points[v[1]], mesh_.points[v[2]], mesh_.points[v[3]])
            .extent() > kMaxTetExtent)
      throw Error(Status::Limit, "", "a tet is longer than 2^20 voxels", "use larger voxels");
  }

  // The tets begin <= t < end, positive and sorted, that have faces with an open first corner.
  std::vector<SortedTet> openTets(std::size_t begin, std::size_t end) const {
    std::vector<SortedTet> tets;
    constexpr std::size_t block = 1024;
    std::array<std::uint32_t, block> touching;
    for (std::size_t first = begin; first < end; first += block) {
      // Few do, at places that no processor predicts: found without a branch.
      const std::size_t size = std::min(block, end - first);
      std::size_t count = 0;
      for (std::uint32_t i = 0; i < size; ++i) {
        const std::uint32_t* v = mesh_.tets + 4 * (first + i);
        touching[count] = i;
        count += open_[v[0]] | open_[v[1]] | open_[v[2]] | open_[v[3]];
      }
      for (std::size_t k = 0; k < count; ++k) {
        const std::uint32_t* v = mesh_.tets + 4 * (first + touching[k]);
        SortedTet tet = sortTet(v, 1);
        if ((open_[tet.v[0]] | open_[tet.v[1]]) == 0)
          continue;
        tet.sign *= tetOrientation(mesh_.points[v[0]], mesh_.points[v[1]], mesh_.points[v[2]],
                                   mesh_.points[v[3]]);
        if (tet.sign != 0)
          tets.push_back(tet);
      }
    }
    return tets;
  }

  // Calls visit(record) for the faces whose first corner is open.
  template <typename Visit>
  void eachOpenFace(const SortedTet& tet, const Visit& visit) const {
    eachFace(tet, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::int32_t sign) {
      if (open_[a] != 0)
        visit(FaceRecord{a << 1 | static_cast<std::uint32_t>(sign < 0), b, c});
    });
  }

  // The faces at open vertices whose signs do not cancel.
  std::vector<BoundaryFace> matchFaces() {
    const std::size_t buckets = (mesh_.pointCount >> kBucketBits) + 1;
    const std::size_t chunkSize = std::max(kMinChunk, mesh_.tetCount / kMaxChunks + 1);
    const std::size_t chunks = (mesh_.tetCount + chunkSize - 1) / chunkSize;

    // Records by (bucket, chunk): counts, turned into offsets. Within a bucket the records are in
    // the order of the tets.
    std::vector<std::uint64_t> offsets(buckets * chunks + 1);
    std::vector<std::vector<SortedTet>> tets(chunks);
    tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
      progress_.check();
      tets[chunk] = openTets(chunk * chunkSize, std::min((chunk + 1) * chunkSize, mesh_.tetCount));
      std::vector<std::uint32_t> counts(buckets);
      for (const SortedTet& tet : tets[chunk])
        eachOpenFace(tet, [&](const FaceRecord& record) { ++counts[record.bucket()]; });
      for (std::size_t i = 0; i < buckets; ++i)
        offsets[i * chunks + chunk + 1] = counts[i];
    });
    for (std::size_t i = 1; i < offsets.size(); ++i)
      offsets[i] += offsets[i - 1];

    LargeVector<FaceRecord> records(offsets.back());
    tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
      progress_.check();
      std::vector<std::uint64_t> next(buckets);
      for (std::size_t i = 0; i < buckets; ++i)
        next[i] = offsets[i * chunks + chunk];
      for (const SortedTet& tet : tets[chunk])
        eachOpenFace(tet,
                     [&](const FaceRecord& record) { records[next[record.bucket()]++] = record; });
      std::vector<SortedTet>().swap(tets[chunk]);
    });

    std::vector<std::vector<BoundaryFace>> found(buckets);
    tbb::enumerable_thread_specific<FaceTable> tables;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, buckets, 4), [&](const auto& range) {
      progress_.check();
      FaceTable& table = tables.local();
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const std::uint64_t begin = offsets[i * chunks], end = offsets[(i + 1) * chunks];
        if (begin == end)
          continue;
        table.reset(end - begin);
        for (std::uint64_t k = begin; k != end; ++k)
          table.add(records[k].aSign >> 1, records[k].b, records[k].c,
                    (records[k].aSign & 1) != 0 ? -1 : 1);
        table.collect(found[i]);
      }
    });

    return joinedVectors<BoundaryFace>(found);
  }

  const SnappedMesh& mesh_;
  Progress& progress_;
  std::vector<std::uint8_t> open_;
  std::atomic<std::uint64_t> flipped_{0}, dropped_{0};
};

} // namespace

Boundary boundaryFaces(const SnappedMesh& mesh, Progress& progress) {
  if (mesh.pointCount >= (std::size_t(1) << 31))
    throw Error(Status::Limit, "", "the mesh has more than 2^31 points", "split it in parts");
  return BoundaryFinder(mesh, progress).run();
}

} // namespace tetvdb
