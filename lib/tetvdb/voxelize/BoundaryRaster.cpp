// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/BoundaryRaster.h"

#include "tetvdb/voxelize/FaceRaster.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#include <tuple>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

// A face that may have crossings in a node.
struct FaceInNode {
  std::int32_t x, y, z;
  std::uint32_t face;
  bool operator<(const FaceInNode& o) const {
    return std::tie(x, y, z, face) < std::tie(o.x, o.y, o.z, o.face);
  }
};

FaceRaster prepare(const SnappedMesh& mesh, const BoundaryFace& f) {
  return {mesh.points[f.a], mesh.points[f.b], mesh.points[f.c], f.weight};
}

std::vector<FaceInNode> binFaces(const SnappedMesh& mesh, const Boundary& boundary,
                                 Progress& progress) {
  tbb::enumerable_thread_specific<std::vector<FaceInNode>> locals;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, boundary.faces.size(), 4096), [&](const auto& range) {
        progress.check();
        auto& out = locals.local();
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const FaceRaster face = prepare(mesh, boundary.faces[i]);
          if (!face.crossesColumns())
            continue;
          for (auto x = nodeOf(face.xMin()); x <= nodeOf(face.xMax()); ++x)
            for (auto y = nodeOf(face.yMin()); y <= nodeOf(face.yMax()); ++y) {
              const std::int64_t x0 = std::int64_t(x) * kNodeSize, y0 = std::int64_t(y) * kNodeSize;
              std::int64_t low, high;
              if (!face.zRange(x0, x0 + kNodeSize - 1, y0, y0 + kNodeSize - 1, low, high))
                continue;
              for (auto z = nodeOf(low); z <= nodeOf(high); ++z)
                out.push_back({x, y, z, static_cast<std::uint32_t>(i)});
            }
        }
      });
  std::vector<FaceInNode> all;
  std::size_t total = 0;
  for (const auto& local : locals)
    total += local.size();
  all.reserve(total);
  for (const auto& local : locals)
    all.insert(all.end(), local.begin(), local.end());
  tbb::parallel_sort(all.begin(), all.end());
  return all;
}

// The sums at the bottom of a slab's rows, carried up from node to node.
struct SlabCarry {
  std::array<std::int32_t, kSlabRows> sums{};
  bool uniform = true; // all rows have sums[0]

  void refreshUniform() {
    std::int32_t differs = 0;
    for (std::int32_t s : sums)
      differs |= s ^ sums[0];
    uniform = differs == 0;
  }
};

// Bit z of the result: parity of the bits at or below z.
std::uint64_t prefixXor(std::uint64_t w) {
  w ^= w << 1;
  w ^= w << 2;
  w ^= w << 4;
  w ^= w << 8;
  w ^= w << 16;
  w ^= w << 32;
  return w;
}

// One row by counting, where the sum leaves {0, 1}: `extra` are the row's crossings beyond the
// bits.
void countRow(const std::uint64_t* entering, const std::uint64_t* leaving,
              const SlabCrossings::Extra* extra, const SlabCrossings::Extra* extraEnd,
              std::int32_t& sum, std::uint64_t* row) {
  std::uint64_t out[2] = {0, 0};
  for (int z = 0; z < kNodeSize; ++z) {
    sum += static_cast<std::int32_t>(entering[z >> 6] >> (z & 63) & 1);
    sum -= static_cast<std::int32_t>(leaving[z >> 6] >> (z & 63) & 1);
    for (; extra != extraEnd && extra->z == z; ++extra)
      sum += extra->weight;
    if (sum > 0)
      out[z >> 6] |= std::uint64_t(1) << (z & 63);
  }
  row[0] = out[0];
  row[1] = out[1];
}

