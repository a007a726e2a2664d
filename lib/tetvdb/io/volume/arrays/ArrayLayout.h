// SPDX-License-Identifier: Apache-2.0
//
// Types of the numbers in arrays, and orders of their axes. Internal.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tetvdb {

enum class ElementType : std::uint8_t {
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float16,
  Float32,
  Float64
};

constexpr ElementType kElementTypes[] = {
    ElementType::Int8,    ElementType::UInt8,   ElementType::Int16,  ElementType::UInt16,
    ElementType::Int32,   ElementType::UInt32,  ElementType::Int64,  ElementType::UInt64,
    ElementType::Float16, ElementType::Float32, ElementType::Float64};

/// The formats' names of an element type.
struct ElementNames {
  const char* numpy; ///< with the byte order
  const char* vtk;   ///< null: VTK has no such type
  const char* nrrd;  ///< null: as vtk
  const char* plain; ///< as NumPy names its scalar types
};

constexpr ElementNames namesOf(ElementType type) {
  switch (type) {
  case ElementType::Int8:
    return {"|i1", "Int8", "int8", "int8"};
  case ElementType::UInt8:
    return {"|u1", "UInt8", "uint8", "uint8"};
  case ElementType::Int16:
    return {"<i2", "Int16", "int16", "int16"};
  case ElementType::UInt16:
    return {"<u2", "UInt16", "uint16", "uint16"};
  case ElementType::Int32:
    return {"<i4", "Int32", "int32", "int32"};
  case ElementType::UInt32:
    return {"<u4", "UInt32", "uint32", "uint32"};
  case ElementType::Int64:
    return {"<i8", "Int64", "int64", "int64"};
  case ElementType::UInt64:
    return {"<u8", "UInt64", "uint64", "uint64"};
  case ElementType::Float16:
    return {"<f2", nullptr, nullptr, "float16"};
  case ElementType::Float32:
    return {"<f4", "Float32", "float", "float32"};
  case ElementType::Float64:
    return {"<f8", "Float64", "double", "float64"};
  }
  return {};
}

constexpr std::size_t bytesOf(ElementType type) {
  switch (type) {
  case ElementType::Int8:
  case ElementType::UInt8:
    return 1;
  case ElementType::Int16:
  case ElementType::UInt16:
  case ElementType::Float16:
    return 2;
  case ElementType::Int32:
  case ElementType::UInt32:
  case ElementType::Float32:
    return 4;
  case ElementType::Int64:
  case ElementType::UInt64:
  case ElementType::Float64:
    return 8;
  }
  return 0;
}

constexpr bool isFloat(ElementType type) {
  return type >= ElementType::Float16;
}

/// The axes of an array, the slowest first.
using AxisOrder = std::array<std::size_t, 3>;
constexpr AxisOrder kXSlowest{0, 1, 2}; ///< [x][y][z], NumPy's order
constexpr AxisOrder kXFastest{2, 1, 0}; ///< [z][y][x], that of images
constexpr AxisOrder kYFastest{0, 2, 1}; ///< [x][z][y], that of .binvox

/// Index space beyond this is refused: planes and boxes are counted in 32 bits.
constexpr std::int32_t kFarthestVoxel = 1 << 30;

} // namespace tetvdb
