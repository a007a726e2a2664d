// SPDX-License-Identifier: Apache-2.0
//
// Arrays of VTK's files, whatever their number type and byte order, into ours.
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

/// Number types of VTK's arrays. Bit: one bit a number in binary data, the highest first.
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

/// Type of an XML file's `type="Float32"`; nothing for String and what is unknown.
std::optional<Number> xmlNumber(std::string_view name);
/// Type of a legacy file's `float`, `vtkIdType` (32 bits in a file), ... in any case; nothing for
/// string, variant and what is unknown.
std::optional<Number> legacyNumber(std::string_view name);
/// Bytes that `count` numbers take in binary data.
std::uint64_t bytesFor(Number type, std::uint64_t count);
/// True for everything but Float32 and Float64.
bool isInteger(Number type);

/// Numbers as they lie in a file. A view, unless `owned` holds them.
struct Array {
  Number type = Number::Float64;
  bool swap = false; ///< in the byte order that is not this machine's
  const char* data = nullptr;
  std::size_t count = 0; ///< numbers, not bytes
  std::unique_ptr<char[]> owned;
  std::string where; ///< for messages: "file:line" or "file at byte N"
};

/// Reads `count` numbers of a text, rounded to `type`. Throws Error(Invalid) where the text has
/// fewer, or an integer that does not fit its type; nan and inf are numbers.
Array parseText(NumberParser& in, Number type, std::size_t count, Progress& progress);

/// Throws Error(Invalid) for a number that is not finite. `array.count` is a multiple of 3.
std::vector<Vec3d> toPoints(const Array& array);
/// Point indices; what lies outside 0 to 2^32 - 2 becomes 2^32 - 1, which no mesh has.
/// Throws Error(Invalid) for floating-point numbers, as the next two do.
std::vector<std::uint32_t> toIndices(const Array& array);
/// Offsets; negative ones become 2^63.
std::vector<std::uint64_t> toOffsets(const Array& array);
/// VTK cell types; what lies outside 0 to 255 becomes 255, which is none.
std::vector<std::uint8_t> toTypes(const Array& array);
/// Widened as mesh/Attribute.h says; 64-bit numbers above 2^63 - 1 become negative.
Attribute toAttribute(std::string name, Attribute::On on, std::uint32_t components,
                      const Array& array);

} // namespace tetvdb::vtk
