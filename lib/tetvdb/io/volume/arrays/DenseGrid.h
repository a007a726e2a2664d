// SPDX-License-Identifier: Apache-2.0
//
// A sparse grid as the dense array that a box of it is, read a few planes at a time.
//
//   const auto dense = tetvdb::denseGrid(*grid, box); // MakeDenseGrid.h
//   std::vector<char> planes(dense->bytesOf(kXSlowest, 8));
//   dense->fill(kXSlowest, 0, 8, planes.data());    // x = box.low[0] to box.low[0] + 7
#pragma once

#include "tetvdb/io/volume/arrays/ArrayLayout.h"
#include "tetvdb/volume/VoxelBox.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <openvdb/openvdb.h>
#include <string>
#include <vector>

namespace tetvdb {

/// Refers to the grid. Bool and mask grids become bytes 0 and 1; vectors three components in a row.
/// A voxel that is not active has the value that the grid holds there: the background, or what an
/// inactive tile says.
class DenseGrid {
public:
  virtual ~DenseGrid() = default;

  const std::string& name() const { return name_; }
  ElementType element() const { return element_; }
  std::size_t components() const { return components_; }
  bool isBits() const { return isBits_; } ///< only bytes 0 and 1
  const VoxelBox& box() const { return box_; }
  std::size_t voxelBytes() const { return components_ * bytesOf(element_); }
  /// Of the whole array; beyond 2^64 not exact.
  double bytes() const { return box_.voxels() * static_cast<double>(voxelBytes()); }
  /// Of `count` planes across order[0].
  std::size_t planeBytes(const AxisOrder& order) const {
    return static_cast<std::size_t>(box_.size(order[1]) * box_.size(order[2])) * voxelBytes();
  }

  /// Voxels of planes first to first + count - 1 across order[0], counted from the box's low side,
  /// into `out`. Parallel. Cost: a few ns a voxel.
  virtual void fill(const AxisOrder& order, std::uint64_t first, std::uint64_t count,
                    void* out) const = 0;

  /// Active voxels in the box.
  virtual std::uint64_t countActive() const = 0;
  /// The active voxels of one plane x, counted from the box's low side, in ascending order of y,
  /// then z: appended to `voxels` (three index coordinates each) and to `values` (voxelBytes()
  /// each). Either may be null.
  virtual void activeOf(std::uint64_t x, std::vector<std::int32_t>* voxels,
                        std::vector<char>* values) const = 0;
  /// voxelBytes() bytes.
  virtual std::vector<char> background() const = 0;

protected:
  std::string name_;
  ElementType element_ = ElementType::Float32;
  std::size_t components_ = 1;
  bool isBits_ = false;
  VoxelBox box_;
};

} // namespace tetvdb
