// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/Coverage.h"

#include "nanovdb_kernels/CoverageJob.h"
#include "tetvdb/core/GroupItems.h"
#include "tetvdb/fields/SlabStack.h"
#include "tetvdb/volume/TreeAssembly.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

using covered::CubePoints;
using covered::ExactSum;
using covered::SlabPart;
using covered::SlabStack;
using covered::SlabSums;
using covered::SlabVolumes;
using covered::StackState;

CubePoints cubePoints(const std::vector<Vec3d>& points, const GridTransform& transform) {
  CubePoints result(points.size());
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, points.size(), 16384), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
          for (std::size_t k = 0; k < 3; ++k)
            result[i][k] = (points[i][k] - transform.origin[k]) / transform.voxelSize[k] + 0.5;
      });
  return result;
}

// Twice the area of a triangle seen along z: above 0 if it is counter-clockwise.
double area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

GroupedItems<FaceInSlab> facesBySlab(const CubePoints& points, const Boundary& boundary,
                                     Progress& progress) {
  const auto addSlabs = [&](std::size_t i, std::vector<FaceInSlab>& out) {
    const BoundaryFace& f = boundary.faces[i];
    const Vec3d &a = points[f.a], &b = points[f.b], &c = points[f.c];
    const double projected = area(a, b, c);
    if (projected == 0)
      return;
    const auto low = [&](std::size_t k) {
      return static_cast<std::int64_t>(std::floor(std::min({a[k], b[k], c[k]})));
    };
    const auto high = [&](std::size_t k) {
      return static_cast<std::int64_t>(std::ceil(std::max({a[k], b[k], c[k]}))) - 1;
    };
    // The plane's height, for faces in many slabs.
    const double slopeX =
        ((b[2] - a[2]) * (c[1] - a[1]) - (c[2] - a[2]) * (b[1] - a[1])) / projected;
    const double slopeY =
        ((c[2] - a[2]) * (b[0] - a[0]) - (b[2] - a[2]) * (c[0] - a[0])) / projected;
    const std::int64_t zLow = low(2), zHigh = high(2);
    for (auto x = low(0) >> 3; x <= high(0) >> 3; ++x)
      for (auto y = nodeOf(low(1)); y <= nodeOf(high(1)); ++y) {
        const double dx = static_cast<double>(x) * kLeafSize + 4 - a[0];
        const double dy = static_cast<double>(y) * kNodeSize + 64 - a[1];
        const double midpoint = a[2] + slopeX * dx + slopeY * dy;
        const double reach = 4 * std::abs(slopeX) + 64 * std::abs(slopeY) + 1;
        // Steep planes, and slivers with inaccurate slopes, keep the whole range.
        auto from = zLow, to = zHigh;
        if (reach < 4096) {
          from = std::max(from, static_cast<std::int64_t>(std::floor(midpoint - reach)));
          to = std::min(to, static_cast<std::int64_t>(std::ceil(midpoint + reach)));
        }
        for (auto z = nodeOf(from); z <= nodeOf(std::max(from, to)); ++z)
          out.push_back({static_cast<std::int32_t>(x), y, z, static_cast<std::uint32_t>(i)});
      }
  };
  return groupItems<FaceInSlab>(boundary.faces.size(), 4096, addSlabs, progress);
}

// Passes the slabs of each node to `assembly` as one node.
void assemble(std::vector<SlabPart>& parts, TreeAssembly<openvdb::FloatTree>& assembly) {
  tbb::parallel_sort(parts.begin(), parts.end(), [](const SlabPart& a, const SlabPart& b) {
    return std::tie(a.node, a.slab) < std::tie(b.node, b.slab);
  });
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (i == 0 || parts[i].node != parts[i - 1].node)
      starts.push_back(i);
  starts.push_back(parts.size());
  tbb::parallel_for(std::size_t(0), starts.size() - 1, [&](std::size_t i) {
    const NodeIndex& index = parts[starts[i]].node;
    auto node = assembly.begin(index);
    for (std::size_t k = starts[i]; k != starts[i + 1]; ++k) {
      SlabPart& part = parts[k];
      for (int leaf = 0; part.full && leaf < kLeavesInSlab; ++leaf)
        node->addTile(static_cast<openvdb::Index>((part.slab << 8) | leaf), 1.0f, true);
      for (auto& [offset, leaf] : part.leaves) {
        if (leaf)
          node->addLeaf(leaf.release());
        else
          node->addTile(offset, 1.0f, true);
      }
    }
    assembly.end(std::move(node), index);
  });
}

