// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/xdmf/XdmfFunction.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"

#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kCorners = 4;
constexpr long kMaxDegree = 32;

bool isOneOf(std::string_view word, std::initializer_list<std::string_view> words) {
  for (const std::string_view known : words)
    if (sameWord(word, known))
      return true;
  return false;
}

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw Error(Status::Invalid, where, what, kExport);
}

std::vector<std::uint64_t> indicesOf(const Attribute::Values& values, std::size_t limit,
                                     const std::string& where) {
  return std::visit(
      [&](const auto& numbers) {
        std::vector<std::uint64_t> indices;
        indices.reserve(numbers.size());
        for (const auto number : numbers) {
          const auto index = static_cast<double>(number);
          if (!(index >= 0) || index >= static_cast<double>(limit))
            fail(where,
                 "a cell names number " + std::to_string(number) + " of " + std::to_string(limit));
          indices.push_back(static_cast<std::uint64_t>(number));
        }
        return indices;
      },
      values);
}

} // namespace

std::optional<XdmfFunction> xdmfFunction(pugi::xml_node attribute) {
  if (!sameWord(attribute.attribute("ItemType").value(), "FiniteElementFunction") ||
      !sameWord(attribute.attribute("ElementCell").value(), "tetrahedron"))
    return {};
  const std::string_view family = attribute.attribute("ElementFamily").value();
  const char* text = attribute.attribute("ElementDegree").value();
  char* end = nullptr;
  const long degree = std::strtol(text, &end, 10);
  if (end == text || *end != 0 || degree < 0 || degree > kMaxDegree)
    return {};
  if (isOneOf(family, {"DG", "DP", "Discontinuous Lagrange"}) && degree == 0)
    return XdmfFunction{Attribute::On::Cells, 0, 1};
  if (!isOneOf(family, {"CG", "P", "Lagrange"}) || degree == 0)
    return {};
  const auto n = static_cast<std::size_t>(degree);
  return XdmfFunction{Attribute::On::Points, n, (n + 1) * (n + 2) * (n + 3) / 6};
}

Attribute arrayOf(const XdmfFunction& function, const Attribute::Values& cellDofs,
                  const Attribute::Values& numbers, const CellMesh& mesh,
                  const std::string& where) {
  const std::size_t cells = mesh.cellCount();
  const std::size_t count = std::visit([](const auto& v) { return v.size(); }, numbers);
  for (const CellRun& run : mesh.runs)
    if (run.type != CellType::Tetra || run.nodesPerCell != kCorners)
      fail(where, "is a function over tetrahedra, but the mesh has other cells");
  const std::vector<std::uint64_t> dofs = indicesOf(cellDofs, count, where);
  if (cells == 0 || dofs.empty() || dofs.size() % (cells * function.dofs) != 0)
    fail(where, std::to_string(dofs.size()) + " numbers of cells do not fit " +
                    std::to_string(cells) + " cells with " + std::to_string(function.dofs) +
                    " for each component");
  const std::size_t components = dofs.size() / (cells * function.dofs);
  if (components > 9)
    fail(where, "has " + std::to_string(components) + " components");

  const bool onPoints = function.on == Attribute::On::Points;
  std::vector<double> values((onPoints ? mesh.points.size() : cells) * components,
                             std::numeric_limits<double>::quiet_NaN());
  std::visit(
      [&](const auto& from) {
        for (std::size_t cell = 0; cell < cells; ++cell)
          for (std::size_t c = 0; c < components; ++c) {
            const std::uint64_t* own = dofs.data() + (cell * components + c) * function.dofs;
            for (std::size_t k = 0; k < (onPoints ? kCorners : 1); ++k) {
              const std::size_t element = onPoints ? mesh.nodes[kCorners * cell + k] : cell;
              values[element * components + c] = static_cast<double>(from[own[k]]);
            }
          }
      },
      numbers);
  return {"", function.on, static_cast<std::uint32_t>(components), std::move(values)};
}

} // namespace tetvdb
