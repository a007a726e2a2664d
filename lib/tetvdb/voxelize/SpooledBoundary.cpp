// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/SpooledBoundary.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/JoinedVectors.h"
#include "tetvdb/core/LargeVector.h"
#include "tetvdb/geometry/Ownership.h"
#include "tetvdb/geometry/TetBox.h"
#include "tetvdb/voxelize/FaceSums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

// A bit a vertex.
class VertexBits {
public:
  explicit VertexBits(std::size_t count) : words_((count + 63) / 64) {}

  void set(std::size_t v) { words_[v / 64] |= std::uint64_t(1) << (v % 64); }
  void setAll() { std::fill(words_.begin(), words_.end(), ~std::uint64_t(0)); }
  bool operator[](std::size_t v) const { return (words_[v / 64] >> (v % 64) & 1) != 0; }

private:
  std::vector<std::uint64_t> words_;
};

struct Nothing {};

class Finder {
public:
  Finder(const SpooledMesh& mesh, const GridTransform& transform, std::size_t bytes,
         std::size_t maxResident, Progress& progress)
      : mesh_(mesh), transform_(transform), bytes_(std::max(bytes, std::size_t(1) << 12)),
        maxResident_(maxResident), progress_(progress), points_(mesh.points.as<Vec3d>()),
        tets_(mesh.tets.as<std::uint32_t>()), open_(mesh.pointCount()) {}

  SpooledBoundary run() {
    SpooledBoundary result;
    findOpenVertices(result.chain);
    matchFaces(result);
    if (!closes(result.chain.faces, result.points.size())) {
      open_.setAll();
      matchFaces(result);
    }
    return result;
  }

private:
  LatticePoint snapped(std::uint32_t vertex) const {
    return snapPoint(points_[vertex], transform_);
  }