void requireClosed(const SlabStack& stack) {
  if (!stack.closes())
    throw std::logic_error("the boundary does not close: volume was carried out of it");
}

// Of stacks, in their order.
openvdb::FloatGrid::Ptr gridOf(std::vector<std::vector<SlabPart>>& found,
                               const GridTransform& transform) {
  std::vector<SlabPart> parts;
  for (std::vector<SlabPart>& own : found)
    parts.insert(parts.end(), std::make_move_iterator(own.begin()),
                 std::make_move_iterator(own.end()));
  TreeAssembly<openvdb::FloatTree> assembly(0.0f);
  assemble(parts, assembly);
  return assembly.finish("coverage", openvdb::GRID_FOG_VOLUME, transform);
}

// Where the pairs of each stack begin, and the end.
std::vector<std::size_t> stackStarts(const GroupedItems<FaceInSlab>& pairs) {
  std::vector<std::size_t> starts;
  for (std::size_t slab = 0; slab < pairs.groupCount(); ++slab)
    if (slab == 0 || !pairs.firstOf(slab).sameStack(pairs.firstOf(slab - 1)))
      starts.push_back(pairs.starts[slab]);
  starts.push_back(pairs.items.size());
  return starts;
}

} // namespace

struct CoverageParts::Parts {
  Parts(const std::vector<Vec3d>& points, const Boundary& boundary, const GridTransform& where,
        Progress& progress)
      : faces(boundary), transform(where), cubes(cubePoints(points, where)),
        pairs(facesBySlab(cubes, boundary, progress)), starts(stackStarts(pairs)) {}

  const FaceInSlab& first(std::size_t stack) const { return pairs.items[starts[stack]]; }
  /// Adds slabs zBegin <= z < zEnd of a stack to `out`; those below are made again where they are
  /// not what was done last.
  ExactSum run(std::size_t stack, std::int32_t zBegin, std::int32_t zEnd, StackState& state,
               std::vector<SlabPart>& out);

  const Boundary& faces;
  GridTransform transform;
  CubePoints cubes;
  GroupedItems<FaceInSlab> pairs;
  std::vector<std::size_t> starts; ///< of stacks
  ExactSum sum;
  NodeIndex column{0, 0, 0}; ///< of cubes, that `states` are of
  std::unordered_map<std::size_t, StackState> states;
  tbb::enumerable_thread_specific<SlabVolumes> volumes;
};

ExactSum CoverageParts::Parts::run(std::size_t stack, std::int32_t zBegin, std::int32_t zEnd,
                                   StackState& state, std::vector<SlabPart>& out) {
  const FaceInSlab* const own = pairs.items.data() + starts[stack];
  const std::size_t count = starts[stack + 1] - starts[stack];
  if (state.next > 0 && state.z > zBegin)
    state = {};
  std::vector<SlabPart> below;
  // The part of the stack up to z, as far as it is not done.
  const auto upTo = [&](std::int32_t z, std::vector<SlabPart>& parts) {
    SlabStack slabs(cubes, faces, parts);
    slabs.resume(state);
    std::size_t end = state.next;
    while (end < count && own[end].z < z)
      ++end;
    if (end > state.next) {
      if (state.next > 0)
        slabs.fill(own[0], state.z, own[state.next].z);
      slabs.run(own + state.next, own + end, volumes.local());
      state.z = own[end - 1].z + 1;
      state.next = end;
    }
    if (end == count) {
      requireClosed(slabs);
    } else if (end > 0) {
      slabs.fill(own[0], state.z, z);
      state.z = std::max(state.z, z);
    }
    slabs.suspend(state);
    return slabs.sum();
  };
  if (own[0].z < zBegin && (state.next == 0 || state.z < zBegin))
    upTo(zBegin, below);
  below.clear();
  return upTo(zEnd, out);
}

CoverageParts::CoverageParts(const std::vector<Vec3d>& points, const Boundary& faces,
                             const GridTransform& transform, Progress& progress)
    : parts_(std::make_unique<Parts>(points, faces, transform, progress)) {}
CoverageParts::~CoverageParts() = default;

void CoverageParts::begin() {
  parts_->states.clear();
  parts_->sum = {};
}

CoverageSum CoverageParts::sum() const {
  return parts_->sum.inVoxels();
}

