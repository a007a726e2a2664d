// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/BoundaryRaster.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/core/GroupItems.h"
#include "tetvdb/voxelize/FaceRaster.h"
#include "tetvdb/voxelize/ParityRows.h"
#include "tetvdb/voxelize/WindingBand.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tuple>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

// Used as a face index: the node has voxels of the winding band.
constexpr std::uint32_t kBandInNode = 0xFFFFFFFFu;

// The faces of the boundary and, numbered after them, the triangles over its holes.
class AllFaces {
public:
  AllFaces(const SnappedMesh& mesh, const Boundary& boundary, const TriangleClusters* holes)
      : mesh_(mesh), boundary_(boundary), holes_(holes) {
    if (size() >= kBandInNode)
      throw Error(Status::Limit, "", "the mesh has 2^32 triangles or more", "split it in parts");
  }

  std::size_t size() const {
    return boundary_.faces.size() + (holes_ != nullptr ? holes_->triangleCount() : 0);
  }
  bool isOverHole(std::size_t i) const { return i >= boundary_.faces.size(); }
  FaceRaster prepare(std::size_t i) const {
    if (isOverHole(i)) {
      const FillTriangle& t = holes_->triangle(i - boundary_.faces.size());
      return {t.a, t.b, t.c, t.weight};
    }
    const BoundaryFace& f = boundary_.faces[i];
    return {mesh_.points[f.a], mesh_.points[f.b], mesh_.points[f.c], f.weight};
  }

private:
  const SnappedMesh& mesh_;
  const Boundary& boundary_;
  const TriangleClusters* holes_;
};

// The faces that may have crossings in each node, and kBandInNode.
GroupedItems<NodeFace> facesByNode(const AllFaces& faces, const WindingBand* band,
                                   Progress& progress) {
  const auto addNodes = [&](std::size_t i, std::vector<NodeFace>& out) {
    if (i >= faces.size()) {
      out.push_back({band->nodes()[i - faces.size()], kBandInNode});
      return;
    }
    const FaceRaster face = faces.prepare(i);
    if (face.crosses == 0)
      return;
    for (auto x = nodeOf(face.xMin); x <= nodeOf(face.xMax); ++x)
      for (auto y = nodeOf(face.yMin); y <= nodeOf(face.yMax); ++y) {
        const std::int64_t x0 = std::int64_t(x) * kNodeSize, y0 = std::int64_t(y) * kNodeSize;
        std::int64_t low, high;
        if (!face.range(x0, x0 + kNodeSize - 1, y0, y0 + kNodeSize - 1, low, high))
          continue;
        for (auto z = nodeOf(low); z <= nodeOf(high); ++z)
          out.push_back({{x, y, z}, static_cast<std::uint32_t>(i)});
      }
  };
  return groupItems<NodeFace>(faces.size() + (band != nullptr ? band->nodes().size() : 0), 4096,
                              addNodes, progress);
}

// The sums of a slab's rows at its bottom, carried up from node to node.
struct SlabCarry {
  /// The whole number nearest to the winding number: signed crossings, plus `rests` for open soups.
  std::array<std::int32_t, kSlabRows> sums{};
  std::vector<std::int32_t> rests; ///< empty: all 0
  std::vector<std::int32_t> holes; ///< crossings of the triangles over holes; empty: all 0
  bool uniform = true;             // all rows have sums[0]

  void refreshUniform() {
    std::int32_t differs = 0;
    for (std::int32_t s : sums)
      differs |= s ^ sums[0];
    uniform = differs == 0;
  }
};

// The triangles over holes in a slab: their crossings, and their solid angles over 4 pi where these
// are needed.
struct SlabHoles {
  SlabCrossings crossings;
  SlabBits flags;
  std::vector<double> values; // of row r, voxel z at [r * 128 + z]

  SlabHoles() : values(std::size_t(kSlabRows) * kNodeSize) {}
};

// A row's crossings: one bit a voxel, and the list of those beyond one.
struct RowCrossings {
  const std::uint64_t *entering, *leaving;
  const SlabCrossings::Extra *extra, *extraEnd;
};

