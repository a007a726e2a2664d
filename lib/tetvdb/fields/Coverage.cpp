// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/Coverage.h"

#include "tetvdb/core/JoinedVectors.h"
#include "tetvdb/core/LargeVector.h"
#include "tetvdb/geometry/ClippedFace.h"
#include "tetvdb/geometry/Exact.h"
#include "tetvdb/geometry/LeafDistance.h"
#include "tetvdb/voxelize/Slab.h"
#include "tetvdb/voxelize/TreeAssembly.h"

#include <algorithm>
#include <array>
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

using FloatLeaf = openvdb::FloatTree::LeafNodeType;

constexpr int kLeavesInSlab = kLeavesAlong * kLeavesAlong; // y, z
constexpr int kVoxelsInLeaf = kLeafSize * kLeafSize * kLeafSize;
constexpr int kColumnsInLeaf = kLeafSize * kLeafSize;

// Volumes are summed as integers of this part of a voxel, so that sums do not depend on the order
// of faces or the number of threads. Up to 2^17 solids may overlap.
constexpr std::int64_t kWhole = std::int64_t(1) << 46;
constexpr std::int64_t kSnap = kWhole >> 32;

// A slab of a node, and a face that may pass through it. x in slabs of 8, y and z in nodes.
struct FaceInSlab {
  std::int32_t x, y, z;
  std::uint32_t face;
  bool operator<(const FaceInSlab& o) const {
    return std::tie(x, y, z, face) < std::tie(o.x, o.y, o.z, o.face);
  }
  bool sameStack(const FaceInSlab& o) const { return x == o.x && y == o.y; }
};

// Points in coordinates in which the cube of voxel i is [i, i + 1]. They are not snapped, since no
// decisions are made here, and the volume is that of the mesh itself.
using CubePoints = LargeVector<Vec3d>;

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

std::vector<FaceInSlab> binFaces(const CubePoints& points, const Boundary& boundary,
                                 Progress& progress) {
  tbb::enumerable_thread_specific<std::vector<FaceInSlab>> locals;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, boundary.faces.size(), 4096), [&](const auto& range) {
        progress.check();
        std::vector<FaceInSlab>& out = locals.local();
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const BoundaryFace& f = boundary.faces[i];
          const Vec3d &a = points[f.a], &b = points[f.b], &c = points[f.c];
          const double projected = area(a, b, c);
          if (projected == 0)
            continue;
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
        }
      });
  auto all = joinedVectors<FaceInSlab>(locals);
  tbb::parallel_sort(all.begin(), all.end());
  return all;
}

// The contributions of faces in a slab of a node: for each voxel the volume above the faces within
// its cube, and their projected area, which is the volume added to each higher voxel. Cleared leaf
// by leaf, when a face first enters a leaf.
class SlabVolumes {
public:
  SlabVolumes() : volume_(kLeavesInSlab * kVoxelsInLeaf), area_(kLeavesInSlab * kVoxelsInLeaf) {}

  void clear() { touched_.fill(false); }
  bool touched(int leaf) const { return touched_[static_cast<std::size_t>(leaf)]; }
  /// For voxel (x, y, z) of a leaf at [(x * 8 + y) * 8 + z].
  const std::int64_t* volume(int leaf) const { return volume_.data() + leaf * kVoxelsInLeaf; }
  const std::int64_t* area(int leaf) const { return area_.data() + leaf * kVoxelsInLeaf; }