// Turns crossings into occupancy, in place of the entering bits, and advances the carry. Returns
// whether any voxel is inside.
//
// While the sum stays in {0, 1} it is the parity of the crossings, and parity is 64 voxels at a
// time. It does stay there if every entering crossing is followed by a set voxel and every leaving
// one by a clear one; the rows where that fails are counted.
bool sumCrossings(SlabCrossings& crossings, SlabCarry& carry) {
  std::sort(crossings.extra.begin(), crossings.extra.end(), [](const auto& a, const auto& b) {
    return std::tie(a.row, a.z, a.weight) < std::tie(b.row, b.z, b.weight);
  });
  const SlabCrossings::Extra* extra = crossings.extra.data();
  const SlabCrossings::Extra* const extraEnd = extra + crossings.extra.size();
  std::uint64_t any = 0;
  for (int r = 0; r < kSlabRows; ++r) {
    std::uint64_t* in = crossings.entering.rows[r];
    const std::uint64_t* out = crossings.leaving.rows[r];
    std::int32_t& sum = carry.sums[static_cast<std::size_t>(r)];
    const SlabCrossings::Extra* const rowExtra = extra;
    while (extra != extraEnd && extra->row == r)
      ++extra;

    bool counted = extra != rowExtra || (sum & ~1) != 0;
    if (!counted) {
      const std::uint64_t inOnly0 = in[0] & ~out[0], outOnly0 = out[0] & ~in[0];
      const std::uint64_t inOnly1 = in[1] & ~out[1], outOnly1 = out[1] & ~in[1];
      const std::uint64_t low = prefixXor(inOnly0 | outOnly0) ^ (sum != 0 ? ~0ull : 0ull);
      const std::uint64_t high = prefixXor(inOnly1 | outOnly1) ^ ((low >> 63) != 0 ? ~0ull : 0ull);
      counted = ((inOnly0 & ~low) | (outOnly0 & low) | (inOnly1 & ~high) | (outOnly1 & high)) != 0;
      if (!counted) {
        in[0] = low;
        in[1] = high;
        sum = static_cast<std::int32_t>(high >> 63);
      }
    }
    if (counted)
      countRow(in, out, rowExtra, extra, sum, in);
    any |= in[0] | in[1];
  }
  carry.refreshUniform();
  return any != 0;
}

// A slab without crossings: every row is full or empty by its carry.
bool extendRows(const SlabCarry& carry, SlabBits& bits) {
  bool any = false;
  for (std::size_t r = 0; r < kSlabRows; ++r) {
    const std::uint64_t word = carry.sums[r] > 0 ? ~0ull : 0ull;
    bits.rows[r][0] = bits.rows[r][1] = word;
    any = any || word != 0;
  }
  return any;
}

class Stack {
public:
  Stack(const SnappedMesh& mesh, const Boundary& boundary, NodeSink& sink, bool splitNodes)
      : mesh_(mesh), boundary_(boundary), sink_(sink), carries_(kSlabsPerNode),
        grain_(splitNodes ? 1 : kSlabsPerNode) {}

  using Pairs = const FaceInNode*;

  void run(Pairs begin, Pairs end, tbb::enumerable_thread_specific<SlabCrossings>& scratch) {
    const std::int32_t x = begin->x, y = begin->y;
    std::int32_t z = begin->z;
    while (begin != end) {
      fill(x, y, z, begin->z);
      z = begin->z;
      Pairs nodeEnd = begin;
      while (nodeEnd != end && nodeEnd->z == z)
        ++nodeEnd;
      node(x, y, z, begin, nodeEnd, scratch);
      begin = nodeEnd;
      ++z;
    }
    // The boundary of a sum of tets is closed: above its last face nothing is inside.
    for (const SlabCarry& carry : carries_)
      if (!carry.uniform || carry.sums[0] != 0)
        throw std::logic_error("the boundary does not close: crossings were lost");
  }

private:
  // Nodes that no face meets, from zBegin to zEnd.
  void fill(std::int32_t x, std::int32_t y, std::int32_t zBegin, std::int32_t zEnd) {
    if (zBegin == zEnd)
      return;
    bool uniform = true;
    for (const SlabCarry& carry : carries_)
      uniform = uniform && carry.uniform && (carry.sums[0] > 0) == (carries_[0].sums[0] > 0);
    if (uniform) {
      if (carries_[0].sums[0] > 0)
        sink_.fullRun(x, y, zBegin, zEnd);
      return;
    }
    const auto bits = std::make_unique<SlabBits>();
    for (std::int32_t z = zBegin; z < zEnd; ++z) {
      std::unique_ptr<NodeSink::Node> node = sink_.begin({x, y, z});
      for (int s = 0; s < kSlabsPerNode; ++s)
        if (extendRows(carries_[static_cast<std::size_t>(s)], *bits))
          sink_.slab(*node, s, *bits, nullptr);
      sink_.end(std::move(node));
    }
  }

