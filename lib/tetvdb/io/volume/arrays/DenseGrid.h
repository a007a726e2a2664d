// SPDX-License-Identifier: Apache-2.0
//
// A sparse grid as the dense array that a box of it is, read a few planes at a time.
//
//   const auto dense = tetvdb::denseGrid(*grid, box); // MakeDenseGrid.h
//   std::vector<char> planes(dense->bytesOf(kXSlowest, 8));
//   dense->fill(kXSlowest, 0, 8, planes.data());    // x = box.low[0] to box.low[0] + 7
#pragma once

#include "tetvdb/volume/VoxelBox.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <openvdb/openvdb.h>
#include <string>
#include <vector>

namespace tetvdb {

enum class ElementType : std::uint8_t { UInt8, Int32, Int64, Float32, Float64 };

/// The formats' names of an element type.
struct ElementNames {
  const char* numpy; ///< with the byte order
  const char* vtk;
  const char* nrrd;
  const char* plain; ///< as NumPy names its scalar types
};

constexpr ElementNames namesOf(ElementType type) {
  switch (type) {
  case ElementType::UInt8:
    return {"|u1", "UInt8", "uint8", "uint8"};
  case ElementType::Int32:
    return {"<i4", "Int32", "int32", "int32"};
  case ElementType::Int64:
    return {"<i8", "Int64", "int64", "int64"};
  case ElementType::Float32:
    return {"<f4", "Float32", "float", "float32"};
  case ElementType::Float64:
    return {"<f8", "Float64", "double", "float64"};
  }
  return {};
}

constexpr std::size_t bytesOf(ElementType type) {
  switch (type) {
  case ElementType::UInt8:
    return 1;
  case ElementType::Int32:
  case ElementType::Float32:
    return 4;
  case ElementType::Int64:
  case ElementType::Float64:
    return 8;
  }
  return 0;
}

/// The axes of an array, the slowest first.
using AxisOrder = std::array<std::size_t, 3>;
constexpr AxisOrder kXSlowest{0, 1, 2}; ///< [x][y][z], NumPy's order
constexpr AxisOrder kXFastest{2, 1, 0}; ///< [z][y][x], that of images
constexpr AxisOrder kYFastest{0, 2, 1}; ///< [x][z][y], that of .binvox

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
