// SPDX-License-Identifier: Apache-2.0
//
// Where the winding number of an open soup may pass a half off its faces: the voxels at which the
// smooth part, RimWinding, has to be looked at. Everywhere else the whole number nearest to the
// winding number changes with the crossings of faces alone.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/RimWinding.h"
#include "tetvdb/voxelize/Slab.h"

#include <array>
#include <bitset>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// A box of voxels stands for the columns through their centres, from the centre below the lowest
/// to the highest: what a sum carried up through the box passes. It is passed over if the winding
/// number, faces aside, stays clear of every half in it, by its value and slope in the middle and
/// the bound on its second derivative.
class RimBand {
public:
  /// Both must outlive it; the methods throw as progress.check() does.
  RimBand(const RimWinding& rim, const Progress& progress) : rim_(rim), progress_(progress) {}

  /// Nodes with voxels to look at, in order of (x, y, z). Throws Error(Limit) where they leave
  /// 32-bit index space.
  std::vector<NodeIndex> nodes() const;

  /// Leaves of a node with voxels to look at: leaf (x, y, z) at bit (x * 16 + y) * 16 + z.
  std::bitset<4096> leaves(const NodeIndex& node) const;

  /// RimWinding::at() of the voxels of a leaf that have to be looked at: voxel (x, y, z) at
  /// [(x * 8 + y) * 8 + z], and bit 8 y + z of flags[x].
  struct Leaf {
    std::array<std::uint64_t, 8> flags;
    std::array<double, 512> values;
  };
  void look(const Vec3i& firstVoxel, Leaf& leaf) const;

private:
  using Corner = std::array<std::int64_t, 3>;
  struct Middle;
  // Whether the winding number may pass a half in a box; `middle` is then what is known about it.
  bool mayPassHalf(const Corner& first, std::int64_t size, Middle& middle) const;
  template <typename Visit>
  void descend(const Corner& first, std::int64_t size, std::int64_t smallest,
               const Visit& visit) const;
  void look(const Corner& origin, const Corner& first, std::int64_t size, Leaf& leaf) const;
  void predict(const Corner& origin, const Corner& first, std::int64_t size, const Middle& middle,
               const std::vector<std::uint32_t>& curtains, Leaf& leaf) const;

  const RimWinding& rim_;
  const Progress& progress_;
};

/// The whole number nearest to a winding number, of a half (within a tenth of kRimWindingError) the
/// one nearer to zero: what lies at most half around counts as outside.
std::int32_t nearestWinding(double winding);

} // namespace tetvdb
