// SPDX-License-Identifier: Apache-2.0
//
// A grid as samples of a solid, block by block, without OpenVDB's types.
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
constexpr int kSamples = kBlock + 1; ///< with the first voxels of the neighbours

/// The 9^3 voxels from a block's origin on.
struct BlockSamples {
  /// Whether voxel (x, y, z) is inside: bit z of row 9 x + y.
  std::array<std::uint16_t, std::size_t(kSamples) * kSamples> inside;
  /// Of a float grid: value above or below the surface, above 0 inside, [9 * row + z].
  std::array<float, std::size_t(kSamples) * kSamples * kSamples> height;

  bool isInside(int x, int y, int z) const {
    return inside[static_cast<std::size_t>(kSamples * x + y)] >> z & 1;
  }
  float heightAt(int x, int y, int z) const {
    return height[static_cast<std::size_t>(kSamples * (kSamples * x + y) + z)];
  }
};

/// What is inside and what is outside of one grid.
class SolidSamples {
public:
  virtual ~SolidSamples() = default;

  /// Origins of all blocks whose 9^3 voxels can differ in side: ascending, none twice.
  virtual std::vector<Vec3i> blocks(Progress& progress) const = 0;
  /// Thread-safe.
  virtual void load(const Vec3i& block, BlockSamples& samples) const = 0;
  /// Whether heights are there: a float grid.
  virtual bool hasHeights() const = 0;
  /// Where the surface passes on the way from `voxel`, which is inside where `startInside` says so,
  /// to the next one along `axis`, which is on the other side: 0 to 1. NaN: where the heights say,
  /// else midway. Thread-safe.
  virtual double passage(const Vec3i& voxel, std::size_t axis, bool startInside) const;

  GridTransform transform;
};

/// The grid of that name, or the first that can be a solid: active voxels of a bool or mask grid,
/// values above 0.5 of a float grid, below 0 of a level set. The volume must outlive the result.
/// Throws Error(Invalid) for a grid that is none of these, is not there, has no linear transform
/// or is inside without end.
std::unique_ptr<SolidSamples> solidSamples(const Volume& volume, const std::string& grid);

} // namespace tetvdb
