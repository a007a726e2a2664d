// SPDX-License-Identifier: Apache-2.0
//
// Samples of a grid that defines a solid, block by block, without OpenVDB's types.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/volume/Volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb {

constexpr int kBlock = 8;            ///< voxels along a block's side: a leaf
constexpr int kSamples = kBlock + 1; ///< includes the first voxels of the neighbours

/// The 9^3 voxels starting at a block's origin.
struct BlockSamples {
  /// Whether voxel (x, y, z) is inside: bit z of row 9 x + y.
  std::array<std::uint16_t, std::size_t(kSamples) * kSamples> inside;
  /// For a float grid: the value relative to the isovalue, above 0 inside, [9 * row + z].
  std::array<float, std::size_t(kSamples) * kSamples * kSamples> height;

  bool isInside(int x, int y, int z) const {
    return inside[static_cast<std::size_t>(kSamples * x + y)] >> z & 1;
  }
  float heightAt(int x, int y, int z) const {
    return height[static_cast<std::size_t>(kSamples * (kSamples * x + y) + z)];
  }
};

/// The inside and the outside of one grid.
class SolidSamples {
public:
  virtual ~SolidSamples() = default;

  /// Origins of all blocks whose 9^3 voxels may be on different sides: ascending and distinct.
  virtual std::vector<Vec3i> blocks(Progress& progress) const = 0;
  /// Thread-safe.
  virtual void load(const Vec3i& block, BlockSamples& samples) const = 0;
  /// Whether `height` is set: a float grid.
  virtual bool hasHeights() const = 0;
  /// The position at which the surface crosses the line from `voxel`, which is inside if
  /// `startInside` is true, to the next voxel along `axis`, which is on the other side: 0 to 1.
  /// NaN: use the heights, else the midpoint. Thread-safe.
  virtual double passage(const Vec3i& voxel, std::size_t axis, bool startInside) const;

  GridTransform transform;
};

/// Returns the named grid, or the first one that defines a solid: active voxels of a bool or mask
/// grid, values above 0.5 of a float grid, below 0 of a level set. The volume must outlive the
/// result. Throws Error(Invalid) for a grid that is none of these, does not exist, has no linear
/// transform, or has infinite regions inside.
std::unique_ptr<SolidSamples> solidSamples(const Volume& volume, const std::string& grid);

} // namespace tetvdb
