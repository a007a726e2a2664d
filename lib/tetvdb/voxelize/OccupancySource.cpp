// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/OccupancySource.h"

#include "tetvdb/voxelize/BitSink.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

constexpr int kCubeBits = 5; // a cube has 2^5 nodes along an axis

std::int32_t cubeOf(std::int32_t node) {
  return node >> kCubeBits;
}

int stackOf(std::int32_t x, std::int32_t y) {
  return (x & (kStackNodes - 1)) * kStackNodes + (y & (kStackNodes - 1));
}

/// Cubes that a face is in or within a voxel of; some that it is not far from may be among them.
class NearCubes {
public:
  using Cube = std::array<std::int32_t, 3>;

  void add(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
    const auto cubes = [](double low, double high) {
      const auto at = [](double voxel) {
        return static_cast<std::int32_t>(std::floor(voxel / kRootChildSize));
      };
      return std::pair(at(low * kVoxelsPerUnit - kMargin), at(high * kVoxelsPerUnit + kMargin));
    };
    const auto [x0, x1] = cubes(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}));
    const auto [y0, y1] = cubes(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}));
    const auto [z0, z1] = cubes(std::min({a.z, b.z, c.z}), std::max({a.z, b.z, c.z}));
    if (x0 == x1 && y0 == y1 && z0 == z1) {
      insert({x0, y0, z0});
      return;
    }
    // The plane in voxels; rounding is far below the margin, which is more than a voxel.
    const auto minus = [](const LatticePoint& p, const LatticePoint& q) {
      return std::array<double, 3>{(p.x - q.x) * kVoxelsPerUnit, (p.y - q.y) * kVoxelsPerUnit,
                                   (p.z - q.z) * kVoxelsPerUnit};
    };
    const auto u = minus(b, a), v = minus(c, a);
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                         u[0] * v[1] - u[1] * v[0]};
    const double reach =
        (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2])) * (kRootChildSize / 2.0 + kMargin);
    for (std::int32_t x = x0; x <= x1; ++x)
      for (std::int32_t y = y0; y <= y1; ++y)
        for (std::int32_t z = z0; z <= z1; ++z) {
          const auto from = [](std::int32_t cube, double point) {
            return (cube + 0.5) * kRootChildSize - point * kVoxelsPerUnit;
          };
          if (std::abs(n[0] * from(x, a.x) + n[1] * from(y, a.y) + n[2] * from(z, a.z)) <= reach)
            insert({x, y, z});
        }
  }
  void add(const NearCubes& other) { cubes_.insert(other.cubes_.begin(), other.cubes_.end()); }
  bool contains(const Cube& cube) const { return cubes_.count(cube) != 0; }

private:
  static constexpr double kMargin = 4;

  void insert(const Cube& cube) {
    if (last_ == cube && !cubes_.empty())
      return;
    last_ = cube;
    cubes_.insert(cube);
  }

  std::set<Cube> cubes_;
  Cube last_{};
};

} // namespace

OccupancySource::OccupancySource(const SnappedMesh& mesh, const Boundary& boundary,
                                 const FillOptions& fill, VoxelRule rule, Progress& progress)
    : rule_(rule), stacks_(mesh, boundary, fill, progress) {
  if (rule != VoxelRule::Centre)
    ruled_.emplace(mesh, boundary, progress);
  findColumns();
  findCubes(mesh, boundary, fill.holes == nullptr, progress);
}

void OccupancySource::findColumns() {
  std::map<std::pair<std::int32_t, std::int32_t>, std::map<int, Place>> found;
  const auto place = [&](std::int32_t x, std::int32_t y, std::int32_t zBegin,
                         std::int32_t zEnd) -> Place& {
    const int stack = stackOf(x, y);
    const auto [at, added] = found[{cubeOf(x), cubeOf(y)}].try_emplace(stack);
    Place& result = at->second;
    result.stack = stack;
    result.zBegin = added ? zBegin : std::min(result.zBegin, zBegin);
    result.zEnd = added ? zEnd : std::max(result.zEnd, zEnd);
    return result;
  };
  for (const BoundaryStacks::Column& column : stacks_.columns())
    place(column.x, column.y, column.zBegin, column.zEnd).column = &column;
  for (std::size_t i = 0; ruled_ && i < ruled_->size(); ++i) {
    const NodeIndex& node = ruled_->node(i);
    Place& one = place(node[0], node[1], node[2], node[2] + 1);
    if (one.ruledEnd == 0)
      one.ruledBegin = i;
    one.ruledEnd = i + 1;
  }
  for (auto& [where, places] : found) {
    CubeColumn column;
    std::tie(column.x, column.y) = where;
    for (const auto& [stack, one] : places)
      column.places.push_back(one);
    columns_.push_back(std::move(column));
  }
}

