// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/MergeMeshes.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxElements = std::numeric_limits<std::uint32_t>::max() - 1;

bool sameKind(const Attribute& a, const Attribute& b) {
  return a.name == b.name && a.on == b.on && a.components == b.components &&
         a.values.index() == b.values.index();
}

Attribute* findSame(TetMesh& mesh, const Attribute& wanted) {
  for (Attribute& attribute : mesh.attributes)
    if (sameKind(attribute, wanted))
      return &attribute;
  return nullptr;
}

void appendValues(Attribute& to, const Attribute& from) {
  std::visit(
      [&](auto& values) {
        const auto& more = std::get<std::decay_t<decltype(values)>>(from.values);
        values.insert(values.end(), more.begin(), more.end());
      },
      to.values);
}

void appendAttributes(TetMesh& to, TetMesh& from) {
  auto& kept = to.attributes;
  kept.erase(std::remove_if(kept.begin(), kept.end(),
                            [&](const Attribute& a) { return findSame(from, a) == nullptr; }),
             kept.end());
  for (Attribute& attribute : kept)
    appendValues(attribute, *findSame(from, attribute));
}

void appendRegions(TetMesh& to, const TetMesh& from, Report& report) {
  if (!to.regions.empty() || !from.regions.empty()) {
    to.regions.resize(to.cellCount, 0);
    to.regions.insert(to.regions.end(), from.regions.begin(), from.regions.end());
    to.regions.resize(to.cellCount + from.cellCount, 0);
  }
  for (const auto& [number, name] : from.regionNames) {
    const auto [known, added] = to.regionNames.emplace(number, name);
    if (!added && known->second != name)
      report.warn("region-names", "region " + std::to_string(number) + " is '" + known->second +
                                      "' in one input and '" + name +
                                      "' in another; the first name was kept");
  }
}

void appendCurved(TetMesh& to, const TetMesh& from) {
  if (to.curved.empty() && from.curved.empty())
    return;
  CurvedCells& all = to.curved;
  const CurvedCells& more = from.curved;
  const auto firstPoint = static_cast<std::uint32_t>(to.points.size());
  const auto firstCell = static_cast<std::uint32_t>(all.cells.size());
  const std::uint64_t firstNode = all.nodes.size();
  for (const CurvedCells::Cell& cell : more.cells)
    all.cells.push_back({firstNode + cell.first, cell.shape});
  all.cellOfTet.resize(to.tetCount(), CurvedCells::kLinear);
  all.corners.resize(to.tetCount());
  for (const std::uint32_t node : more.nodes)
    all.nodes.push_back(firstPoint + node);
  for (const std::uint32_t cell : more.cellOfTet)
    all.cellOfTet.push_back(cell == CurvedCells::kLinear ? cell : firstCell + cell);
  all.corners.insert(all.corners.end(), more.corners.begin(), more.corners.end());
  all.cellOfTet.resize(to.tetCount() + from.tetCount(), CurvedCells::kLinear);
  all.corners.resize(to.tetCount() + from.tetCount());
}

void append(TetMesh& to, TetMesh&& from, Report& report) {
  if (to.points.size() + from.points.size() > kMaxElements ||
      to.cellCount + from.cellCount > kMaxElements)
    throw Error(Status::Limit, "", "the inputs together have more than 2^32 - 2 points or cells",
                "voxelize them one by one");
  const auto firstPoint = static_cast<std::uint32_t>(to.points.size());
  const auto firstCell = static_cast<std::uint32_t>(to.cellCount);

  // If every tet is its own cell in both, the short form (no cellOfTet) is sufficient.
  const bool plain = to.cellOfTet.empty() && from.cellOfTet.empty() &&
                     to.tetCount() == to.cellCount && from.tetCount() == from.cellCount;
  if (!plain) {
    std::vector<std::uint32_t> cells;
    cells.reserve(to.tetCount() + from.tetCount());
    for (std::size_t t = 0; t < to.tetCount(); ++t)
      cells.push_back(to.cell(t));
    for (std::size_t t = 0; t < from.tetCount(); ++t)
      cells.push_back(firstCell + from.cell(t));
    to.cellOfTet = std::move(cells);
  }
  appendRegions(to, from, report);
  appendAttributes(to, from);
  appendCurved(to, from);
  to.points.insert(to.points.end(), from.points.begin(), from.points.end());
  to.tets.reserve(to.tets.size() + from.tets.size());
  for (const std::uint32_t corner : from.tets)
    to.tets.push_back(firstPoint + corner);
  to.cellCount += from.cellCount;
}

} // namespace

TetMesh mergeMeshes(std::vector<TetMesh>&& meshes, Report& report) {
  if (meshes.empty())
    return {};
  TetMesh all = std::move(meshes.front());
  for (std::size_t i = 1; i < meshes.size(); ++i) {
    append(all, std::move(meshes[i]), report);
    meshes[i] = TetMesh();
  }
  return all;
}

TriangleMesh mergeMeshes(std::vector<TriangleMesh>&& meshes, Report& report) {
  if (meshes.empty())
    return {};
  const bool oneUnit = haveOneUnit(meshes, report);
  TriangleMesh all = std::move(meshes.front());
  for (std::size_t i = 1; i < meshes.size(); ++i) {
    const TriangleMesh& mesh = meshes[i];
    if (mesh.points.size() > kMaxElements - all.points.size())
      throw Error(Status::Limit, "", "the inputs together have more than 2^32 - 2 points",
                  "voxelize them one by one");
    const auto first = static_cast<std::uint32_t>(all.points.size());
    all.points.insert(all.points.end(), mesh.points.begin(), mesh.points.end());
    all.triangles.reserve(all.triangles.size() + mesh.triangles.size());
    for (const std::uint32_t v : mesh.triangles)
      all.triangles.push_back(first + v);
    all.faceCount += mesh.faceCount;
  }
  if (!oneUnit)
    all.units.clear();
  return all;
}

bool haveOneUnit(const std::vector<TriangleMesh>& meshes, Report& report) {
  for (const TriangleMesh& mesh : meshes) {
    if (mesh.units == meshes.front().units)
      continue;
    report.warn("mixed-units", "the inputs are in different units; lengths are not converted");
    return false;
  }
  return true;
}

} // namespace tetvdb