  void node(std::int32_t x, std::int32_t y, std::int32_t z, Pairs begin, Pairs end,
            tbb::enumerable_thread_specific<SlabCrossings>& scratch) {
    std::unique_ptr<NodeSink::Node> node = sink_.begin({x, y, z});
    std::vector<FaceRaster> faces;
    faces.reserve(static_cast<std::size_t>(end - begin));
    for (Pairs p = begin; p != end; ++p)
      faces.push_back(prepare(mesh_, boundary_.faces[p->face]));
    const std::int64_t x0 = std::int64_t(x) * kNodeSize, y0 = std::int64_t(y) * kNodeSize,
                       z0 = std::int64_t(z) * kNodeSize;
    const auto slabs = [&](const tbb::blocked_range<int>& range) {
      SlabCrossings& crossings = scratch.local();
      for (int s = range.begin(); s != range.end(); ++s) {
        const std::int64_t first = x0 + s * kLeafSize;
        SlabCarry& carry = carries_[static_cast<std::size_t>(s)];
        bool cleared = false;
        for (const FaceRaster& face : faces) {
          if (face.xMax() < first || face.xMin() >= first + kLeafSize)
            continue;
          if (!cleared)
            crossings.clear();
          cleared = true;
          face.rasterize(first, y0, z0, crossings);
        }
        const bool any =
            cleared ? sumCrossings(crossings, carry) : extendRows(carry, crossings.entering);
        if (any)
          sink_.slab(*node, s, crossings.entering, nullptr);
      }
    };
    // Nothing inside a slab's work waits for other tasks, so the scratch stays this thread's own.
    tbb::parallel_for(tbb::blocked_range<int>(0, kSlabsPerNode, grain_), slabs,
                      tbb::simple_partitioner());
    sink_.end(std::move(node));
  }

  const SnappedMesh& mesh_;
  const Boundary& boundary_;
  NodeSink& sink_;
  std::vector<SlabCarry> carries_;
  std::size_t grain_;
};

} // namespace

std::uint64_t estimateBoundaryLeaves(const SnappedMesh& mesh, const Boundary& boundary) {
  // A surface patch with projected areas ax, ay, az (voxels squared) meets about
  // (ax + ay + az) / 64 leaves, and at least one where it is smaller.
  double leaves = 0;
  for (const BoundaryFace& f : boundary.faces) {
    const LatticePoint &a = mesh.points[f.a], &b = mesh.points[f.b], &c = mesh.points[f.c];
    const auto area = [&](double LatticePoint::*u, double LatticePoint::*v) {
      return std::abs((b.*u - a.*u) * (c.*v - a.*v) - (b.*v - a.*v) * (c.*u - a.*u)) / 2;
    };
    leaves += area(&LatticePoint::x, &LatticePoint::y) + area(&LatticePoint::y, &LatticePoint::z) +
              area(&LatticePoint::z, &LatticePoint::x);
  }
  return static_cast<std::uint64_t>(leaves * kVoxelsPerUnit * kVoxelsPerUnit / 64) + 64;
}

void rasterizeBoundary(const SnappedMesh& mesh, const Boundary& boundary, NodeSink& sink,
                       Progress& progress) {
  const std::vector<FaceInNode> pairs = binFaces(mesh, boundary, progress);
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (i == 0 || pairs[i].x != pairs[i - 1].x || pairs[i].y != pairs[i - 1].y)
      starts.push_back(i);
  starts.push_back(pairs.size());

  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const bool splitNodes = starts.size() - 1 < 8 * threads;
  tbb::enumerable_thread_specific<SlabCrossings> scratch;
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, starts.size() - 1, 1),
      [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          Stack stack(mesh, boundary, sink, splitNodes);
          stack.run(pairs.data() + starts[i], pairs.data() + starts[i + 1], scratch);
          progress.update(static_cast<double>(++done) / static_cast<double>(starts.size()));
        }
      },
      tbb::simple_partitioner());
}

} // namespace tetvdb
