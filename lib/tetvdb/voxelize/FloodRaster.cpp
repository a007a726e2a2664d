// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/FloodRaster.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/voxelize/ShellRaster.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

using Slabs = std::array<SlabBits, kSlabsPerNode>;

// Stores the nodes that it receives.
class BitNodes : public NodeSink {
public:
  struct Bits : Node {
    NodeIndex index{0, 0, 0};
    std::unique_ptr<Slabs> slabs = std::make_unique<Slabs>();
  };
  std::unique_ptr<Node> begin(const NodeIndex& node) override {
    auto bits = std::make_unique<Bits>();
    bits->index = node;
    std::memset(bits->slabs.get(), 0, sizeof(Slabs));
    return bits;
  }
  void slab(Node& node, int index, const SlabBits& bits, const std::uint32_t*) override {
    (*static_cast<Bits&>(node).slabs)[static_cast<std::size_t>(index)] = bits;
  }
  void end(std::unique_ptr<Node> node) override {
    auto& bits = static_cast<Bits&>(*node);
    const std::lock_guard<std::mutex> lock(mutex_);
    nodes_[bits.index] = std::move(bits.slabs);
  }
  void fullRun(std::int32_t, std::int32_t, std::int32_t, std::int32_t) override {}
  void fullNode(const NodeIndex&, std::uint32_t) override {}

  const std::map<NodeIndex, std::unique_ptr<Slabs>>& nodes() const { return nodes_; }

private:
  std::mutex mutex_;
  std::map<NodeIndex, std::unique_ptr<Slabs>> nodes_;
};

// An interval of a column: one voxel near a face, or a run of voxels that are near no face.
struct Cell {
  std::int32_t first, last;
  bool wall;
};

// Lines reach so far beyond their ends, in voxels, that no face slips between two of them: the
// scene's floats know a place to 1e-7 of the box.
constexpr double kOverlap = 0.01;

constexpr std::int32_t kBelow = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kAbove = std::numeric_limits<std::int32_t>::max();

// A face that crosses the line between two neighbours is within half their distance of one of them.
// With every such voxel a wall, only lines from walls have to be looked at.
class Flood {
public:
  Flood(const BitNodes& walls, const TriangleScene& scene, const GridTransform& transform,
        Progress& progress)
      : walls_(walls), scene_(scene), transform_(transform), progress_(progress) {
    // A column of nodes around the walls is free throughout.
    for (const auto& [index, slabs] : walls.nodes()) {
      low_ = {std::min(low_[0], index[0] - 1), std::min(low_[1], index[1] - 1)};
      high_ = {std::max(high_[0], index[0] + 1), std::max(high_[1], index[1] + 1)};
    }
    width_ = std::size_t(high_[1] - low_[1] + 1) * kNodeSize;
    columns_.resize(std::size_t(high_[0] - low_[0] + 1) * kNodeSize * width_);
  }

  void run() {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, columns_.size(), 4096),
                      [&](const auto& range) {
                        progress_.check();
                        for (std::size_t c = range.begin(); c != range.end(); ++c)
                          fillColumn(c);
                      });
    starts_.resize(columns_.size() + 1, 0);
    for (std::size_t c = 0; c < columns_.size(); ++c)
      starts_[c + 1] = starts_[c] + columns_[c].size();
    if (starts_.back() >= 0xFFFFFFFFu)
      throw Error(Status::Limit, "", "too many voxels beside faces for a flood",
                  "use larger voxels, or `inside=winding`");
    joinCells();
  }

  // Emits, node by node, the voxels that are not reached from outside.
  void write(NodeSink& sink) {
    std::int32_t zLow = kAbove, zHigh = kBelow;
    for (const auto& [index, slabs] : walls_.nodes()) {
      zLow = std::min(zLow, index[2]);
      zHigh = std::max(zHigh, index[2]);
    }
    const auto across = static_cast<std::size_t>(high_[1] - low_[1] + 1);
    const auto stacks = static_cast<std::size_t>(high_[0] - low_[0] + 1) * across;
    tbb::parallel_for(std::size_t(0), stacks, [&](std::size_t i) {
      for (std::int32_t z = zLow; z <= zHigh; ++z) {
        progress_.check();
        writeNode({low_[0] + static_cast<std::int32_t>(i / across),
                   low_[1] + static_cast<std::int32_t>(i % across), z},
                  sink);
      }
    });
  }