  // Corners relative to the slab's first cube; `sign` is the change of the sums upward.
  void add(const Polygon& face, double sign) {
    cutAlong(face, 0, 0, kLeafSize - 1, [&](int x, const Polygon& slice) {
      cutAlong(slice, 1, 0, kNodeSize - 1, [&](int y, const Polygon& column) {
        cutAlong(column, 2, 0, kNodeSize - 1,
                 [&](int z, const Polygon& piece) { addPiece(x, y, z, piece, sign); });
      });
    });
  }

private:
  void addPiece(int x, int y, int z, const Polygon& piece, double sign) {
    double sum = 0, moment = 0;
    const double* o = piece.at[0];
    const double top = z + 1;
    for (int i = 1; i + 1 < piece.count; ++i) {
      const double *p = piece.at[i], *q = piece.at[i + 1];
      const double twice = (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
      sum += twice;
      moment += twice * ((top - o[2]) + (top - p[2]) + (top - q[2]));
    }
    const int leaf = (y >> 3) * kLeavesAlong + (z >> 3);
    auto& touched = touched_[static_cast<std::size_t>(leaf)];
    const std::size_t first = static_cast<std::size_t>(leaf) * kVoxelsInLeaf;
    if (!touched) {
      touched = true;
      std::fill_n(volume_.begin() + static_cast<std::ptrdiff_t>(first), kVoxelsInLeaf, 0);
      std::fill_n(area_.begin() + static_cast<std::ptrdiff_t>(first), kVoxelsInLeaf, 0);
    }
    const std::size_t at = first + static_cast<std::size_t>((x << 6) | ((y & 7) << 3) | (z & 7));
    constexpr auto whole = static_cast<double>(kWhole);
    area_[at] += std::llrint(sum / 2 * sign * whole);
    volume_[at] += std::llrint(moment / 6 * sign * whole);
  }

  LargeVector<std::int64_t> volume_, area_;
  std::array<bool, kLeavesInSlab> touched_{};
};

// The finished part of a node in a slab.
struct SlabPart {
  NodeIndex node;
  int slab;
  bool full = false;                                                        // every leaf is full
  std::vector<std::pair<std::uint16_t, std::unique_ptr<FloatLeaf>>> leaves; // null: a full one
};

std::int64_t snapped(std::int64_t volume) {
  const std::int64_t nearest = (volume + kWhole / 2) & -kWhole;
  return std::abs(volume - nearest) <= kSnap ? nearest : volume;
}

// Rounds fractions to floats so that the sum is preserved.
class Rounding {
public:
  float operator()(double fraction) {
    const auto nearest = static_cast<float>(fraction);
    const double error = static_cast<double>(nearest) - fraction;
    if (error == 0)
      return nearest;
    const float other = std::nextafter(nearest, error > 0 ? 0.0f : 1.0f);
    const double otherError = static_cast<double>(other) - fraction;
    const bool first = std::abs(off_ + error) <= std::abs(off_ + otherError);
    off_ += first ? error : otherError;
    return first ? nearest : other;
  }

private:
  double off_ = 0;
};

// What a stack of slabs needs to be continued.
struct StackState {
  std::size_t next = 0;   // of its pairs
  std::int32_t z = 0;     // the first node that is not done, once there is one
  std::int64_t below = 0; // the carry of all columns where the following are empty
  std::vector<std::int64_t> carry;
  Rounding rounding;
};

// The slabs at one position in x and y, in order of z.
class SlabStack {
public:
  SlabStack(const CubePoints& points, const Boundary& boundary, std::vector<SlabPart>& parts)
      : points_(points), boundary_(boundary), parts_(parts), carry_(kSlabRows, 0) {}

  void resume(const StackState& state) {
    rounding_ = state.rounding;
    if (state.carry.empty())
      std::fill(carry_.begin(), carry_.end(), state.below);
    else
      carry_ = state.carry;
  }
  void suspend(StackState& state) const {
    state.rounding = rounding_;
    state.below = carry_[0];
    state.carry.clear();
    if (!uniform(carry_.data(), carry_[0], carry_.size()))
      state.carry = carry_;
  }