// Sums a row's crossings up, voxel by voxel.
class CrossingSum {
public:
  CrossingSum(const RowCrossings& row, std::int32_t before) : row_(row), sum_(before) {}

  // To be called for z = 0, 1, ...: the sum of the crossings up to there.
  std::int32_t upTo(int z) {
    sum_ += static_cast<std::int32_t>(row_.entering[z >> 6] >> (z & 63) & 1);
    sum_ -= static_cast<std::int32_t>(row_.leaving[z >> 6] >> (z & 63) & 1);
    for (; row_.extra != row_.extraEnd && row_.extra->z == z; ++row_.extra)
      sum_ += row_.extra->weight;
    return sum_;
  }

private:
  RowCrossings row_;
  std::int32_t sum_;
};

// The crossings of a slab's rows. Rows are read in ascending order; rows may be skipped.
class RowsOf {
public:
  explicit RowsOf(SlabCrossings& crossings) : crossings_(crossings) {
    std::sort(crossings.extra.begin(), crossings.extra.end(), [](const auto& a, const auto& b) {
      return std::tie(a.row, a.z, a.weight) < std::tie(b.row, b.z, b.weight);
    });
    next_ = crossings.extra.data();
    end_ = next_ + crossings.extra.size();
  }
  RowCrossings row(std::int32_t r) {
    while (next_ != end_ && next_->row < r)
      ++next_;
    RowCrossings row{crossings_.entering.rows[r], crossings_.leaving.rows[r], next_, next_};
    while (row.extraEnd != end_ && row.extraEnd->row == r)
      ++row.extraEnd;
    next_ = row.extraEnd;
    return row;
  }
  // Whether a row that is still to be read, before row r, has crossings in the list.
  bool anyBefore(std::int32_t r) const { return next_ != end_ && next_->row < r; }

private:
  const SlabCrossings& crossings_;
  const SlabCrossings::Extra *next_, *end_;
};

// All crossings of a row.
std::int32_t totalOf(const RowCrossings& row) {
  std::int32_t sum = 0;
  for (int word = 0; word < 2; ++word)
    sum += __builtin_popcountll(row.entering[word]) - __builtin_popcountll(row.leaving[word]);
  for (const SlabCrossings::Extra* e = row.extra; e != row.extraEnd; ++e)
    sum += e->weight;
  return sum;
}

void setVoxel(std::uint64_t* row, int z) {
  row[z >> 6] |= std::uint64_t(1) << (z & 63);
}

// One row by counting, where the sum leaves {0, 1}.
void countRow(const RowCrossings& row, FillRule rule, std::int32_t& sum, std::uint64_t* inside) {
  std::uint64_t out[2] = {0, 0};
  CrossingSum crossings(row, sum);
  for (int z = 0; z < kNodeSize; ++z) {
    sum = crossings.upTo(z);
    if (isInside(sum, rule))
      setVoxel(out, z);
  }
  inside[0] = out[0];
  inside[1] = out[1];
}

// One row past voxels of the winding band. `rest`: what the crossings fall short of `sum` by.
void countRowInBand(const RowCrossings& row, const RowCrossings& holeRow, FillRule rule,
                    const std::uint64_t* flags, const double* values, std::int32_t holesBefore,
                    std::int32_t& sum, std::int32_t& rest, std::uint64_t* inside) {
  std::uint64_t out[2] = {0, 0};
  CrossingSum faces(row, sum - rest), holes(holeRow, holesBefore);
  for (int z = 0; z < kNodeSize; ++z) {
    const std::int32_t crossings = faces.upTo(z), below = holes.upTo(z);
    if ((flags[z >> 6] >> (z & 63) & 1) != 0)
      rest = nearestWinding(crossings - below + values[z]) - crossings;
    sum = crossings + rest;
    if (isInside(sum, rule))
      setVoxel(out, z);
  }
  inside[0] = out[0];
  inside[1] = out[1];
}