private:
  std::size_t columnOf(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(x - low_[0] * kNodeSize) * width_ +
           static_cast<std::size_t>(y - low_[1] * kNodeSize);
  }
  std::int32_t xOf(std::size_t column) const {
    return static_cast<std::int32_t>(column / width_) + low_[0] * kNodeSize;
  }
  std::int32_t yOf(std::size_t column) const {
    return static_cast<std::int32_t>(column % width_) + low_[1] * kNodeSize;
  }

  void fillColumn(std::size_t column) {
    const std::int32_t x = xOf(column), y = yOf(column);
    std::vector<Cell>& cells = columns_[column];
    std::int32_t next = kBelow; // first voxel that no cell has
    const auto& nodes = walls_.nodes();
    const NodeIndex bottom{nodeOf(x), nodeOf(y), kBelow};
    for (auto node = nodes.lower_bound(bottom);
         node != nodes.end() && node->first[0] == bottom[0] && node->first[1] == bottom[1];
         ++node) {
      const int inX = x - node->first[0] * kNodeSize, inY = y - node->first[1] * kNodeSize;
      const std::uint64_t* row = (*node->second)[static_cast<std::size_t>(inX / kLeafSize)]
                                     .rows[inX % kLeafSize * kNodeSize + inY];
      for (int word = 0; word < 2; ++word)
        for (std::uint64_t bits = row[word]; bits != 0; bits &= bits - 1) {
          const std::int32_t z = node->first[2] * kNodeSize + 64 * word + __builtin_ctzll(bits);
          if (z > next)
            cells.push_back({next, z - 1, false});
          cells.push_back({z, z, true});
          next = z + 1;
        }
    }
    cells.push_back({next, kAbove, false});
  }

  Vec3d world(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const Vec3d &o = transform_.origin, &h = transform_.voxelSize;
    return {o[0] + x * h[0], o[1] + y * h[1], o[2] + z * h[2]};
  }

  using Joins = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  using Hits = std::vector<TriangleScene::Hit>;

  // Whether the line from a voxel to its neighbour along `axis` is free.
  bool isFree(std::int32_t x, std::int32_t y, std::int32_t z, std::size_t axis, Hits& hits) const {
    Vec3d from = world(x, y, z), way{0, 0, 0};
    from[axis] -= kOverlap * transform_.voxelSize[axis];
    way[axis] = transform_.voxelSize[axis];
    scene_.crossings(from, way, 1 + 2 * kOverlap, hits);
    return hits.empty();
  }

  void joinAlong(std::size_t column, Joins& joins, Hits& hits) const {
    const std::vector<Cell>& cells = columns_[column];
    for (std::size_t i = 1; i < cells.size(); ++i)
      if (isFree(xOf(column), yOf(column), cells[i].first - 1, 2, hits))
        joins.emplace_back(starts_[column] + i - 1, starts_[column] + i);
  }

  // Cells of a column and of its neighbour along `axis` that lie side by side.
  void joinAcross(std::size_t column, std::size_t other, std::size_t axis, Joins& joins,
                  Hits& hits) const {
    const std::vector<Cell>&a = columns_[column], &b = columns_[other];
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
      const std::int32_t z = std::max(a[i].first, b[j].first);
      if ((!a[i].wall && !b[j].wall) || isFree(xOf(column), yOf(column), z, axis, hits))
        joins.emplace_back(starts_[column] + i, starts_[other] + j);
      // Cells tile a column: the one that ends first is done with.
      const std::int32_t lastA = a[i].last, lastB = b[j].last;
      i += lastA <= lastB;
      j += lastB <= lastA;
    }
  }

  void joinCells() {
    DisjointSets cells(starts_.back());
    tbb::enumerable_thread_specific<Joins> found;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, columns_.size(), 4096),
                      [&](const auto& range) {
                        progress_.check();
                        Joins& joins = found.local();
                        Hits hits;
                        for (std::size_t c = range.begin(); c != range.end(); ++c) {
                          joinAlong(c, joins, hits);
                          if (c % width_ + 1 < width_)
                            joinAcross(c, c + 1, 1, joins, hits);
                          if (c + width_ < columns_.size())
                            joinAcross(c, c + width_, 0, joins, hits);
                        }
                      });
    for (const Joins& joins : found)
      for (const auto& [a, b] : joins)
        cells.join(a, b);
    // All columns are open above; the first one is free.
    for (std::size_t c = 0; c < columns_.size(); ++c)
      cells.join(0, static_cast<std::uint32_t>(starts_[c + 1] - 1));
    outside_.resize(starts_.back());
    for (std::uint32_t i = 0; i < outside_.size(); ++i)
      outside_[i] = cells.find(i) == 0;
  }

  void writeNode(const NodeIndex& index, NodeSink& sink) {
    std::unique_ptr<NodeSink::Node> node;
    const auto bits = std::make_unique<SlabBits>();
    const std::int32_t x0 = index[0] * kNodeSize, y0 = index[1] * kNodeSize,
                       z0 = index[2] * kNodeSize;
    for (int s = 0; s < kSlabsPerNode; ++s) {
      std::memset(bits.get(), 0, sizeof(SlabBits));
      bool any = false;
      for (int row = 0; row < kSlabRows; ++row) {
        const std::size_t column =
            columnOf(x0 + s * kLeafSize + row / kNodeSize, y0 + row % kNodeSize);
        const std::vector<Cell>& cells = columns_[column];
        auto cell = std::lower_bound(cells.begin(), cells.end(), z0,
                                     [](const Cell& c, std::int32_t z) { return c.last < z; });
        for (; cell != cells.end() && cell->first < z0 + kNodeSize; ++cell) {
          if (outside_[starts_[column] + static_cast<std::size_t>(cell - cells.begin())])
            continue;
          any = true;
          setRun(bits->rows[row], std::max(cell->first, z0) - z0,
                 std::min(cell->last, z0 + kNodeSize - 1) - z0 + 1);
        }
      }
      if (!any)
        continue;
      if (node == nullptr)
        node = sink.begin(index);
      sink.slab(*node, s, *bits, nullptr);
    }
    if (node != nullptr)
      sink.end(std::move(node));
  }

  const BitNodes& walls_;
  const TriangleScene& scene_;
  const GridTransform& transform_;
  Progress& progress_;
  std::array<std::int32_t, 2> low_{kAbove, kAbove}, high_{kBelow, kBelow}; // nodes, x and y
  std::size_t width_ = 0;                                                  // columns along y
  std::vector<std::vector<Cell>> columns_;
  std::vector<std::size_t> starts_; // number of the first cell of every column
  std::vector<bool> outside_;       // of every cell
};

} // namespace

void rasterizeFlood(const SnappedMesh& mesh, const Boundary& faces, const TriangleScene& scene,
                    const GridTransform& transform, NodeSink& sink, Progress& progress) {
  const Vec3d& h = transform.voxelSize;
  BitNodes walls;
  rasterizeShell(mesh, faces, h, 0.5 * std::max({h[0], h[1], h[2]}) * (1 + 1e-6), walls, progress);
  if (walls.nodes().empty())
    return; // the mesh lies between voxel centres
  Flood flood(walls, scene, transform, progress);
  flood.run();
  flood.write(sink);
}

} // namespace tetvdb
