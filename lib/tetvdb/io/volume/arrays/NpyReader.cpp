// SPDX-License-Identifier: Apache-2.0
//
// Format: NEP 1, versions 1.0 to 3.0: a dictionary as Python writes it, then the numbers.
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"
#include "tetvdb/io/volume/arrays/NpyArray.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tetvdb {
namespace {

/// The text after a key and its colon.
std::string_view valueOf(std::string_view dictionary, std::string_view key,
                         const std::string& where) {
  for (const char quote : {'\'', '"'}) {
    const std::string name = quote + std::string(key) + quote;
    std::size_t at = dictionary.find(name);
    if (at == dictionary.npos)
      continue;
    at = dictionary.find_first_not_of(" \t:", at + name.size());
    return dictionary.substr(std::min(at, dictionary.size()));
  }
  throw Error(Status::Invalid, where, "the header has no '" + std::string(key) + "'", kCut);
}

void setType(std::string_view text, NpyArray& array) {
  if (text.empty() || (text[0] != '\'' && text[0] != '"')) {
    array.unknownType = "records";
    return;
  }
  const std::string_view type = text.substr(1, text.find(text[0], 1) - 1);
  array.isBits = type == "|b1" || type == "?";
  array.swap = !type.empty() && type[0] == '>';
  if (array.isBits) {
    array.element = ElementType::UInt8;
    return;
  }
  for (const ElementType element : kElementTypes)
    if (type.size() == 3 && type.substr(1) == std::string_view(namesOf(element).numpy).substr(1)) {
      array.element = element;
      return;
    }
  array.unknownType = type;
}

void setShape(std::string_view text, const std::string& where, NpyArray& array) {
  const std::size_t end = text.find(')');
  if (text.empty() || text[0] != '(' || end == text.npos)
    throw Error(Status::Invalid, where, "the header's shape is no list of numbers", kCut);
  const char* at = text.data() + 1;
  const char* const stop = text.data() + end;
  while (at != stop) {
    if (*at == ' ' || *at == ',' || *at == 'L') {
      ++at;
      continue;
    }
    std::uint64_t size = 0;
    const auto [next, error] = std::from_chars(at, stop, size);
    if (error != std::errc() || array.shape.size() == 32)
      throw Error(Status::Invalid, where, "the header's shape is no list of numbers", kCut);
    array.shape.push_back(size);
    at = next;
  }
}

// IEEE 754's binary16.
double halfNumber(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31, fraction = bits & 1023;
  const double magnitude = exponent == 0    ? std::ldexp(fraction, -24)
                           : exponent == 31 ? (fraction == 0 ? HUGE_VAL : NAN)
                                            : std::ldexp(fraction + 1024, exponent - 25);
  return bits >> 15 != 0 ? -magnitude : magnitude;
}

} // namespace

std::string NpyArray::describe() const {
  return (shape.empty() ? "one" : fmt::format("{}", fmt::join(shape, " x "))) + " of " +
         (!unknownType.empty() ? unknownType
          : isBits             ? "bool"
                               : namesOf(element).plain);
}

double NpyArray::number(std::size_t i) const {
  const char* at = bytes.data() + i * bytesOf(element);
  switch (element) {
  case ElementType::Int8:
    return loadNumber<std::int8_t>(at, swap);
  case ElementType::UInt8:
    return loadNumber<std::uint8_t>(at, swap);
  case ElementType::Int16:
    return loadNumber<std::int16_t>(at, swap);
  case ElementType::UInt16:
    return loadNumber<std::uint16_t>(at, swap);
  case ElementType::Int32:
    return loadNumber<std::int32_t>(at, swap);
  case ElementType::UInt32:
    return loadNumber<std::uint32_t>(at, swap);
  case ElementType::Int64:
    return static_cast<double>(loadNumber<std::int64_t>(at, swap));
  case ElementType::UInt64:
    return static_cast<double>(loadNumber<std::uint64_t>(at, swap));
  case ElementType::Float16:
    return halfNumber(loadNumber<std::uint16_t>(at, swap));
  case ElementType::Float32:
    return static_cast<double>(loadNumber<float>(at, swap));
  case ElementType::Float64:
    break;
  }
  return loadNumber<double>(at, swap);
}

NpyArray parseNpy(std::string_view bytes, const std::string& where) {
  ByteReader in(bytes, where);
  if (in.take(6) != "\x93NUMPY")
    throw Error(Status::Invalid, where, "is no .npy file", kExport);
  const int version = in.get<std::uint8_t>();
  in.skip(1);
  const std::uint32_t length = version == 1 ? in.get<std::uint16_t>() : in.get<std::uint32_t>();
  const std::string_view header = in.take(length);
  NpyArray array;
  setType(valueOf(header, "descr", where), array);
  array.isFortran = valueOf(header, "fortran_order", where).substr(0, 4) == "True";
  setShape(valueOf(header, "shape", where), where, array);
  array.bytes =
      in.take(array.unknownType.empty()
                  ? requireBytes(where, in.remaining(), bytesOf(array.element), array.shape)
                  : 0);
  return array;
}

bool setVoxels(const NpyArray& from, StoredArray& array) {
  if (!from.unknownType.empty())
    return false;
  struct Axis {
    std::uint64_t size, step;
  };
  std::vector<Axis> axes(from.shape.size());
  std::uint64_t step = 1;
  for (std::size_t n = 0; n < axes.size(); ++n) {
    const std::size_t i = from.isFortran ? n : axes.size() - 1 - n;
    axes[i] = {from.shape[i], step};
    step *= from.shape[i];
  }
  const auto hasComponentsLast = [&] {
    return axes.size() == 4 && axes[3].size > 1 && axes[3].size <= kMostFastComponents;
  };
  while (axes.size() > 3 && axes[0].size == 1 && !hasComponentsLast())
    axes.erase(axes.begin());
  if (axes.size() == 4) {
    const bool isLast = axes[3].size <= kMostFastComponents;
    if (!isLast && axes[0].size > kMostSlowComponents)
      return false;
    const auto component = isLast ? axes.end() - 1 : axes.begin();
    array.components = component->size;
    array.componentStep = component->step;
    axes.erase(component);
  }
  if (axes.size() != 3)
    return false;
  for (std::size_t k = 0; k < 3; ++k) {
    array.size[k] = axes[k].size;
    array.step[k] = axes[k].step;
  }
  array.element = from.element;
  array.swap = from.swap;
  array.isBits = from.isBits;
  array.bytes = from.bytes;
  return true;
}

void readNpy(const Source& source, const ArraySink& sink, Progress&) {
  const NpyArray found = parseNpy(source.bytes, source.path);
  StoredArray array;
  if (!setVoxels(found, array))
    throw Error(Status::Invalid, source.path, "holds no array of voxels but " + found.describe(),
                "save numbers [x][y][z], with up to 4 components on a last axis");
  sink.array(array);
}

} // namespace tetvdb