// Turns crossings into occupancy, in place of the entering bits, and advances the carry. Returns
// whether any voxel is inside. `holes`: of the slab, where there are voxels of the winding band.
bool sumCrossings(SlabCrossings& crossings, FillRule rule, SlabHoles* holes, SlabCarry& carry) {
  std::optional<RowsOf> holeRows;
  if (holes != nullptr) {
    holeRows.emplace(holes->crossings);
    carry.rests.resize(kSlabRows);
    carry.holes.resize(kSlabRows);
  }
  RowsOf rows(crossings);
  std::uint64_t any = 0;
  alignas(64) std::uint64_t inside[kParityRows][2], failed[kParityRows];
  for (std::int32_t first = 0; first < kSlabRows; first += kParityRows) {
    std::uint64_t(*in)[2] = crossings.entering.rows + first;
    std::int32_t* sums = carry.sums.data() + first;
    const bool parity = !parityRows(in, crossings.leaving.rows + first, sums, inside, failed) &&
                        !rows.anyBefore(first + kParityRows) && holes == nullptr;
    for (std::int32_t i = 0; i < kParityRows && !parity; ++i) {
      const std::int32_t r = first + i;
      const auto index = static_cast<std::size_t>(r);
      const RowCrossings row = rows.row(r);
      if (holes != nullptr && (holes->flags.rows[r][0] | holes->flags.rows[r][1]) != 0)
        countRowInBand(row, holeRows->row(r), rule, holes->flags.rows[r],
                       holes->values.data() + index * kNodeSize, carry.holes[index], sums[i],
                       carry.rests[index], inside[i]);
      else if (failed[i] != 0 || row.extra != row.extraEnd)
        countRow(row, rule, sums[i], inside[i]);
      else
        sums[i] = static_cast<std::int32_t>(inside[i][1] >> 63);
    }
    for (std::int32_t i = 0; i < kParityRows && parity; ++i)
      sums[i] = static_cast<std::int32_t>(inside[i][1] >> 63);
    for (std::int32_t i = 0; i < kParityRows; ++i) {
      any |= inside[i][0] | inside[i][1];
      in[i][0] = inside[i][0];
      in[i][1] = inside[i][1];
    }
  }
  carry.refreshUniform();
  return any != 0;
}

