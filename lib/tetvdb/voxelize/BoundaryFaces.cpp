// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/BoundaryFaces.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/JoinedVectors.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/Ownership.h"
#include "tetvdb/geometry/TetBox.h"
#include "tetvdb/voxelize/FaceSums.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <utility>

// Vectors never cross a function that is not inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace tetvdb {
namespace {

// Tets a counting task takes, at least; a count is kept for every bucket and chunk.
constexpr std::size_t kMinChunk = 65536;
constexpr std::size_t kMaxChunks = 256;
// Bytes for the sums of all threads together.
constexpr std::size_t kSumBytes = std::size_t(1) << 29;

// Adds r_b r_c over the faces a < b < c of a tet at their first corner.
TETVDB_INLINE void addFaces(const std::uint32_t* v, std::int32_t sign, std::uint64_t* sums) {
  const SortedTet s = sortTet(v, sign);
  const VertexTerms terms = vertexTerms(s);
  sums[s.v[0]] += terms.first;
  sums[s.v[1]] += terms.second;
}

typedef double Quad __attribute__((vector_size(4 * sizeof(double))));
typedef std::int64_t QuadMask __attribute__((vector_size(4 * sizeof(std::int64_t))));

TETVDB_INLINE void load(const LatticePoint& p, Quad& q) {
  std::memcpy(&q, &p, sizeof q);
}

// Orients the tets begin..end, writes the signs and adds up their faces. A sign that doubles do not
// decide is left 0; returns how many.
TETVDB_MULTIVERSION std::uint64_t sumFaces(const SnappedMesh& mesh, std::size_t begin,
                                           std::size_t end, std::int8_t* signs,
                                           std::uint64_t* sums) {
  const LatticePoint* points = mesh.points.data();
  const QuadMask clearSign = {0x7FFFFFFFFFFFFFFF, 0x7FFFFFFFFFFFFFFF, 0x7FFFFFFFFFFFFFFF, 0};
  const QuadMask rotate = {1, 2, 0, 3}, rotateTwice = {2, 0, 1, 3};
  const auto absolute = [&](const Quad& q) __attribute__((always_inline)) {
    return reinterpret_cast<Quad>(reinterpret_cast<QuadMask>(q) & clearSign);
  };
  std::uint64_t doubtful = 0;
  for (std::size_t t = begin; t != end; ++t) {
    const std::uint32_t* id = mesh.tets + 4 * t;
    Quad a, u, v, w;
    load(points[id[0]], a);
    load(points[id[1]], u);
    load(points[id[2]], v);
    load(points[id[3]], w);
    u -= a;
    v -= a;
    w -= a;
    // v x w, its components rotated to z x y, against u rotated alike; as in tetOrientation(). The
    // fourth lane holds whatever follows the points and is never added.
    const Quad one = v * __builtin_shuffle(w, rotate), two = __builtin_shuffle(v, rotate) * w;
    const Quad turned = __builtin_shuffle(u, rotateTwice);
    const Quad terms = turned * (one - two);
    const Quad sizes = absolute(turned) * (absolute(one) + absolute(two));
    const double det = terms[0] + terms[1] + terms[2];
    const double permanent = sizes[0] + sizes[1] + sizes[2];
    const double error = RoundedDeterminant::kOfExact * permanent;
    const int sign = static_cast<int>(det > error) - static_cast<int>(det < -error);
    signs[t] = static_cast<std::int8_t>(sign);
    doubtful += sign == 0;
    addFaces(id, sign, sums);
  }
  return doubtful;
}

class BoundaryFinder {
public:
  BoundaryFinder(const SnappedMesh& mesh, Progress& progress)
      : mesh_(mesh), progress_(progress), signs_(mesh.tetCount), open_(mesh.pointCount) {}

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
  // Orients every tet, and adds up r_b r_c over the faces a < b < c at their first corner.
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
    const std::uint64_t doubtful = tetvdb::sumFaces(mesh_, begin, end, signs_.data(), sums);
    // Flat tets add nothing, so undecided tets are added after their orientation is decided.
    std::uint64_t negative = 0, flat = 0;
    for (std::size_t t = begin; t != end; ++t) {
      if (doubtful != 0 && signs_[t] == 0) {
        const std::uint32_t* v = mesh_.tets + 4 * t;
        const int sign = signOf(orientation(mesh_.points[v[0]], mesh_.points[v[1]],
                                            mesh_.points[v[2]], mesh_.points[v[3]]));
        signs_[t] = static_cast<std::int8_t>(sign);
        addFaces(v, sign, sums);
        flat += sign == 0;
      }
      negative += signs_[t] < 0;
    }
    flipped_ += negative;
    dropped_ += flat;
  }

  void checkExtent(const std::uint32_t* v) const {
    if (boxOf(mesh_.points[v[0]], mesh_.points[v[1]], mesh_.points[v[2]], mesh_.points[v[3]])
            .extent() > kMaxTetExtent)
      throw Error(Status::Limit, "", "a tet is longer than 2^20 voxels", "use larger voxels");
  }

  // The faces at open vertices whose signs do not cancel.
  std::vector<BoundaryFace> matchFaces() {
    const std::size_t buckets = (mesh_.pointCount >> kBucketBits) + 1;
    const std::size_t chunkSize = std::max(kMinChunk, mesh_.tetCount / kMaxChunks + 1);
    const std::size_t chunks = (mesh_.tetCount + chunkSize - 1) / chunkSize;

    // Records by (bucket, chunk): counts, turned into offsets. Within a bucket the records are in
    // the order of the tets.
    std::vector<std::uint64_t> offsets(buckets * chunks + 1);
    std::vector<std::vector<FaceRecord>> local(chunks);
    tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
      progress_.check();
      std::vector<std::uint32_t> counts(buckets);
      const std::size_t end = std::min((chunk + 1) * chunkSize, mesh_.tetCount);
      for (std::size_t t = chunk * chunkSize; t != end; ++t) {
        const std::uint32_t* v = mesh_.tets + 4 * t;
        if ((open_[v[0]] | open_[v[1]] | open_[v[2]] | open_[v[3]]) == 0 || signs_[t] == 0)
          continue;
        eachFace(sortTet(v, signs_[t]),
                 [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::int32_t sign) {
                   if (open_[a] == 0)
                     return;
                   ++counts[a >> kBucketBits];
                   local[chunk].push_back({a << 1 | static_cast<std::uint32_t>(sign < 0), b, c});
                 });
      }
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
      for (const FaceRecord& record : local[chunk])
        records[next[record.aSign >> (kBucketBits + 1)]++] = record;
      std::vector<FaceRecord>().swap(local[chunk]);
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
  LargeVector<std::int8_t> signs_;
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