void OccupancySource::findCubes(const SnappedMesh& mesh, const Boundary& boundary, bool closed,
                                Progress& progress) {
  tbb::enumerable_thread_specific<NearCubes> locals;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, boundary.faces.size(), 4096),
                    [&](const auto& range) {
                      progress.check();
                      NearCubes& own = locals.local();
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        const BoundaryFace& f = boundary.faces[i];
                        own.add(mesh.points[f.a], mesh.points[f.b], mesh.points[f.c]);
                      }
                    });
  NearCubes near;
  for (const NearCubes& own : locals)
    near.add(own);

  struct Candidate {
    std::size_t column;
    std::int32_t z;
    bool quiet, full = false;
  };
  std::vector<Candidate> candidates;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const CubeColumn& column = columns_[c];
    std::int32_t low = column.places.front().zBegin, high = column.places.front().zEnd;
    for (const Place& place : column.places) {
      low = std::min(low, place.zBegin);
      high = std::max(high, place.zEnd);
    }
    for (std::int32_t z = cubeOf(low); z <= cubeOf(high - 1); ++z)
      candidates.push_back({c, z, closed && !near.contains({column.x, column.y, z})});
  }
  tbb::parallel_for(std::size_t(0), candidates.size(), [&](std::size_t i) {
    progress.check();
    Candidate& one = candidates[i];
    one.full = isFull(columns_[one.column], one.z, one.quiet);
  });
  for (const Candidate& one : candidates) {
    if (one.quiet && !one.full)
      continue;
    cubes_.push_back({{columns_[one.column].x * kRootChildSize,
                       columns_[one.column].y * kRootChildSize, one.z * kRootChildSize},
                      one.full});
    columnOf_.push_back(one.column);
  }
}

// A cube that no face comes near is full or empty: no line between two of its voxel centres meets a
// face. `z` is in cubes.
bool OccupancySource::isFull(const CubeColumn& column, std::int32_t z, bool quiet) const {
  if (column.places.size() < static_cast<std::size_t>(kStacksPerCube))
    return false; // no voxel is inside without faces below it
  const auto stackIsFull = [&](int stack) {
    Carried carried;
    BitStack bits;
    BitSink sink(z * kStackNodes, bits);
    rasterize(column, column.places[static_cast<std::size_t>(stack)], z * kStackNodes,
              (z + 1) * kStackNodes, carried, sink);
    return std::all_of(bits.states.begin(), bits.states.end(),
                       [](NodeState state) { return state == NodeState::Full; });
  };
  constexpr int kLast = kStackNodes - 1;
  for (const int stack : {stackOf(0, 0), stackOf(kLast, kLast), stackOf(0, kLast),
                          stackOf(kLast, 0), stackOf(kStackNodes / 2, kStackNodes / 2)}) {
    if (!stackIsFull(stack))
      return false;
    if (quiet)
      return true;
  }
  for (int stack = 0; stack < kStacksPerCube; ++stack)
    if (!stackIsFull(stack))
      return false;
  return true;
}

std::vector<std::uint64_t> OccupancySource::weights() const {
  constexpr std::uint64_t kNodeWeight = 64; // of a node that faces meet
  std::vector<std::uint64_t> weights(cubes_.size(), 1);
  tbb::parallel_for(std::size_t(0), cubes_.size(), [&](std::size_t i) {
    const std::int32_t low = cubes_[i].origin[2] / kNodeSize;
    for (const Place& place : columns_[columnOf_[i]].places)
      if (place.column != nullptr)
        weights[i] += kNodeWeight * stacks_.countNodes(*place.column, low, low + kStackNodes);
  });
  return weights;
}

void OccupancySource::restrict(std::size_t begin, std::size_t end) {
  const auto at = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
  cubes_ = {cubes_.begin() + at(begin), cubes_.begin() + at(end)};
  columnOf_ = {columnOf_.begin() + at(begin), columnOf_.begin() + at(end)};
}

void OccupancySource::beginColumn(std::size_t column) {
  if (carriedColumn_ == column)
    return;
  carriedColumn_ = column;
  carried_.clear();
  carried_.resize(static_cast<std::size_t>(kStacksPerCube));
}