  /// The slabs with faces from `begin` to `end`, and those between them.
  void run(const FaceInSlab* begin, const FaceInSlab* end, SlabVolumes& volumes) {
    for (const FaceInSlab* first = begin; first != end;) {
      const FaceInSlab* last = first;
      while (last != end && last->z == first->z)
        ++last;
      if (first != begin)
        fill(*first, (first - 1)->z + 1, first->z);
      volumes.clear();
      for (const FaceInSlab* f = first; f != last; ++f)
        addFace(*f, volumes);
      build(*first, first->z, &volumes);
      first = last;
    }
  }
  /// Slabs from zBegin to zEnd that no face meets; `at`: one of the stack.
  void fill(const FaceInSlab& at, std::int32_t zBegin, std::int32_t zEnd) {
    if (zBegin >= zEnd)
      return;
    const bool same = uniform(carry_.data(), carry_[0], carry_.size());
    if (same && carry_[0] == 0)
      return;
    for (std::int32_t z = zBegin; z < zEnd; ++z) {
      if (same && carry_[0] == kWhole) {
        parts_.push_back({{at.x >> 4, at.y, z}, at.x & 15, true, {}});
        filled_ += Int128(kWhole) * kSlabRows * kNodeSize;
      } else {
        build(at, z, nullptr);
      }
    }
  }

  CoverageSum sum() const {
    return {static_cast<double>(filled_) / static_cast<double>(kWhole),
            static_cast<double>(overlap_) / static_cast<double>(kWhole), overlapVoxels_};
  }

