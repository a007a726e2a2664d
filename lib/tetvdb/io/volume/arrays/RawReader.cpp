// SPDX-License-Identifier: Apache-2.0
//
// Numbers without a header; what they are is in NAME.raw.json, as RawWriter.cpp writes it.
#include "tetvdb/io/volume/arrays/ArrayReaders.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace tetvdb {
namespace {

using Json = nlohmann::json;

// Both throw what nlohmann throws where it is no whole number.
std::uint64_t wholeOf(const Json& json) {
  return json.get_ref<const std::uint64_t&>();
}
std::int32_t firstOf(const Json& json) {
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(json.get_ref<const std::int64_t&>(), INT32_MIN / 2, INT32_MAX / 2));
}

StoredArray arrayOf(const Json& json, const Source& source) {
  StoredArray array;
  array.name = json.at("name").get<std::string>();
  const auto type = json.at("type").get<std::string>();
  bool known = false;
  for (const ElementType element : kElementTypes)
    if (type == namesOf(element).plain) {
      array.element = element;
      known = true;
    }
  if (!known)
    throw Error(Status::Invalid, source.path, "numbers of type '" + type + "' are not read");
  array.components = wholeOf(json.at("components"));
  const auto offset = wholeOf(json.at("offset"));
  if (offset > source.bytes.size())
    throw Error(Status::Invalid, source.path,
                "the array '" + array.name + "' begins beyond its end", kCut);
  array.bytes = source.bytes.substr(static_cast<std::size_t>(offset));
  return array;
}

} // namespace

void readRawArrays(std::string_view header, const std::string& headerPath, const Source& source,
                   const ArraySink& sink) try {
  const Json json = Json::parse(header);
  const bool swap = json.value("byte_order", "little") == "big";
  for (const Json& entry : json.at("arrays")) {
    StoredArray array = arrayOf(entry, source);
    array.swap = swap;
    for (std::size_t k = 0; k < 3; ++k) {
      array.size[k] = wholeOf(json.at("size").at(k));
      if (json.contains("origin"))
        array.low[k] = firstOf(json["origin"].at(k));
    }
    if (json.contains("transform")) {
      array.placed = true;
      for (std::size_t i = 0; i < 16; ++i)
        array.transform[i] = json["transform"].at(i / 4).at(i % 4).get<double>();
    }
    array.setSteps(json.value("axis_order", "x fastest") == "z fastest" ? kXSlowest : kXFastest);
    const std::uint64_t sizes[] = {array.size[0], array.size[1], array.size[2], array.components};
    requireBytes(source.path, array.bytes.size(), bytesOf(array.element), sizes);
    sink.array(array);
  }
  if (json.contains("metadata"))
    for (const auto& [key, value] : json["metadata"].items())
      if (value.is_string())
        sink.metadata(key, value.get<std::string>());
} catch (const Json::exception& damage) {
  throw Error(Status::Invalid, headerPath, std::string("is no header of arrays: ") + damage.what());
}

void readRaw(const Source& source, const ArraySink& sink, Progress&) {
  const std::string path = source.path + ".json";
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw Error(Status::Invalid, source.path,
                "has no header '" + path + "', which says what it holds",
                "write one as docs/formats.md shows");
  const MappedFile header(path);
  readRawArrays(header.bytes(), path, source, sink);
}

} // namespace tetvdb
