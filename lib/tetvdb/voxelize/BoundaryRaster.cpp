// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/BoundaryRaster.h"

#include "tetvdb/core/JoinedVectors.h"
#include "tetvdb/voxelize/FaceRaster.h"
#include "tetvdb/voxelize/RimBand.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bitset>
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

// In place of a face: the node has voxels at which the rim has to be looked at.
constexpr std::uint32_t kRimInNode = 0xFFFFFFFFu;

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
                                 const FillOptions& fill, Progress& progress) {
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
  auto all = joinedVectors<FaceInNode>(locals);
  if (fill.rim != nullptr)
    for (const NodeIndex& node : RimBand(*fill.rim, progress).nodes())
      all.push_back({node[0], node[1], node[2], kRimInNode});
  tbb::parallel_sort(all.begin(), all.end());
  return all;
}

// What a slab's rows have come to at its bottom, carried up from node to node.
struct SlabCarry {
  /// The whole number nearest to the winding number: signed crossings, plus `rims` for open soups.
  std::array<std::int32_t, kSlabRows> sums{};
  std::vector<std::int32_t> rims; ///< empty: all 0
  bool uniform = true;            // all rows have sums[0]

  void refreshUniform() {
    std::int32_t differs = 0;
    for (std::int32_t s : sums)
      differs |= s ^ sums[0];
    uniform = differs == 0;
  }
};

bool isInside(std::int32_t sum, FillRule rule) {
  switch (rule) {
  case FillRule::Positive:
    break;
  case FillRule::NonZero:
    return sum != 0;
  case FillRule::Odd:
    return (sum & 1) != 0;
  }
  return sum > 0;
}

// RimWinding at the voxels of a slab where it matters.
struct SlabRim {
  SlabBits flags;
  std::vector<double> values; // of row r, voxel z at [r * 128 + z]

  SlabRim() : values(std::size_t(kSlabRows) * kNodeSize) {}

