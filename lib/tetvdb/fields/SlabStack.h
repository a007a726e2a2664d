// SPDX-License-Identifier: Apache-2.0
//
// Coverage along z: the sums of slabs above one another become leaves. Internal to Coverage.cpp.
#pragma once

#include "tetvdb/core/LargeVector.h"
#include "tetvdb/fields/CoverageSum.h"
#include "tetvdb/geometry/Exact.h"
#include "tetvdb/geometry/LeafDistance.h"
#include "tetvdb/geometry/SlabVolume.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/BoundaryFaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace tetvdb::covered {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;

inline constexpr std::int64_t kWhole = kWholeVolume;

// Points in coordinates in which the cube of voxel i is [i, i + 1]. They are not snapped, since no
// decisions are made here, and the volume is that of the mesh itself.
using CubePoints = LargeVector<Vec3d>;

// The sums of a slab's leaves that faces meet (SlabVolume.h); null: none does.
using SlabSums = std::array<const std::int64_t*, kLeavesInSlab>;

// The sums of one slab. Cleared leaf by leaf, when a face first enters a leaf.
class SlabVolumes {
public:
  SlabVolumes() : sums_(std::size_t(kLeavesInSlab) * kSumsOfLeaf) {}

  void clear() { touched_.fill(nullptr); }
  const SlabSums& touched() const { return touched_; }

  void add(const Polygon& face, double sign) {
    cutAlong(face, 0, 0, kLeafSize - 1, [&](int x, const Polygon& slice) {
      addSlice(x, slice, sign, [&](int leaf, int voxel, std::int64_t volume, std::int64_t area) {
        std::int64_t* const sums = sums_.data() + std::ptrdiff_t(leaf) * kSumsOfLeaf;
        auto& touched = touched_[static_cast<std::size_t>(leaf)];
        if (touched == nullptr) {
          touched = sums;
          std::fill_n(sums, kSumsOfLeaf, 0);
        }
        sums[voxel] += volume;
        sums[kVoxelsInLeaf + voxel] += area;
      });
    });
  }

private:
  LargeVector<std::int64_t> sums_;
  SlabSums touched_{};
};

// The finished part of a node in a slab.
struct SlabPart {
  NodeIndex node;
  int slab;
  bool full = false;                                                        // every leaf is full
  std::vector<std::pair<std::uint16_t, std::unique_ptr<FloatLeaf>>> leaves; // null: a full one
};

// What CoverageSum is made of, without errors of rounding.
struct ExactSum {
  Int128 filled = 0, overlap = 0;
  std::uint64_t overlapVoxels = 0;

  void add(const ExactSum& more) {
    filled += more.filled;
    overlap += more.overlap;
    overlapVoxels += more.overlapVoxels;
  }
  CoverageSum inVoxels() const {
    return {static_cast<double>(filled) / static_cast<double>(kWhole),
            static_cast<double>(overlap) / static_cast<double>(kWhole), overlapVoxels};
  }
};

// What a stack of slabs needs to be continued.
struct StackState {
  std::size_t next = 0;   // of its pairs
  std::int32_t z = 0;     // the first node that is not done, once there is one
  std::int64_t below = 0; // the carry of all columns where the following are empty
  std::vector<std::int64_t> carry;
};

// The slabs at one position in x and y, in order of z.
class SlabStack {
public:
  SlabStack(const CubePoints& points, const Boundary& boundary, std::vector<SlabPart>& parts)
      : points_(points), boundary_(boundary), parts_(parts), carry_(kColumnsInSlab, 0) {}

