// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/BoundaryFaces.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/JoinedVectors.h"
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
constexpr std::size_t kMaxChunks = 64;
// Bytes for the sums of all threads together.
constexpr std::size_t kSumBytes = std::size_t(1) << 29;

class BoundaryFinder {
public:
  BoundaryFinder(const TetsToSnap& mesh, Progress& progress)
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
            const OrientationCounts counts =
                addToVertexSums(mesh_, t, std::min(t + kMinChunk, end), sums[part].data());
            flipped_ += counts.flipped;
            dropped_ += counts.dropped;
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

  // The tets begin <= t < end, positive and sorted, that have faces with an open first corner.
  // Counts these faces by buckets.
  std::vector<SortedTet> openTets(std::size_t begin, std::size_t end,
                                  std::vector<std::uint32_t>& counts) const {
    std::vector<SortedTet> open;
    constexpr std::size_t block = 1024;
    std::array<std::uint32_t, 4 * block> tets;
    std::array<std::int8_t, block> signs;
    for (std::size_t first = begin; first < end; first += block) {
      // Few do, at places that no processor predicts: found without a branch.
      const std::uint32_t* const last = mesh_.tets + 4 * std::min(first + block, end);
      std::size_t count = 0;
      for (const std::uint32_t* v = mesh_.tets + 4 * first; v != last; v += 4) {
        prefetchIndices(v);
        std::copy(v, v + 4, &tets[4 * count]);
        count += open_[v[0]] | open_[v[1]] | open_[v[2]] | open_[v[3]];
      }
      orientTets(mesh_, tets.data(), count, signs.data());
      for (std::size_t i = 0; i < count; ++i) {
        const SortedTet tet = sortTet(&tets[4 * i], signs[i]);
        if (tet.sign == 0 || (open_[tet.v[0]] | open_[tet.v[1]]) == 0)
          continue;
        open.push_back(tet);
        counts[tet.v[0] >> kBucketBits] += open_[tet.v[0]] * 3u; // of its four faces
        counts[tet.v[1] >> kBucketBits] += open_[tet.v[1]];
      }
    }
    return open;
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
      std::vector<std::uint32_t> counts(buckets);
      tets[chunk] =
          openTets(chunk * chunkSize, std::min((chunk + 1) * chunkSize, mesh_.tetCount), counts);
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
        eachFace(tet, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::int32_t sign) {
          if (open_[a] != 0)
            records[next[a >> kBucketBits]++] = {a << 1 | static_cast<std::uint32_t>(sign < 0), b,
                                                 c};
        });
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

  const TetsToSnap& mesh_;
  Progress& progress_;
  std::vector<std::uint8_t> open_;
  std::atomic<std::uint64_t> flipped_{0}, dropped_{0};
};

Boundary boundaryFaces(const TetsToSnap& mesh, Progress& progress) {
  if (mesh.pointCount >= (std::size_t(1) << 31))
    throw Error(Status::Limit, "", "the mesh has more than 2^31 points", "split it in parts");
  return BoundaryFinder(mesh, progress).run();
}

} // namespace

Boundary boundaryFaces(const SnappedMesh& mesh, Progress& progress) {
  static_assert(sizeof(LatticePoint) == 3 * sizeof(double));
  // With which a lattice point is snapped to itself.
  constexpr auto one = static_cast<double>(kUnitsPerVoxel);
  return boundaryFaces(TetsToSnap{&mesh.points.data()->x,
                                  mesh.pointCount,
                                  mesh.tets,
                                  mesh.tetCount,
                                  {{one, one, one}, {0, 0, 0}}},
                       progress);
}

Boundary boundaryFaces(const TetMesh& mesh, const GridTransform& transform, Progress& progress) {
  static_assert(sizeof(Vec3d) == 3 * sizeof(double));
  return boundaryFaces(TetsToSnap{mesh.points.empty() ? nullptr : mesh.points.front().data(),
                                  mesh.points.size(), mesh.tets.data(), mesh.tetCount(), transform},
                       progress);
}

std::vector<std::uint32_t> renumberPoints(std::vector<BoundaryFace>& faces,
                                          std::size_t pointCount) {
  const UsedPoints used(faces, pointCount);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, faces.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      BoundaryFace& f = faces[i];
      f = {used.rank(f.a), used.rank(f.b), used.rank(f.c), f.weight};
    }
  });
  return used.points();
}

SnappedMesh snapUsed(const std::vector<Vec3d>& points, Boundary& boundary,
                     const GridTransform& transform, Progress& progress) {
  const std::vector<std::uint32_t> old = renumberPoints(boundary.faces, points.size());
  std::vector<Vec3d> used(old.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, old.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      used[i] = points[old[i]];
  });
  return snapPoints(used, transform, progress);
}

} // namespace tetvdb