// What the triangles over holes add to the carry in a slab.
void addHoles(SlabCrossings& crossings, SlabCarry& carry) {
  carry.holes.resize(kSlabRows);
  RowsOf rows(crossings);
  for (std::int32_t r = 0; r < kSlabRows; ++r)
    carry.holes[static_cast<std::size_t>(r)] += totalOf(rows.row(r));
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

// A thread's working memory.
struct Scratch {
  SlabCrossings crossings;
  std::unique_ptr<SlabHoles> holes; // made when first needed
};

class Stack {
public:
  Stack(const AllFaces& faces, const WindingBand* band, FillRule rule, NodeSink* sink,
        bool splitNodes)
      : faces_(faces), band_(band), rule_(rule), sink_(sink), carries_(kSlabsPerNode),
        grain_(splitNodes ? 1 : kSlabsPerNode) {}

  using Pairs = const NodeFace*;

  // `begin` to `end`: from zBegin on, up to the top of the column.
  void run(std::int32_t x, std::int32_t y, std::int32_t zBegin, std::int32_t zEnd, Pairs begin,
           Pairs end, tbb::enumerable_thread_specific<Scratch>& scratch) {
    std::int32_t z = zBegin;
    while (begin != end && begin->node[2] < zEnd) {
      fill(x, y, z, begin->node[2]);
      z = begin->node[2];
      Pairs nodeEnd = begin;
      while (nodeEnd != end && nodeEnd->node[2] == z)
        ++nodeEnd;
      node(x, y, z, begin, nodeEnd, scratch);
      begin = nodeEnd;
      ++z;
    }
    if (begin != end)
      return fill(x, y, z, zEnd);
    // Above the last face nothing is inside: the faces close, or the winding number ends far from
    // the holes.
    const std::int32_t open = rule_ == FillRule::Odd ? 1 : ~0;
    for (const SlabCarry& carry : carries_)
      if (std::any_of(carry.sums.begin(), carry.sums.end(),
                      [open](std::int32_t sum) { return (sum & open) != 0; }))
        throw std::logic_error("the boundary does not close: crossings were lost");
  }

  void resume(const BoundaryCarry& carry) {
    for (std::size_t s = 0; s < carries_.size(); ++s) {
      SlabCarry& slab = carries_[s];
      for (std::size_t r = 0; r < kSlabRows; ++r) {
        const std::size_t column = s * kSlabRows + r;
        slab.sums[r] = !carry.sums.empty() ? carry.sums[column]
                       : !carry.bits.empty()
                           ? static_cast<std::int32_t>(carry.bits[column / 64] >> (column % 64) & 1)
                           : carry.sum;
      }
      const auto take = [&](const std::vector<std::int32_t>& all, std::vector<std::int32_t>& own) {
        if (!all.empty())
          own.assign(all.begin() + static_cast<std::ptrdiff_t>(s * kSlabRows),
                     all.begin() + static_cast<std::ptrdiff_t>((s + 1) * kSlabRows));
      };
      take(carry.rests, slab.rests);
      take(carry.holes, slab.holes);
      slab.refreshUniform();
    }
  }

  BoundaryCarry carry() const {
    BoundaryCarry result;
    bool uniform = true, bits = true;
    for (const SlabCarry& slab : carries_) {
      uniform = uniform && slab.uniform && slab.sums[0] == carries_[0].sums[0];
      for (const std::int32_t sum : slab.sums)
        bits = bits && (sum & ~1) == 0;
    }
    if (uniform) {
      result.sum = carries_[0].sums[0];
    } else if (bits) {
      result.bits.resize(kSlabsPerNode * kSlabRows / 64);
      for (std::size_t s = 0; s < carries_.size(); ++s)
        for (std::size_t r = 0; r < kSlabRows; ++r)
          result.bits[(s * kSlabRows + r) / 64] |= static_cast<std::uint64_t>(carries_[s].sums[r])
                                                   << (r % 64);
    } else {
      for (const SlabCarry& slab : carries_)
        result.sums.insert(result.sums.end(), slab.sums.begin(), slab.sums.end());
    }
    const auto keep = [&](std::vector<std::int32_t> SlabCarry::*member,
                          std::vector<std::int32_t>& all) {
      if (std::all_of(carries_.begin(), carries_.end(), [&](const SlabCarry& slab) {
            return std::all_of((slab.*member).begin(), (slab.*member).end(),
                               [](std::int32_t v) { return v == 0; });
          }))
        return;
      all.resize(carries_.size() * kSlabRows);
      for (std::size_t s = 0; s < carries_.size(); ++s)
        std::copy((carries_[s].*member).begin(), (carries_[s].*member).end(),
                  all.begin() + static_cast<std::ptrdiff_t>(s * kSlabRows));
    };
    keep(&SlabCarry::rests, result.rests);
    keep(&SlabCarry::holes, result.holes);
    return result;
  }

private:
  // Nodes that no face meets, from zBegin to zEnd.
  void fill(std::int32_t x, std::int32_t y, std::int32_t zBegin, std::int32_t zEnd) {
    if (zBegin == zEnd || sink_ == nullptr)
      return;
    bool uniform = true;
    for (const SlabCarry& carry : carries_)
      uniform = uniform && carry.uniform &&
                isInside(carry.sums[0], rule_) == isInside(carries_[0].sums[0], rule_);
    if (uniform) {
      if (isInside(carries_[0].sums[0], rule_))
        sink_->fullRun(x, y, zBegin, zEnd);
      return;
    }
    const auto bits = std::make_unique<SlabBits>();
    for (std::int32_t z = zBegin; z < zEnd; ++z) {
      std::unique_ptr<NodeSink::Node> node = sink_->begin({x, y, z});
      for (int s = 0; s < kSlabsPerNode; ++s)
        if (extendRows(carries_[static_cast<std::size_t>(s)], rule_, *bits))
          sink_->slab(*node, s, *bits, nullptr);
      sink_->end(std::move(node));
    }
  }

  void node(std::int32_t x, std::int32_t y, std::int32_t z, Pairs begin, Pairs end,
            tbb::enumerable_thread_specific<Scratch>& scratch) {
    std::unique_ptr<NodeSink::Node> node;
    if (sink_ != nullptr)
      node = sink_->begin({x, y, z});
    std::vector<FaceRaster> faces, overHoles;
    faces.reserve(static_cast<std::size_t>(end - begin));
    bool inBand = false;
    for (Pairs p = begin; p != end; ++p)
      if (p->face == kBandInNode)
        inBand = true;
      else
        (faces_.isOverHole(p->face) ? overHoles : faces).push_back(faces_.prepare(p->face));
    const std::int64_t x0 = std::int64_t(x) * kNodeSize, y0 = std::int64_t(y) * kNodeSize,
                       z0 = std::int64_t(z) * kNodeSize;
    const WindingBand::Node banding = inBand ? band_->enter({x, y, z}) : WindingBand::Node();
    const auto slabs = [&](const tbb::blocked_range<int>& range) {
      Scratch& local = scratch.local();
      if (local.holes == nullptr && (inBand || !overHoles.empty()))
        local.holes = std::make_unique<SlabHoles>();
      SlabCrossings& crossings = local.crossings;
      for (int s = range.begin(); s != range.end(); ++s) {
        const std::int64_t first = x0 + s * kLeafSize;
        // Whether any of them is in the slab: then they are in `into`.
        const auto rasterize = [&](const std::vector<FaceRaster>& some, SlabCrossings& into) {
          bool cleared = false;
          for (const FaceRaster& face : some) {
            if (face.xMax < first || face.xMin >= first + kLeafSize)
              continue;
            if (!cleared)
              into.clear();
            cleared = true;
            face.rasterize(first, y0, z0, into);
          }
          return cleared;
        };
        SlabCarry& carry = carries_[static_cast<std::size_t>(s)];
        const bool crossed = rasterize(faces, crossings);
        const bool holes = !overHoles.empty() && rasterize(overHoles, local.holes->crossings);
        const bool banded =
            inBand && band_->evaluate(banding, s, local.holes->flags, local.holes->values);
        if (banded && !crossed)
          crossings.clear();
        if (banded && !holes)
          local.holes->crossings.clear();
        const bool any =
            crossed || banded
                ? sumCrossings(crossings, rule_, banded ? local.holes.get() : nullptr, carry)
                : extendRows(carry, rule_, crossings.entering);
        if (holes)
          addHoles(local.holes->crossings, carry);
        if (any && sink_ != nullptr)
          sink_->slab(*node, s, crossings.entering, nullptr);
      }
    };
    // Nothing inside a slab's work waits for other tasks, so the scratch stays this thread's own.
    tbb::parallel_for(tbb::blocked_range<int>(0, kSlabsPerNode, grain_), slabs,
                      tbb::simple_partitioner());
    if (sink_ != nullptr)
      sink_->end(std::move(node));
  }

  const AllFaces& faces_;
  const WindingBand* band_;
  FillRule rule_;
  NodeSink* sink_; // null: the sums alone
  std::vector<SlabCarry> carries_;
  std::size_t grain_;
};

} // namespace

