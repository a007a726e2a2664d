// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/WeldPoints.h"

#include "tetvdb/core/LargeVector.h"
#include "tetvdb/core/MixBits.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <unordered_map>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;
constexpr std::size_t kPointsPerTask = 1 << 14;
// Mean number of points in a bucket of the hash: its table fits into the second-level cache.
constexpr std::size_t kPointsPerBucket = 4096;
constexpr std::size_t kMaxBuckets = 1 << 12;

// Points sorted into buckets by hash, in each bucket by number.
struct Buckets {
  struct Entry {
    std::uint32_t point, hash;
  };
  LargeVector<Entry> entries;
  std::vector<std::uint32_t> first; ///< one more than there are buckets
};

Buckets sortIntoBuckets(const std::vector<Vec3d>& points) {
  std::size_t count = 1;
  int bits = 0;
  while (count < kMaxBuckets && count * kPointsPerBucket < points.size()) {
    count *= 2;
    ++bits;
  }
  const auto bucketOf = [bits](std::uint64_t hash) {
    return bits == 0 ? 0u : static_cast<std::uint32_t>(hash >> (64 - bits));
  };

  // Each task counts, and later fills, the entries of its own range of points.
  const std::size_t tasks = (points.size() + kPointsPerTask - 1) / kPointsPerTask;
  LargeVector<std::uint64_t> hashes(points.size());
  std::vector<std::uint32_t> cursors(tasks * count, 0);
  const auto eachTask = [&](const auto& body) {
    tbb::parallel_for(std::size_t(0), tasks, [&](std::size_t task) {
      body(&cursors[task * count], task * kPointsPerTask,
           std::min(points.size(), (task + 1) * kPointsPerTask));
    });
  };
  eachTask([&](std::uint32_t* cursor, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      hashes[i] = hashOfPoint(points[i]);
      ++cursor[bucketOf(hashes[i])];
    }
  });
  Buckets buckets;
  buckets.entries.resize(points.size());
  buckets.first.resize(count + 1);
  std::uint32_t total = 0;
  for (std::size_t bucket = 0; bucket < count; ++bucket) {
    buckets.first[bucket] = total;
    for (std::size_t task = 0; task < tasks; ++task) {
      const std::uint32_t here = cursors[task * count + bucket];
      cursors[task * count + bucket] = total;
      total += here;
    }
  }
  buckets.first[count] = total;
  eachTask([&](std::uint32_t* cursor, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      buckets.entries[cursor[bucketOf(hashes[i])]++] = {static_cast<std::uint32_t>(i),
                                                        static_cast<std::uint32_t>(hashes[i])};
  });
  return buckets;
}

void weldEqual(const std::vector<Vec3d>& points, std::vector<std::uint32_t>& becomes) {
  const Buckets buckets = sortIntoBuckets(points);
  tbb::parallel_for(std::size_t(0), buckets.first.size() - 1, [&](std::size_t bucket) {
    const std::uint32_t begin = buckets.first[bucket], end = buckets.first[bucket + 1];
    std::size_t size = 16;
    while (size < 2 * std::size_t(end - begin))
      size *= 2;
    std::vector<std::uint32_t> table(size, kNone); // entries, by hash
    for (std::uint32_t i = begin; i < end; ++i) {
      const auto [point, hash] = buckets.entries[i];
      std::size_t slot = hash & (size - 1);
      for (; table[slot] != kNone; slot = (slot + 1) & (size - 1)) {
        const auto& other = buckets.entries[table[slot]];
        if (other.hash == hash && points[other.point] == points[point])
          break;
      }
      if (table[slot] == kNone)
        table[slot] = i;
      becomes[point] = buckets.entries[table[slot]].point;
    }
  });
}

struct Cell {
  Vec3d corner; // whole numbers
  bool operator==(const Cell& other) const { return corner == other.corner; }
};
struct CellHash {
  std::size_t operator()(const Cell& cell) const { return hashOfPoint(cell.corner); }
};

// In a grid of cells of size `distance`, neighbours are in the 27 cells around, and a cell contains
// few kept points, since kept points are not close to one another.
void weldNear(const std::vector<Vec3d>& points, double distance,
              std::vector<std::uint32_t>& becomes, Progress& progress) {
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> kept;
  const auto cellOf = [&](const Vec3d& p) {
    return Cell{
        {std::floor(p[0] / distance), std::floor(p[1] / distance), std::floor(p[2] / distance)}};
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % 65536 == 0)
      progress.check();
    if (becomes[i] != i) {
      becomes[i] = becomes[becomes[i]];
      continue;
    }
    const Cell home = cellOf(points[i]);
    std::uint32_t first = static_cast<std::uint32_t>(i);
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      const int x = neighbour % 3 - 1, y = neighbour / 3 % 3 - 1, z = neighbour / 9 - 1;
      const auto found = kept.find({{home.corner[0] + x, home.corner[1] + y, home.corner[2] + z}});
      if (found == kept.end())
        continue;
      for (const std::uint32_t other : found->second)
        if (other < first && length(minus(points[other], points[i])) < distance)
          first = other;
    }
    becomes[i] = first;
    if (first == i)
      kept[home].push_back(first);
  }
}

} // namespace

std::vector<std::uint32_t> weldPoints(const std::vector<Vec3d>& points, double distance,
                                      Progress& progress) {
  std::vector<std::uint32_t> becomes(points.size());
  weldEqual(points, becomes);
  progress.check();
  if (!(distance > 0) || points.empty())
    return becomes;
  Box box;
  for (const Vec3d& p : points)
    box.add(p);
  double extent = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    extent = std::max({extent, std::abs(box.low[axis]), std::abs(box.high[axis])});
  // Below the resolution of the coordinates, close points are equal.
  if (distance > 1e-16 * extent)
    weldNear(points, distance, becomes, progress);
  return becomes;
}

std::vector<std::uint32_t> weldedCorners(const TriangleMesh& mesh, Progress& progress) {
  const std::vector<std::uint32_t> becomes = weldPoints(mesh.points, 0, progress);
  std::vector<std::uint32_t> corners(mesh.triangles.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = becomes[mesh.triangles[i]];
  return corners;
}

} // namespace tetvdb