std::vector<int> OccupancySource::begin(std::size_t cube) {
  cube_ = cube;
  beginColumn(columnOf_[cube]);
  const std::int32_t low = cubes_[cube].origin[2] / kNodeSize, high = low + kStackNodes;
  std::vector<int> stacks;
  for (const Place& place : columns_[carriedColumn_].places)
    if (place.zBegin < high && place.zEnd > low)
      stacks.push_back(place.stack);
  return stacks;
}

void OccupancySource::fill(int stack, BitStack& out) {
  const CubeColumn& column = columns_[carriedColumn_];
  const auto place =
      std::lower_bound(column.places.begin(), column.places.end(), stack,
                       [](const Place& one, int wanted) { return one.stack < wanted; });
  const std::int32_t low = cubes_[cube_].origin[2] / kNodeSize;
  BitSink sink(low, out);
  rasterize(column, *place, low, low + kStackNodes, carried_[static_cast<std::size_t>(stack)],
            sink);
}

// Of the column at (x, y) in cubes; as many as there are: none.
std::size_t OccupancySource::findColumn(std::int32_t x, std::int32_t y) const {
  const auto column = std::lower_bound(
      columns_.begin(), columns_.end(), std::pair(x, y),
      [](const CubeColumn& one, const auto& wanted) { return std::pair(one.x, one.y) < wanted; });
  return column == columns_.end() || column->x != x || column->y != y
             ? columns_.size()
             : static_cast<std::size_t>(column - columns_.begin());
}

std::vector<const OccupancySource::Place*> OccupancySource::placesIn(const CubeColumn& column,
                                                                     const NodeBox& box) {
  std::vector<const Place*> places;
  for (const Place& place : column.places) {
    const std::int32_t x = column.x * kStackNodes + place.stack / kStackNodes;
    const std::int32_t y = column.y * kStackNodes + place.stack % kStackNodes;
    if (x >= box.low[0] && x < box.high[0] && y >= box.low[1] && y < box.high[1] &&
        place.zBegin < box.high[2] && place.zEnd > box.low[2])
      places.push_back(&place);
  }
  return places;
}

void OccupancySource::rasterize(const NodeBox& box, NodeSink& sink) {
  const std::size_t found = findColumn(cubeOf(box.low[0]), cubeOf(box.low[1]));
  if (found == columns_.size())
    return;
  beginColumn(found);
  const std::vector<const Place*> places = placesIn(columns_[found], box);
  tbb::parallel_for(std::size_t(0), places.size(), [&](std::size_t i) {
    rasterize(columns_[found], *places[i], box.low[2], box.high[2],
              carried_[static_cast<std::size_t>(places[i]->stack)], sink);
  });
}

void OccupancySource::peek(const NodeBox& box, NodeSink& sink) const {
  for (std::int32_t x = cubeOf(box.low[0]); x <= cubeOf(box.high[0] - 1); ++x)
    for (std::int32_t y = cubeOf(box.low[1]); y <= cubeOf(box.high[1] - 1); ++y) {
      const std::size_t found = findColumn(x, y);
      if (found == columns_.size())
        continue;
      const std::vector<const Place*> places = placesIn(columns_[found], box);
      tbb::parallel_for(std::size_t(0), places.size(), [&](std::size_t i) {
        Carried carried;
        if (found == carriedColumn_)
          carried = carried_[static_cast<std::size_t>(places[i]->stack)];
        rasterize(columns_[found], *places[i], box.low[2], box.high[2], carried, sink);
      });
    }
}

// Nodes low <= z < high.
void OccupancySource::rasterize(const CubeColumn& column, const Place& place, std::int32_t low,
                                std::int32_t high, Carried& carried, NodeSink& sink) const {
  const NodeIndex first{column.x * kStackNodes + place.stack / kStackNodes,
                        column.y * kStackNodes + place.stack % kStackNodes, low};
  std::optional<RuleSink> rule;
  NodeSink* next = &sink;
  if (ruled_) {
    const NodeIndex last{first[0], first[1], high};
    rule.emplace(sink, *ruled_, rule_, ruled_->lowerBound(first), ruled_->lowerBound(last));
    next = &*rule;
  }
  if (place.column != nullptr && place.column->zEnd > low && place.column->zBegin < high) {
    const BoundaryStacks::Column& crossed = *place.column;
    if (!carried.begun || carried.z > low) {
      carried = Carried();
      carried.begun = true;
      carried.z = crossed.zBegin;
    }
    if (carried.z < low)
      stacks_.rasterize(crossed, carried.z, low, carried.sums, nullptr);
    const std::int32_t from = std::max(low, carried.z);
    stacks_.rasterize(crossed, from, high, carried.sums, next);
    carried.z = high;
  }
  if (rule)
    rule->finish();
}

} // namespace tetvdb
