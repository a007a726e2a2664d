// SPDX-License-Identifier: Apache-2.0
#include "InfoReport.h"

#include "JobReport.h"
#include "tetvdb/io/Formats.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tetvdb::cli {

using Json = nlohmann::ordered_json;

ValueSpan rangeOf(const Attribute& attribute) {
  ValueSpan range;
  std::visit(
      [&](const auto& values) {
        for (const auto value : values) {
          const auto number = static_cast<double>(value);
          if (!std::isfinite(number)) {
            ++range.notFinite;
            continue;
          }
          range.min = range.empty ? number : std::min(range.min, number);
          range.max = range.empty ? number : std::max(range.max, number);
          range.empty = false;
        }
      },
      attribute.values);
  return range;
}

const char* typeName(const Attribute& attribute) {
  constexpr const char* kNames[] = {"float", "double", "int32", "int64"};
  return kNames[attribute.values.index()];
}

std::map<std::int32_t, std::size_t> countRegions(const TetMesh& mesh) {
  std::map<std::int32_t, std::size_t> counts;
  for (const std::int32_t region : mesh.regions)
    ++counts[region];
  return counts;
}

std::string regionName(const TetMesh& mesh, std::int32_t number) {
  const auto known = mesh.regionNames.find(number);
  return known == mesh.regionNames.end() ? std::string() : known->second;
}

Json sectionOf(const InputInfo& info, const TetMesh& mesh) {
  Json cells = Json::object();
  for (const auto& [type, count] : info.cells)
    cells[type] = count;
  Json regions = Json::array();
  for (const auto& [number, count] : countRegions(mesh))
    regions.push_back({{"number", number}, {"name", regionName(mesh, number)}, {"cells", count}});
  Json attributes = Json::array();
  for (const Attribute& attribute : mesh.attributes) {
    const ValueSpan range = rangeOf(attribute);
    attributes.push_back({{"name", attribute.name},
                          {"on", attribute.on == Attribute::On::Points ? "points" : "cells"},
                          {"type", typeName(attribute)},
                          {"components", attribute.components},
                          {"min", range.empty ? Json() : Json(range.min)},
                          {"max", range.empty ? Json() : Json(range.max)},
                          {"not_finite", range.notFinite}});
  }
  const TetStatistics& statistics = info.statistics;
  return {{"path", info.path},
          {"format", formatName(info.format)},
          {"kind", "tets"},
          {"vertices", info.vertices},
          {"tets", info.tets},
          {"cells", std::move(cells)},
          {"defects", {{"inverted", statistics.inverted}, {"flat", statistics.flat}}},
          {"box", {{"min", statistics.boxMin}, {"max", statistics.boxMax}}},
          {"volume", statistics.volume},
          {"steps", {{"count", info.times.size()}, {"times", info.times}}},
          {"regions", std::move(regions)},
          {"attributes", std::move(attributes)}};
}

Json sectionOf(const GridInfo& grid) {
  Json section = toJson(grid);
  section["linear"] = grid.linear;
  section["min"] = grid.minValue;
  section["max"] = grid.maxValue;
  Json metadata = Json::object();
  for (const auto& [key, value] : grid.metadata)
    metadata[key] = value;
  section["metadata"] = std::move(metadata);
  return section;
}

} // namespace tetvdb::cli