  /// Whether the faces are closed: the value carried beyond the last is only rounding error.
  bool closes() const {
    return std::all_of(carry_.begin(), carry_.end(),
                       [](std::int64_t c) { return std::abs(c) < kWhole >> 20; });
  }

private:
  void addFace(const FaceInSlab& at, SlabVolumes& volumes) const {
    const BoundaryFace& f = boundary_.faces[at.face];
    const Vec3d* p[3] = {&points_[f.a], &points_[f.b], &points_[f.c]};
    // In order of position, so that the numbers do not depend on the order of corners.
    double sign = -f.weight; // outside is above
    for (const auto& [i, k] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 1)})
      if (*p[k] < *p[i]) {
        std::swap(p[i], p[k]);
        sign = -sign;
      }
    Polygon polygon;
    for (const Vec3d* q : p) {
      const double corner[3] = {(*q)[0] - static_cast<double>(at.x) * kLeafSize,
                                (*q)[1] - static_cast<double>(at.y) * kNodeSize,
                                (*q)[2] - static_cast<double>(at.z) * kNodeSize};
      polygon.add(corner);
    }
    volumes.add(polygon, sign);
  }

  void build(const FaceInSlab& at, std::int32_t z, const SlabVolumes* volumes) {
    SlabPart part{{at.x >> 4, at.y, z}, at.x & 15, false, {}};
    std::int64_t volume[kVoxelsInLeaf];
    for (int y = 0; y < kLeavesAlong; ++y) {
      std::int64_t* carry = carry_.data() + y * kColumnsInLeaf;
      for (int leafZ = 0; leafZ < kLeavesAlong; ++leafZ) {
        const int leaf = y * kLeavesAlong + leafZ;
        const bool touched = volumes != nullptr && volumes->touched(leaf);
        if (!touched && uniform(carry, 0))
          continue;
        const auto offset = static_cast<std::uint16_t>((part.slab << 8) | leaf);
        if (!touched && uniform(carry, kWhole)) {
          filled_ += Int128(kWhole) * kVoxelsInLeaf;
          part.leaves.emplace_back(offset, nullptr);
          continue;
        }
        for (int c = 0; c < kColumnsInLeaf; ++c)
          sumColumn(touched ? volumes->volume(leaf) + c * kLeafSize : nullptr,
                    touched ? volumes->area(leaf) + c * kLeafSize : nullptr, carry[c],
                    volume + c * kLeafSize);
        const openvdb::Coord origin(at.x * kLeafSize, at.y * kNodeSize + y * kLeafSize,
                                    z * kNodeSize + leafZ * kLeafSize);
        addLeaf(origin, offset, volume, part);
      }
    }
    if (!part.leaves.empty())
      parts_.push_back(std::move(part));
  }

  static bool uniform(const std::int64_t* carry, std::int64_t value,
                      std::size_t count = kColumnsInLeaf) {
    return std::all_of(carry, carry + count, [value](std::int64_t c) { return c == value; });
  }

  // Volumes of a column of a leaf. `carry` is the sum below it, and is set to that below the next
  // leaf.
  static void sumColumn(const std::int64_t* volume, const std::int64_t* area, std::int64_t& carry,
                        std::int64_t* out) {
    if (volume == nullptr) {
      std::fill_n(out, kLeafSize, snapped(carry));
      return;
    }
    for (int z = 0; z < kLeafSize; ++z) {
      out[z] = snapped(carry + volume[z]);
      carry += area[z];
    }
    carry = snapped(carry);
  }

  void addLeaf(const openvdb::Coord& origin, std::uint16_t offset, std::int64_t* volume,
               SlabPart& part) {
    bool empty = true, full = true;
    for (int i = 0; i < kVoxelsInLeaf; ++i) {
      if (volume[i] > kWhole) {
        overlap_ += volume[i] - kWhole;
        ++overlapVoxels_;
        volume[i] = kWhole;
      }
      volume[i] = std::max<std::int64_t>(volume[i], 0);
      filled_ += volume[i];
      empty = empty && volume[i] == 0;
      full = full && volume[i] == kWhole;
    }
    if (empty)
      return;
    if (full) {
      part.leaves.emplace_back(offset, nullptr);
      return;
    }
    auto leaf = std::make_unique<FloatLeaf>(openvdb::PartialCreate(), origin, 0.0f, false);
    leaf->allocate();
    float* values = leaf->buffer().data();
    for (openvdb::Index x = 0; x < kLeafSize; ++x) {
      std::uint64_t active = 0;
      for (openvdb::Index i = 0; i < kColumnsInLeaf; ++i) {
        const std::int64_t v = volume[x * kColumnsInLeaf + i];
        values[x * kColumnsInLeaf + i] =
            rounding_(static_cast<double>(v) / static_cast<double>(kWhole));
        active |= static_cast<std::uint64_t>(v != 0) << i;
      }
      leaf->getValueMask().getWord<openvdb::Index64>(x) = active;
    }
    part.leaves.emplace_back(offset, std::move(leaf));
  }

  const CubePoints& points_;
  const Boundary& boundary_;
  std::vector<SlabPart>& parts_;
  // For column (x, y): [(y / 8) * 64 + x * 8 + y % 8], leaf by leaf.
  std::vector<std::int64_t> carry_;
  Rounding rounding_;
  Int128 filled_ = 0, overlap_ = 0;
  std::uint64_t overlapVoxels_ = 0;
};

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

void add(const CoverageSum& more, CoverageSum& sum) {
  sum.filled += more.filled;
  sum.overlap += more.overlap;
  sum.overlapVoxels += more.overlapVoxels;
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
std::vector<std::size_t> startsOf(const std::vector<FaceInSlab>& pairs) {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (i == 0 || !pairs[i].sameStack(pairs[i - 1]))
      starts.push_back(i);
  starts.push_back(pairs.size());
  return starts;
}

} // namespace

struct CoverageParts::Parts {
  Parts(const std::vector<Vec3d>& points, const Boundary& boundary, const GridTransform& where,
        Progress& progress)
      : faces(boundary), transform(where), cubes(cubePoints(points, where)),
        pairs(binFaces(cubes, boundary, progress)), starts(startsOf(pairs)) {}

  const FaceInSlab& first(std::size_t stack) const { return pairs[starts[stack]]; }
  /// Adds slabs zBegin <= z < zEnd of a stack to `out`; those below are made again where they are
  /// not what was done last.
  CoverageSum run(std::size_t stack, std::int32_t zBegin, std::int32_t zEnd, StackState& state,
                  std::vector<SlabPart>& out);