std::uint64_t estimateBoundaryLeaves(const SnappedMesh& mesh, const Boundary& boundary) {
  // A surface patch with projected areas ax, ay, az (voxels squared) meets about
  // (ax + ay + az) / 64 leaves, and at least one where it is smaller.
  const double leaves = sumOver(boundary.faces.size(), [&](std::size_t i) {
    const BoundaryFace& f = boundary.faces[i];
    const LatticePoint &a = mesh.points[f.a], &b = mesh.points[f.b], &c = mesh.points[f.c];
    const auto area = [&](double LatticePoint::*u, double LatticePoint::*v) {
      return std::abs((b.*u - a.*u) * (c.*v - a.*v) - (b.*v - a.*v) * (c.*u - a.*u)) / 2;
    };
    return area(&LatticePoint::x, &LatticePoint::y) + area(&LatticePoint::y, &LatticePoint::z) +
           area(&LatticePoint::z, &LatticePoint::x);
  });
  return static_cast<std::uint64_t>(leaves * kVoxelsPerUnit * kVoxelsPerUnit / 64) + 64;
}

struct BoundaryStacks::Parts {
  Parts(const SnappedMesh& mesh, const Boundary& boundary, const FillOptions& fill)
      : faces(mesh, boundary, fill.holes), rule(fill.rule) {}