  bool isInIndexSpace(const Vec3d& p) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (!(std::abs((p[k] - transform_.origin[k]) / transform_.voxelSize[k]) < kMaxVoxel))
        return false;
    return true;
  }

  int signOf(const std::uint32_t* v) const {
    return tetOrientation(snapped(v[0]), snapped(v[1]), snapped(v[2]), snapped(v[3]));
  }

  void check(const std::uint32_t* v) const {
    for (int i = 0; i < 4; ++i)
      if (!isInIndexSpace(points_[v[i]]))
        throw Error(Status::Limit, "", "the mesh leaves 32-bit index space at this voxel size",
                    "use larger voxels");
    if (boxOf(snapped(v[0]), snapped(v[1]), snapped(v[2]), snapped(v[3])).extent() > kMaxTetExtent)
      throw Error(Status::Limit, "", "a tet is longer than 2^20 voxels", "use larger voxels");
  }

  // Sums of r_b r_c over the faces a < b < c of all tets at their first corner, for as many
  // vertices at a time as there is room for.
  void findOpenVertices(Boundary& boundary) {
    const std::size_t points = mesh_.pointCount();
    const std::size_t atOnce = std::min(points, std::max<std::size_t>(bytes_ / 8, 1));
    LargeVector<std::uint64_t> sums(atOnce);
    for (std::size_t first = 0; first < points; first += atOnce) {
      const std::size_t end = std::min(first + atOnce, points);
      std::fill(sums.begin(), sums.end(), 0);
      const auto add = [&](std::uint32_t vertex, std::uint64_t term) {
        if (vertex >= first && vertex < end)
          __atomic_fetch_add(&sums[vertex - first], term, __ATOMIC_RELAXED);
      };
      struct Counts {
        std::uint64_t flipped = 0, dropped = 0;
      };
      eachTetRange(
          mesh_, maxResident_, progress_,
          [&](std::size_t from, std::size_t to) {
            Counts counts;
            for (std::size_t t = from; t < to; ++t) {
              const std::uint32_t* v = tets_ + 4 * t;
              if (first == 0)
                check(v);
              const int sign = signOf(v);
              counts.flipped += sign < 0;
              counts.dropped += sign == 0;
              if (sign == 0)
                continue;
              const SortedTet s = sortTet(v, sign);
              const VertexTerms terms = vertexTerms(s);
              add(s.v[0], terms.first);
              add(s.v[1], terms.second);
            }
            return counts;
          },
          [&](const Counts& counts) {
            if (first > 0)
              return;
            boundary.flipped += counts.flipped;
            boundary.dropped += counts.dropped;
          });
      for (std::size_t v = first; v < end; ++v)
        if (sums[v - first] != 0)
          open_.set(v);
    }
  }

  // Calls visit(record) for the faces of tet t whose first corner is open.
  template <typename Visit>
  void eachOpenFace(std::size_t t, const Visit& visit) const {
    const std::uint32_t* v = tets_ + 4 * t;
    if (!(open_[v[0]] || open_[v[1]] || open_[v[2]] || open_[v[3]]))
      return;
    const int sign = signOf(v);
    if (sign == 0)
      return;
    eachFace(sortTet(v, sign),
             [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::int32_t s) {
               if (open_[a])
                 visit(FaceRecord{a << 1 | static_cast<std::uint32_t>(s < 0), b, c});
             });
  }

  void matchFaces(SpooledBoundary& result) {
    const std::size_t buckets = (mesh_.pointCount() >> kBucketBits) + 1;
    std::vector<std::uint64_t> counts(buckets);
    eachTetRange(
        mesh_, maxResident_, progress_,
        [&](std::size_t from, std::size_t to) {
          for (std::size_t t = from; t < to; ++t)
            eachOpenFace(t, [&](const FaceRecord& record) {
              __atomic_fetch_add(&counts[record.bucket()], 1, __ATOMIC_RELAXED);
            });
          return Nothing();
        },
        [](Nothing) {});
    std::vector<BoundaryFace>& faces = result.chain.faces;
    faces.clear();
    const std::uint64_t most = bytes_ / sizeof(FaceRecord);
    for (std::size_t begin = 0; begin < buckets;) {
      std::size_t end = begin;
      std::uint64_t sum = 0;
      do
        sum += counts[end++];
      while (end < buckets && sum + counts[end] <= most);
      if (sum > 0) {
        const std::vector<BoundaryFace> found = matchIn(begin, end, counts);
        faces.insert(faces.end(), found.begin(), found.end());
      }
      begin = end;
    }
    usePoints(result);
  }

  // The faces of buckets begin <= i < end.
  std::vector<BoundaryFace> matchIn(std::size_t begin, std::size_t end,
                                    const std::vector<std::uint64_t>& counts) {
    std::vector<std::uint64_t> offsets(end - begin + 1);
    for (std::size_t i = begin; i < end; ++i)
      offsets[i - begin + 1] = offsets[i - begin] + counts[i];
    LargeVector<FaceRecord> records(static_cast<std::size_t>(offsets.back()));
    std::vector<std::uint64_t> next(offsets.begin(), offsets.end() - 1);
    eachTetRange(
        mesh_, maxResident_, progress_,
        [&](std::size_t from, std::size_t to) {
          std::vector<FaceRecord> own;
          for (std::size_t t = from; t < to; ++t)
            eachOpenFace(t, [&](const FaceRecord& record) {
              if (const std::size_t bucket = record.bucket(); bucket >= begin && bucket < end)
                own.push_back(record);
            });
          return own;
        },
        [&](const std::vector<FaceRecord>& own) {
          for (const FaceRecord& record : own)
            records[next[record.bucket() - begin]++] = record;
        });
    std::vector<std::vector<BoundaryFace>> found(end - begin);
    tbb::enumerable_thread_specific<FaceTable> tables;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, end - begin, 4), [&](const auto& range) {
      progress_.check();
      FaceTable& table = tables.local();
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        if (offsets[i] == offsets[i + 1])
          continue;
        table.reset(offsets[i + 1] - offsets[i]);
        for (std::uint64_t k = offsets[i]; k != offsets[i + 1]; ++k)
          table.add(records[k].aSign >> 1, records[k].b, records[k].c,
                    (records[k].aSign & 1) != 0 ? -1 : 1);
        table.collect(found[i]);
      }
    });
    return joinedVectors<BoundaryFace>(found);
  }

  // Numbers the points of the faces anew.
  void usePoints(SpooledBoundary& result) const {
    const std::vector<std::uint32_t> used = renumberPoints(result.chain.faces, mesh_.pointCount());
    result.points.resize(used.size());
    for (std::size_t i = 0; i < used.size(); ++i)
      result.points[i] = points_[used[i]];
  }

  // As snapPoints().
  static constexpr double kMaxVoxel = 2147475456.0;

  const SpooledMesh& mesh_;
  const GridTransform& transform_;
  std::size_t bytes_, maxResident_;
  Progress& progress_;
  const Vec3d* points_;
  const std::uint32_t* tets_;
  VertexBits open_;
};

} // namespace

SpooledBoundary spooledBoundary(const SpooledMesh& mesh, const GridTransform& transform,
                                std::size_t bytes, std::size_t maxResident, Progress& progress) {
  if (mesh.pointCount() >= (std::size_t(1) << 31))
    throw Error(Status::Limit, "", "the mesh has more than 2^31 points", "split it in parts");
  return Finder(mesh, transform, bytes, maxResident, progress).run();
}

} // namespace tetvdb