  const Boundary& faces;
  GridTransform transform;
  CubePoints cubes;
  std::vector<FaceInSlab> pairs;
  std::vector<std::size_t> starts;
  CoverageSum sum;
  NodeIndex column{0, 0, 0}; ///< of cubes, that `states` are of
  std::unordered_map<std::size_t, StackState> states;
  tbb::enumerable_thread_specific<SlabVolumes> volumes;
};

CoverageSum CoverageParts::Parts::run(std::size_t stack, std::int32_t zBegin, std::int32_t zEnd,
                                      StackState& state, std::vector<SlabPart>& out) {
  const FaceInSlab* const own = pairs.data() + starts[stack];
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

const CoverageSum& CoverageParts::sum() const {
  return parts_->sum;
}

openvdb::FloatGrid::Ptr CoverageParts::grid(const NodeBox& box, Progress& progress) {
  constexpr int kCubeBits = 5; // a cube has 2^5 nodes along an axis
  Parts& all = *parts_;
  const NodeIndex column{box.low[0] >> kCubeBits, box.low[1] >> kCubeBits, 0};
  if (column != all.column)
    all.states.clear();
  all.column = column;
  std::vector<std::size_t> stacks;
  for (std::int32_t x = box.low[0] * kLeavesAlong; x < box.high[0] * kLeavesAlong; ++x) {
    const auto begin =
        std::lower_bound(all.starts.begin(), all.starts.end() - 1, std::pair(x, box.low[1]),
                         [&](std::size_t start, const auto& wanted) {
                           return std::pair(all.pairs[start].x, all.pairs[start].y) < wanted;
                         });
    for (auto at = begin;
         at != all.starts.end() - 1 && all.pairs[*at].x == x && all.pairs[*at].y < box.high[1];
         ++at)
      if (all.pairs[*at].z < box.high[2] && all.pairs[at[1] - 1].z >= box.low[2])
        stacks.push_back(static_cast<std::size_t>(at - all.starts.begin()));
  }
  std::vector<StackState*> states;
  for (const std::size_t stack : stacks)
    states.push_back(&all.states[stack]);
  std::vector<std::vector<SlabPart>> found(stacks.size());
  std::vector<CoverageSum> sums(stacks.size());
  tbb::parallel_for(std::size_t(0), stacks.size(), [&](std::size_t i) {
    progress.check();
    sums[i] = all.run(stacks[i], box.low[2], box.high[2], *states[i], found[i]);
  });
  for (const CoverageSum& sum : sums)
    add(sum, all.sum);
  return gridOf(found, all.transform);
}

openvdb::FloatGrid::Ptr coverage(const std::vector<Vec3d>& points, const Boundary& faces,
                                 const GridTransform& transform, CoverageSum& sum,
                                 Progress& progress) {
  const CubePoints cubes = cubePoints(points, transform);
  const std::vector<FaceInSlab> pairs = binFaces(cubes, faces, progress);
  const std::vector<std::size_t> starts = startsOf(pairs);
  std::vector<std::vector<SlabPart>> found(starts.size() - 1);
  std::vector<CoverageSum> sums(starts.size() - 1);
  tbb::enumerable_thread_specific<SlabVolumes> volumes;
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, found.size(), 1),
      [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          SlabStack stack(cubes, faces, found[i]);
          stack.run(pairs.data() + starts[i], pairs.data() + starts[i + 1], volumes.local());
          requireClosed(stack);
          sums[i] = stack.sum();
          progress.update(static_cast<double>(++done) / static_cast<double>(found.size()));
        }
      },
      tbb::simple_partitioner());

  sum = {};
  for (const CoverageSum& own : sums)
    add(own, sum);
  return gridOf(found, transform);
}

} // namespace tetvdb
