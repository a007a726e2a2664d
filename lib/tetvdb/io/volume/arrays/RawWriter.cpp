// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/volume/arrays/ArrayWriters.h"

#include <fmt/format.h>

namespace tetvdb {
namespace {

// A JSON string; names and metadata may hold any bytes.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      (out += '\\') += c;
    else if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  return out + "\"";
}

std::string mhdHeader(const ArrayContent& content) {
  const VoxelBox& box = content.box;
  const auto& m = content.transform;
  const Vec3d h = content.voxelSize();
  std::string text = fmt::format(
      "{{\n  \"byte_order\": \"little\",\n  \"axis_order\": \"x fastest\",\n"
      "  \"size\": [{}, {}, {}],\n  \"origin\": [{}, {}, {}],\n  \"voxel_size\": [{}, {}, {}],\n"
      "  \"transform\": [",
      box.size(0), box.size(1), box.size(2), box.low[0], box.low[1], box.low[2], h[0], h[1], h[2]);
  for (std::size_t row = 0; row < 4; ++row)
    text += fmt::format("{}[{}, {}, {}, {}]", row == 0 ? "" : ", ", m[4 * row], m[4 * row + 1],
                        m[4 * row + 2], m[4 * row + 3]);
  text += "],\n  \"arrays\": [";
  std::uint64_t offset = 0;
  for (std::size_t i = 0; i < content.grids.size(); ++i) {
    const DenseGrid& grid = *content.grids[i];
    const auto bytes = static_cast<std::uint64_t>(grid.bytes());
    text += fmt::format("{}\n    {{\"name\": {}, \"type\": \"{}\", \"components\": {}, "
                        "\"offset\": {}, \"bytes\": {}}}",
                        i == 0 ? "" : ",", quoted(content.names[i]), namesOf(grid.element()).plain,
                        grid.components(), offset, bytes);
    offset += bytes;
  }
  text += "\n  ],\n  \"metadata\": {";
  const char* comma = "";
  for (const auto& [key, value] : content.metadata) {
    text += fmt::format("{}\n    {}: {}", comma, quoted(key), quoted(value));
    comma = ",";
  }
  return text + (content.metadata.empty() ? "}\n}\n" : "\n  }\n}\n");
}

} // namespace

void writeRaw(const ArrayContent& content, Progress& progress) {
  AtomicFile file(content.path);
  AtomicFile header(content.path + ".json");
  const std::string text = mhdHeader(content);
  header.write(text.data(), text.size());
  ArrayStream stream(content, progress);
  for (const auto& grid : content.grids)
    stream.send(*grid, kXFastest,
                [&](const char* bytes, std::size_t size) { file.write(bytes, size); });
  file.commit();
  header.commit();
}

} // namespace tetvdb
