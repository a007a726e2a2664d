// SPDX-License-Identifier: Apache-2.0
//
// Format: "Definition of NRRD File Format", NRRD0004.
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/volume/arrays/ArrayWriters.h"
#include "tetvdb/io/volume/arrays/GzipStream.h"

#include <fmt/format.h>

namespace tetvdb {
namespace {

std::string vectorText(const Vec3d& v) {
  return fmt::format("({},{},{})", v[0], v[1], v[2]);
}

// Quotes would end a unit's name.
std::string unitText(const std::string& unit) {
  std::string text;
  for (const char c : unit)
    text += c == '"' || static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return "\"" + text + "\"";
}

std::string nrrdHeader(const ArrayContent& content) {
  const DenseGrid& grid = *content.grids.front();
  const bool isVector = grid.components() > 1;
  const auto& m = content.transform;
  std::string text = fmt::format("NRRD0004\ntype: {}\ndimension: {}\nspace dimension: 3\nsizes:",
                                 namesOf(grid.element()).nrrd, isVector ? 4 : 3);
  if (isVector)
    text += fmt::format(" {}", grid.components());
  for (std::size_t axis = 0; axis < 3; ++axis)
    text += fmt::format(" {}", content.box.size(axis));
  text += isVector ? "\nspace directions: none" : "\nspace directions:";
  for (std::size_t axis = 0; axis < 3; ++axis)
    text += " " + vectorText({m[axis], m[4 + axis], m[8 + axis]});
  text += isVector ? "\nkinds: vector domain domain domain" : "\nkinds: domain domain domain";
  const auto units = content.metadata.find("units");
  if (units != content.metadata.end()) {
    const std::string unit = unitText(units->second);
    text += "\nspace units: " + unit + " " + unit + " " + unit;
  }
  const VoxelBox& box = content.box;
  const Vec3d first =
      content.worldOf({static_cast<double>(box.low[0]), static_cast<double>(box.low[1]),
                       static_cast<double>(box.low[2])});
  return text + fmt::format("\nendian: little\nencoding: {}\nspace origin: {}\n"
                            "content: {}\nvoxel_origin:={} {} {}\nworld_origin:={} {} {}\n\n",
                            content.compress ? "gzip" : "raw", vectorText(first),
                            content.names.front(), box.low[0], box.low[1], box.low[2], m[3], m[7],
                            m[11]);
}

} // namespace

void writeNrrd(const ArrayContent& content, Progress& progress) {
  content.requireOneGrid("a .nrrd file");
  AtomicFile file(content.path);
  const std::string header = nrrdHeader(content);
  file.write(header.data(), header.size());
  ArrayStream stream(content, progress);
  const DenseGrid& grid = *content.grids.front();
  if (content.compress) {
    GzipStream gzip(file);
    stream.send(grid, kXFastest,
                [&](const char* bytes, std::size_t size) { gzip.write(bytes, size); });
    gzip.finish();
  } else {
    stream.send(grid, kXFastest,
                [&](const char* bytes, std::size_t size) { file.write(bytes, size); });
  }
  file.commit();
}

} // namespace tetvdb
