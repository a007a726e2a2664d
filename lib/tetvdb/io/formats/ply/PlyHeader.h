// SPDX-License-Identifier: Apache-2.0
//
// The header of a .ply file.
#pragma once

#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/text/ByteReader.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

enum class PlyType : std::uint8_t { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float, Double };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::Float; ///< of the number or of each number of the list
  bool list = false;
  PlyType countType = PlyType::UInt8; ///< of a list's length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool hasLists() const {
    for (const PlyProperty& property : properties)
      if (property.list)
        return true;
    return false;
  }
};

struct PlyHeader {
  enum class Format : std::uint8_t { Text, LittleEndian, BigEndian };
  Format format = Format::Text;
  std::vector<PlyElement> elements;
  std::size_t bodyBegin = 0; ///< byte at which the data begins
  std::string unknown;       ///< a line before the elements that is no statement of the format
};

/// Throws Error(Invalid) with the line for a header that is incomplete, has unknown types, no
/// element `vertex` with x, y and z, or no faces.
PlyHeader parsePlyHeader(const Source& source);

constexpr std::size_t plyTypeSize(PlyType type) {
  switch (type) {
  case PlyType::Int8:
  case PlyType::UInt8:
    return 1;
  case PlyType::Int16:
  case PlyType::UInt16:
    return 2;
  case PlyType::Double:
    return 8;
  default:
    return 4;
  }
}

inline double loadPlyNumber(const char* from, PlyType type, bool swap) {
  switch (type) {
  case PlyType::Int8:
    return loadNumber<std::int8_t>(from, swap);
  case PlyType::UInt8:
    return loadNumber<std::uint8_t>(from, swap);
  case PlyType::Int16:
    return loadNumber<std::int16_t>(from, swap);
  case PlyType::UInt16:
    return loadNumber<std::uint16_t>(from, swap);
  case PlyType::Int32:
    return loadNumber<std::int32_t>(from, swap);
  case PlyType::UInt32:
    return loadNumber<std::uint32_t>(from, swap);
  case PlyType::Float:
    return static_cast<double>(loadNumber<float>(from, swap));
  case PlyType::Double:
    break;
  }
  return loadNumber<double>(from, swap);
}

} // namespace tetvdb