  AllFaces faces;
  FillRule rule;
  std::optional<WindingBand> band;
  GroupedItems<NodeFace> pairs;
  tbb::enumerable_thread_specific<Scratch> scratch;

  const WindingBand* bandOrNull() const { return band ? &*band : nullptr; }
};

BoundaryStacks::BoundaryStacks(const SnappedMesh& mesh, const Boundary& boundary,
                               const FillOptions& fill, Progress& progress)
    : parts_(std::make_unique<Parts>(mesh, boundary, fill)) {
  if (fill.holes != nullptr)
    parts_->band.emplace(*fill.holes, progress);
  parts_->pairs = facesByNode(parts_->faces, parts_->bandOrNull(), progress);
  const GroupedItems<NodeFace>& pairs = parts_->pairs;
  for (std::size_t i = 0; i < pairs.groupCount(); ++i) {
    const auto [x, y, z] = pairs.firstOf(i).node;
    if (columns_.empty() || x != columns_.back().x || y != columns_.back().y)
      columns_.push_back({x, y, z, z + 1, pairs.starts[i], pairs.starts[i]});
    columns_.back().zEnd = z + 1;
    columns_.back().end = pairs.starts[i + 1];
  }
}

BoundaryStacks::~BoundaryStacks() = default;

std::size_t BoundaryStacks::countNodes(const Column& column, std::int32_t zBegin,
                                       std::int32_t zEnd) const {
  const std::vector<std::size_t>& starts = parts_->pairs.starts;
  std::size_t count = 0;
  for (auto start = std::lower_bound(starts.begin(), starts.end(), column.begin);
       *start != column.end; ++start) {
    const std::int32_t z = parts_->pairs.items[*start].node[2];
    count += z >= zBegin && z < zEnd;
  }
  return count;
}

void BoundaryStacks::rasterize(const Column& column, std::int32_t zBegin, std::int32_t zEnd,
                               BoundaryCarry& carry, NodeSink* sink) const {
  const NodeFace* const items = parts_->pairs.items.data();
  const NodeFace* const end = items + column.end;
  const NodeFace* const begin =
      std::lower_bound(items + column.begin, end, zBegin,
                       [](const NodeFace& pair, std::int32_t z) { return pair.node[2] < z; });
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const bool splitNodes = parts_->band.has_value() || columns_.size() < 8 * threads;
  Stack stack(parts_->faces, parts_->bandOrNull(), parts_->rule, sink, splitNodes);
  stack.resume(carry);
  // Without isolation a thread that waits for a slab takes another column meanwhile.
  tbb::this_task_arena::isolate(
      [&] { stack.run(column.x, column.y, zBegin, zEnd, begin, end, parts_->scratch); });
  carry = stack.carry();
}

void rasterizeBoundary(const SnappedMesh& mesh, const Boundary& boundary, const FillOptions& fill,
                       NodeSink& sink, Progress& progress) {
  const BoundaryStacks stacks(mesh, boundary, fill, progress);
  const std::vector<BoundaryStacks::Column>& columns = stacks.columns();
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, columns.size(), 1),
      [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          BoundaryCarry carry;
          stacks.rasterize(columns[i], columns[i].zBegin, columns[i].zEnd, carry, &sink);
          progress.update(static_cast<double>(++done) / static_cast<double>(columns.size() + 1));
        }
      },
      tbb::simple_partitioner());
}

} // namespace tetvdb
