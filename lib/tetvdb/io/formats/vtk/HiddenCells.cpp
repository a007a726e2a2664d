// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/HiddenCells.h"

#include <algorithm>
#include <cstdint>
#include <variant>
#include <vector>

namespace tetvdb::vtk {
namespace {

// vtkDataSetAttributes::HIDDENCELL and HIDDENPOINT.
constexpr std::int64_t kHiddenCell = 32, kHiddenPoint = 2;

bool isGhostArray(const Attribute& attribute) {
  return attribute.name == kGhostArray && attribute.components == 1 && attribute.isInteger();
}

/// By element: whether its ghost type has this bit; empty without the array.
std::vector<bool> hidden(const CellMesh& mesh, Attribute::On on, std::int64_t bit) {
  std::vector<bool> found;
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.on == on && isGhostArray(attribute))
      std::visit(
          [&](const auto& values) {
            for (const auto value : values)
              found.push_back((static_cast<std::int64_t>(value) & bit) != 0);
          },
          attribute.values);
  return found;
}

/// Keeps of `values`, `width` an element, those of the elements in `kept`, ascending.
template <class Value>
void keep(std::vector<Value>& values, std::size_t width, const std::vector<std::size_t>& kept) {
  auto to = values.begin();
  for (const std::size_t element : kept)
    to = std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(element * width), width, to);
  values.erase(to, values.end());
}

} // namespace

void removeHiddenCells(CellMesh& mesh) {
  if (mesh.runs.size() != 1 || mesh.runs[0].nodesPerCell == 0)
    return;
  const std::size_t width = mesh.runs[0].nodesPerCell, cells = mesh.runs[0].count;
  std::vector<bool> hiddenCells = hidden(mesh, Attribute::On::Cells, kHiddenCell);
  std::vector<bool> hiddenPoints = hidden(mesh, Attribute::On::Points, kHiddenPoint);
  hiddenCells.resize(cells);
  hiddenPoints.resize(mesh.points.size());
  mesh.attributes.erase(
      std::remove_if(mesh.attributes.begin(), mesh.attributes.end(), isGhostArray),
      mesh.attributes.end());
  std::vector<std::size_t> kept;
  kept.reserve(cells);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    const std::uint32_t* nodes = mesh.nodes.data() + cell * width;
    if (!hiddenCells[cell] &&
        std::none_of(nodes, nodes + width, [&](std::uint32_t node) { return hiddenPoints[node]; }))
      kept.push_back(cell);
  }
  if (kept.size() == cells)
    return;
  keep(mesh.nodes, width, kept);
  for (Attribute& attribute : mesh.attributes)
    if (attribute.on == Attribute::On::Cells)
      std::visit([&](auto& values) { keep(values, attribute.components, kept); }, attribute.values);
  mesh.runs[0].count = kept.size();
}

} // namespace tetvdb::vtk