  // `leaves`: of the slab's node.
  void look(const RimBand& band, const NodeIndex& node, int slab, const std::bitset<4096>& leaves) {
    std::memset(&flags, 0, sizeof flags);
    RimBand::Leaf leaf;
    for (int i = 0; i < 256; ++i) {
      if (!leaves[static_cast<std::size_t>(slab * 256 + i)])
        continue;
      const int y0 = i / 16 * kLeafSize, z0 = i % 16 * kLeafSize;
      band.look({node[0] * kNodeSize + slab * kLeafSize, node[1] * kNodeSize + y0,
                 node[2] * kNodeSize + z0},
                leaf);
      for (int x = 0; x < kLeafSize; ++x)
        for (int y = 0; y < kLeafSize; ++y) {
          const int row = x * kNodeSize + y0 + y;
          flags.rows[row][z0 >> 6] |= (leaf.flags[static_cast<std::size_t>(x)] >> (8 * y) & 0xFF)
                                      << (z0 & 63);
          std::copy_n(leaf.values.data() + x * 64 + y * 8, kLeafSize,
                      values.data() + row * kNodeSize + z0);
        }
    }
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

// A row's crossings: bits, and what is more than a bit a voxel.
struct RowCrossings {
  const std::uint64_t *entering, *leaving;
  const SlabCrossings::Extra *extra, *extraEnd;
};

// Calls visit(z, sum) with the sum of the crossings up to every voxel of the row.
template <typename Visit>
void countCrossings(RowCrossings row, std::int32_t sum, const Visit& visit) {
  for (int z = 0; z < kNodeSize; ++z) {
    sum += static_cast<std::int32_t>(row.entering[z >> 6] >> (z & 63) & 1);
    sum -= static_cast<std::int32_t>(row.leaving[z >> 6] >> (z & 63) & 1);
    for (; row.extra != row.extraEnd && row.extra->z == z; ++row.extra)
      sum += row.extra->weight;
    visit(z, sum);
  }
}

void setVoxel(std::uint64_t* row, int z) {
  row[z >> 6] |= std::uint64_t(1) << (z & 63);
}

// One row by counting, where the sum leaves {0, 1}.
void countRow(const RowCrossings& row, FillRule rule, std::int32_t& sum, std::uint64_t* inside) {
  std::uint64_t out[2] = {0, 0};
  std::int32_t last = sum;
  countCrossings(row, sum, [&](int z, std::int32_t s) {
    last = s;
    if (isInside(s, rule))
      setVoxel(out, z);
  });
  sum = last;
  inside[0] = out[0];
  inside[1] = out[1];
}

// One row past voxels where the rim has to be looked at.
void countRowWithRim(const RowCrossings& row, FillRule rule, const std::uint64_t* flags,
                     const double* values, std::int32_t& sum, std::int32_t& rim,
                     std::uint64_t* inside) {
  std::uint64_t out[2] = {0, 0};
  std::int32_t last = sum;
  countCrossings(row, sum - rim, [&](int z, std::int32_t crossings) {
    if ((flags[z >> 6] >> (z & 63) & 1) != 0)
      rim = nearestWinding(crossings + values[z]) - crossings;
    last = crossings + rim;
    if (isInside(last, rule))
      setVoxel(out, z);
  });
  sum = last;
  inside[0] = out[0];
  inside[1] = out[1];
}

// Turns crossings into occupancy, in place of the entering bits, and advances the carry. Returns
// whether any voxel is inside.
//
// While the sum stays in {0, 1} it is the parity of the crossings, and parity is 64 voxels at a
// time. It does stay there if every entering crossing is followed by a set voxel and every leaving
// one by a clear one; the rows where that fails are counted.
bool sumCrossings(SlabCrossings& crossings, FillRule rule, const SlabRim* rim, SlabCarry& carry) {
  std::sort(crossings.extra.begin(), crossings.extra.end(), [](const auto& a, const auto& b) {
    return std::tie(a.row, a.z, a.weight) < std::tie(b.row, b.z, b.weight);
  });
  if (rim != nullptr)
    carry.rims.resize(kSlabRows);
  RowCrossings row{};
  row.extraEnd = crossings.extra.data();
  const SlabCrossings::Extra* const end = row.extraEnd + crossings.extra.size();
  std::uint64_t any = 0;
  for (std::int32_t r = 0; r < kSlabRows; ++r) {
    std::uint64_t* in = crossings.entering.rows[r];
    const std::uint64_t* out = crossings.leaving.rows[r];
    std::int32_t& sum = carry.sums[static_cast<std::size_t>(r)];
    row.entering = in;
    row.leaving = out;
    row.extra = row.extraEnd;
    while (row.extraEnd != end && row.extraEnd->row == r)
      ++row.extraEnd;

    if (rim != nullptr && (rim->flags.rows[r][0] | rim->flags.rows[r][1]) != 0) {
      countRowWithRim(row, rule, rim->flags.rows[r],
                      rim->values.data() + std::size_t(r) * kNodeSize, sum,
                      carry.rims[static_cast<std::size_t>(r)], in);
      any |= in[0] | in[1];
      continue;
    }
    bool counted = row.extra != row.extraEnd || (sum & ~1) != 0;
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
      countRow(row, rule, sum, in);
    any |= in[0] | in[1];
  }
  carry.refreshUniform();
  return any != 0;
}

// A slab without crossings: every row is full or empty by its carry.
bool extendRows(const SlabCarry& carry, FillRule rule, SlabBits& bits) {
  bool any = false;
  for (std::size_t r = 0; r < kSlabRows; ++r) {
    const std::uint64_t word = isInside(carry.sums[r], rule) ? ~0ull : 0ull;
    bits.rows[r][0] = bits.rows[r][1] = word;
    any = any || word != 0;
  }
  return any;
}

// What a thread works in.
struct Scratch {
  SlabCrossings crossings;
  std::unique_ptr<SlabRim> rim; // made when first needed
};

class Stack {
public:
  Stack(const SnappedMesh& mesh, const Boundary& boundary, const FillOptions& fill, NodeSink& sink,
        const Progress& progress, bool splitNodes)
      : mesh_(mesh), boundary_(boundary), fill_(fill), sink_(sink), progress_(progress),
        carries_(kSlabsPerNode), grain_(splitNodes ? 1 : kSlabsPerNode) {}

  using Pairs = const FaceInNode*;

  void run(Pairs begin, Pairs end, tbb::enumerable_thread_specific<Scratch>& scratch) {
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
    // Above the last face nothing is inside: the faces close, or far from the rim its share ends.
    const std::int32_t open = fill_.rule == FillRule::Odd ? 1 : ~0;
    for (const SlabCarry& carry : carries_)
      if (std::any_of(carry.sums.begin(), carry.sums.end(),
                      [open](std::int32_t sum) { return (sum & open) != 0; }))
        throw std::logic_error("the boundary does not close: crossings were lost");
  }

private:
  // Nodes that no face meets, from zBegin to zEnd.
  void fill(std::int32_t x, std::int32_t y, std::int32_t zBegin, std::int32_t zEnd) {
    if (zBegin == zEnd)
      return;
    bool uniform = true;
    for (const SlabCarry& carry : carries_)
      uniform = uniform && carry.uniform &&
                isInside(carry.sums[0], fill_.rule) == isInside(carries_[0].sums[0], fill_.rule);
    if (uniform) {
      if (isInside(carries_[0].sums[0], fill_.rule))
        sink_.fullRun(x, y, zBegin, zEnd);
      return;
    }
    const auto bits = std::make_unique<SlabBits>();
    for (std::int32_t z = zBegin; z < zEnd; ++z) {
      std::unique_ptr<NodeSink::Node> node = sink_.begin({x, y, z});
      for (int s = 0; s < kSlabsPerNode; ++s)
        if (extendRows(carries_[static_cast<std::size_t>(s)], fill_.rule, *bits))
          sink_.slab(*node, s, *bits, nullptr);
      sink_.end(std::move(node));
    }
  }

  void node(std::int32_t x, std::int32_t y, std::int32_t z, Pairs begin, Pairs end,
            tbb::enumerable_thread_specific<Scratch>& scratch) {
    std::unique_ptr<NodeSink::Node> node = sink_.begin({x, y, z});
    std::vector<FaceRaster> faces;
    faces.reserve(static_cast<std::size_t>(end - begin));
    std::bitset<4096> rimLeaves;
    for (Pairs p = begin; p != end; ++p)
      if (p->face == kRimInNode)
        rimLeaves = RimBand(*fill_.rim, progress_).leaves({x, y, z});
      else
        faces.push_back(prepare(mesh_, boundary_.faces[p->face]));
    const std::int64_t x0 = std::int64_t(x) * kNodeSize, y0 = std::int64_t(y) * kNodeSize,
                       z0 = std::int64_t(z) * kNodeSize;
    const auto slabs = [&](const tbb::blocked_range<int>& range) {
      Scratch& local = scratch.local();
      SlabCrossings& crossings = local.crossings;
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
        const SlabRim* rim = nullptr;
        if (hasBits(rimLeaves, s)) {
          if (!cleared)
            crossings.clear();
          cleared = true;
          if (local.rim == nullptr)
            local.rim = std::make_unique<SlabRim>();
          local.rim->look(RimBand(*fill_.rim, progress_), {x, y, z}, s, rimLeaves);
          rim = local.rim.get();
        }
        const bool any = cleared ? sumCrossings(crossings, fill_.rule, rim, carry)
                                 : extendRows(carry, fill_.rule, crossings.entering);
        if (any)
          sink_.slab(*node, s, crossings.entering, nullptr);
      }
    };
    // Nothing inside a slab's work waits for other tasks, so the scratch stays this thread's own.
    tbb::parallel_for(tbb::blocked_range<int>(0, kSlabsPerNode, grain_), slabs,
                      tbb::simple_partitioner());
    sink_.end(std::move(node));
  }

  static bool hasBits(const std::bitset<4096>& leaves, int slab) {
    for (std::size_t i = 0; i < 256; ++i)
      if (leaves[static_cast<std::size_t>(slab) * 256 + i])
        return true;
    return false;
  }

  const SnappedMesh& mesh_;
  const Boundary& boundary_;
  const FillOptions& fill_;
  NodeSink& sink_;
  const Progress& progress_;
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

void rasterizeBoundary(const SnappedMesh& mesh, const Boundary& boundary, const FillOptions& fill,
                       NodeSink& sink, Progress& progress) {
  const std::vector<FaceInNode> pairs = binFaces(mesh, boundary, fill, progress);
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (i == 0 || pairs[i].x != pairs[i - 1].x || pairs[i].y != pairs[i - 1].y)
      starts.push_back(i);
  starts.push_back(pairs.size());

  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const bool splitNodes = starts.size() - 1 < 8 * threads;
  tbb::enumerable_thread_specific<Scratch> scratch;
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, starts.size() - 1, 1),
      [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          Stack stack(mesh, boundary, fill, sink, progress, splitNodes);
          stack.run(pairs.data() + starts[i], pairs.data() + starts[i + 1], scratch);
          progress.update(static_cast<double>(++done) / static_cast<double>(starts.size()));
        }
      },
      tbb::simple_partitioner());
}

} // namespace tetvdb
