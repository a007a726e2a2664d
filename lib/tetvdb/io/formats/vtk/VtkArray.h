// SPDX-License-Identifier: Apache-2.0
//
// Converts arrays of VTK's files, of any number type and byte order.
//
//   tetvdb::vtk::Array array = ...;                       // numbers as they lie in the file
//   mesh.points = tetvdb::vtk::toPoints(array);
//   mesh.attributes.push_back(tetvdb::vtk::toAttribute("T", Attribute::On::Points, 1, array));
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/io/text/NumberParser.h"
#include "tetvdb/mesh/Attribute.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb::vtk {

/// Number types of VTK's arrays. Bit: one bit per number in binary data, the highest first.
enum class Number : std::uint8_t {
  Bit,
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float32,
  Float64
};

/// Type of an XML file's `type="Float32"`; none for String and unknown types.
std::optional<Number> xmlNumber(std::string_view name);
/// Type of a legacy file's `float`, `vtkIdType` (32 bits in a file), ... in any case; none for
/// string, variant and unknown types.
std::optional<Number> legacyNumber(std::string_view name);
/// Bytes of `count` numbers in binary data.
std::uint64_t bytesFor(Number type, std::uint64_t count);
/// True for all types except Float32 and Float64.
bool isInteger(Number type);

/// Numbers as stored in a file. A view, unless `owned` holds them.
struct Array {
  Number type = Number::Float64;
  bool swap = false; ///< in the byte order opposite to this machine's
  const char* data = nullptr;
  std::size_t count = 0; ///< numbers, not bytes
  std::unique_ptr<char[]> owned;
  std::string where; ///< for messages: "file:line" or "file at byte N"
};

/// Reads `count` numbers of a text, rounded to `type`. Throws Error(Invalid) if the text has fewer,
/// or an integer that exceeds its type; nan and inf are numbers.
Array parseText(NumberParser& in, Number type, std::size_t count, Progress& progress);

/// Throws Error(Invalid) for a number that is not finite. `array.count` is a multiple of 3.
std::vector<Vec3d> toPoints(const Array& array);
/// Coordinates of a rectilinear grid.
std::vector<double> toDoubles(const Array& array);
/// Point indices; values outside 0 to 2^32 - 2 become 2^32 - 1, which no mesh has. Throws
/// Error(Invalid) for floating-point numbers, as do the next two functions.
std::vector<std::uint32_t> toIndices(const Array& array);
/// Offsets; negative ones become 2^63.
std::vector<std::uint64_t> toOffsets(const Array& array);
/// VTK cell types; values outside 0 to 255 become 255, which is not a type.
std::vector<std::uint8_t> toTypes(const Array& array);
/// Widened as in mesh/Attribute.h; 64-bit numbers above 2^63 - 1 become negative.
Attribute toAttribute(std::string name, Attribute::On on, std::uint32_t components,
                      const Array& array);

} // namespace tetvdb::vtk