  void resume(const StackState& state) {
    if (state.carry.empty())
      std::fill(carry_.begin(), carry_.end(), state.below);
    else
      carry_ = state.carry;
  }
  void suspend(StackState& state) const {
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
      build(*first, first->z, volumes.touched());
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
        sum_.filled += Int128(kWhole) * kColumnsInSlab * kNodeSize;
      } else {
        build(at, z, {});
      }
    }
  }

  /// The slab of a stack at height z.
  void build(const FaceInSlab& at, std::int32_t z, const SlabSums& sums) {
    SlabPart part{{at.x >> 4, at.y, z}, at.x & 15, false, {}};
    std::int64_t volume[kVoxelsInLeaf];
    for (int y = 0; y < kLeavesAlong; ++y) {
      std::int64_t* carry = carry_.data() + y * kColumnsInLeaf;
      for (int leafZ = 0; leafZ < kLeavesAlong; ++leafZ) {
        const int leaf = y * kLeavesAlong + leafZ;
        const std::int64_t* const own = sums[static_cast<std::size_t>(leaf)];
        const bool touched = own != nullptr;
        if (!touched && uniform(carry, 0))
          continue;
        const auto offset = static_cast<std::uint16_t>((part.slab << 8) | leaf);
        if (!touched && uniform(carry, kWhole)) {
          sum_.filled += Int128(kWhole) * kVoxelsInLeaf;
          part.leaves.emplace_back(offset, nullptr);
          continue;
        }
        for (int c = 0; c < kColumnsInLeaf; ++c)
          sumColumn(touched ? own + c * kLeafSize : nullptr, carry[c], volume + c * kLeafSize);
        const openvdb::Coord origin(at.x * kLeafSize, at.y * kNodeSize + y * kLeafSize,
                                    z * kNodeSize + leafZ * kLeafSize);
        addLeaf(origin, offset, volume, part);
      }
    }
    if (!part.leaves.empty())
      parts_.push_back(std::move(part));
  }

  const ExactSum& sum() const { return sum_; }

  /// Whether the faces are closed: the value carried beyond the last is only rounding error.
  bool closes() const {
    return std::all_of(carry_.begin(), carry_.end(),
                       [](std::int64_t c) { return std::abs(c) < kOpenVolume; });
  }

private:
  void addFace(const FaceInSlab& at, SlabVolumes& volumes) const {
    const BoundaryFace& f = boundary_.faces[at.face];
    double sign;
    const Polygon polygon =
        polygonInSlab(points_[f.a], points_[f.b], points_[f.c], f.weight, at, sign);
    volumes.add(polygon, sign);
  }

  static bool uniform(const std::int64_t* carry, std::int64_t value,
                      std::size_t count = kColumnsInLeaf) {
    return std::all_of(carry, carry + count, [value](std::int64_t c) { return c == value; });
  }

  void addLeaf(const openvdb::Coord& origin, std::uint16_t offset, std::int64_t* volume,
               SlabPart& part) {
    bool empty = true, full = true;
    for (int i = 0; i < kVoxelsInLeaf; ++i) {
      if (volume[i] > kWhole) {
        sum_.overlap += volume[i] - kWhole;
        ++sum_.overlapVoxels;
        volume[i] = kWhole;
      }
      volume[i] = std::max<std::int64_t>(volume[i], 0);
      sum_.filled += volume[i];
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
    ShareRounding rounded;
    for (openvdb::Index x = 0; x < kLeafSize; ++x) {
      std::uint64_t active = 0;
      for (openvdb::Index i = 0; i < kColumnsInLeaf; ++i) {
        const std::int64_t v = volume[x * kColumnsInLeaf + i];
        values[x * kColumnsInLeaf + i] = rounded(v);
        active |= static_cast<std::uint64_t>(v != 0) << i;
      }
      leaf->getValueMask().getWord<openvdb::Index64>(x) = active;
    }
    part.leaves.emplace_back(offset, std::move(leaf));
  }

  const CubePoints& points_;
  const Boundary& boundary_;
  std::vector<SlabPart>& parts_;
  std::vector<std::int64_t> carry_; // by column (SlabVolume.h)
  ExactSum sum_;
};

} // namespace tetvdb::covered