openvdb::FloatGrid::Ptr CoverageParts::grid(const NodeBox& box, Progress& progress) {
  constexpr int kCubeBits = 5; // a cube has 2^5 nodes along an axis
  Parts& all = *parts_;
  const NodeIndex column{box.low[0] >> kCubeBits, box.low[1] >> kCubeBits, 0};
  if (column != all.column)
    all.states.clear();
  all.column = column;
  const LargeVector<FaceInSlab>& pairs = all.pairs.items;
  std::vector<std::size_t> stacks;
  for (std::int32_t x = box.low[0] * kLeavesAlong; x < box.high[0] * kLeavesAlong; ++x) {
    const auto begin =
        std::lower_bound(all.starts.begin(), all.starts.end() - 1, std::pair(x, box.low[1]),
                         [&](std::size_t start, const auto& wanted) {
                           return std::pair(pairs[start].x, pairs[start].y) < wanted;
                         });
    for (auto at = begin;
         at != all.starts.end() - 1 && pairs[*at].x == x && pairs[*at].y < box.high[1]; ++at)
      if (pairs[*at].z < box.high[2] && pairs[at[1] - 1].z >= box.low[2])
        stacks.push_back(static_cast<std::size_t>(at - all.starts.begin()));
  }
  std::vector<StackState*> states;
  states.reserve(stacks.size());
  for (const std::size_t stack : stacks)
    states.push_back(&all.states[stack]);
  std::vector<std::vector<SlabPart>> found(stacks.size());
  std::vector<ExactSum> sums(stacks.size());
  tbb::parallel_for(std::size_t(0), stacks.size(), [&](std::size_t i) {
    progress.check();
    sums[i] = all.run(stacks[i], box.low[2], box.high[2], *states[i], found[i]);
  });
  for (const ExactSum& sum : sums)
    all.sum.add(sum);
  return gridOf(found, all.transform);
}

struct CoverageFaces::Placed {
  CubePoints cubes;
  GroupedItems<FaceInSlab> pairs;
};

CoverageFaces::CoverageFaces(const std::vector<Vec3d>& points, const Boundary& faces,
                             const GridTransform& transform, Progress& progress)
    : faces_(faces), transform_(transform), placed_(std::make_unique<Placed>()) {
  placed_->cubes = cubePoints(points, transform);
  placed_->pairs = facesBySlab(placed_->cubes, faces, progress);
}
CoverageFaces::~CoverageFaces() = default;

nano::CoverageJob CoverageFaces::job() const {
  static_assert(sizeof(BoundaryFace) == 4 * sizeof(std::uint32_t));
  nano::CoverageJob job;
  job.points = placed_->cubes.data();
  job.pointCount = placed_->cubes.size();
  job.faces = reinterpret_cast<const std::uint32_t*>(faces_.faces.data());
  job.faceCount = faces_.faces.size();
  job.pairs = placed_->pairs.items.data();
  job.starts = placed_->pairs.starts.data();
  job.slabCount = placed_->pairs.groupCount();
  for (std::size_t k = 0; k < 3; ++k) {
    job.voxelSize[k] = transform_.voxelSize[k];
    job.origin[k] = transform_.origin[k];
  }
  return job;
}

openvdb::FloatGrid::Ptr coverage(const std::vector<Vec3d>& points, const Boundary& faces,
                                 const GridTransform& transform, CoverageSum& sum,
                                 Progress& progress) {
  const CubePoints cubes = cubePoints(points, transform);
  const GroupedItems<FaceInSlab> pairs = facesBySlab(cubes, faces, progress);
  const std::vector<std::size_t> starts = stackStarts(pairs);
  std::vector<std::vector<SlabPart>> found(starts.size() - 1);
  std::vector<ExactSum> sums(starts.size() - 1);
  tbb::enumerable_thread_specific<SlabVolumes> volumes;
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, found.size(), 1),
      [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          SlabStack stack(cubes, faces, found[i]);
          stack.run(pairs.items.data() + starts[i], pairs.items.data() + starts[i + 1],
                    volumes.local());
          requireClosed(stack);
          sums[i] = stack.sum();
          progress.update(static_cast<double>(++done) / static_cast<double>(found.size()));
        }
      },
      tbb::simple_partitioner());

  ExactSum exact;
  for (const ExactSum& own : sums)
    exact.add(own);
  sum = exact.inVoxels();
  return gridOf(found, transform);
}

} // namespace tetvdb
