// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/cells/StructuredBlock.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/source/Advice.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tetvdb {

std::size_t blockPoints(const BlockSize& size, std::size_t max, const std::string& where) {
  // As a product of doubles, which does not overflow.
  const double n = double(size[0]) * double(size[1]) * double(size[2]);
  if (n > double(max))
    throw Error(Status::Invalid, where,
                "a structured grid of " + std::to_string(size[0]) + " x " +
                    std::to_string(size[1]) + " x " + std::to_string(size[2]) +
                    " points is declared, more than the file holds",
                kCut);
  checkPointCount(size[0] * size[1] * size[2], where);
  return size[0] * size[1] * size[2];
}

std::vector<Vec3d> rectilinearPoints(const std::array<std::vector<double>, 3>& coordinates,
                                     std::size_t bytes, const std::string& where) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double x : coordinates[axis])
      if (!std::isfinite(x))
        throw Error(Status::Invalid, where,
                    std::string("a coordinate along ") + "xyz"[axis] + " is not finite", kExport);
  const BlockSize size = {coordinates[0].size(), coordinates[1].size(), coordinates[2].size()};
  std::vector<Vec3d> points;
  points.reserve(blockPoints(size, maxRectilinearPoints(bytes), where));
  for (const double z : coordinates[2])
    for (const double y : coordinates[1])
      for (const double x : coordinates[0])
        points.push_back({x, y, z});
  return points;
}

std::size_t blockCells(const BlockSize& size) {
  std::size_t cells = 1;
  for (const std::size_t points : size)
    cells *= points == 0 ? 0 : std::max<std::size_t>(points - 1, 1);
  return cells;
}

bool isSolidBlock(const BlockSize& size) {
  return std::all_of(size.begin(), size.end(), [](std::size_t points) { return points > 1; });
}

std::size_t appendBlock(CellMesh& mesh, const BlockSize& size, std::size_t firstPoint, bool faces) {
  static constexpr CellKind kHexahedron{"structured", CellType::Hexahedron, 8, 8};
  static constexpr CellKind kQuad{"structured quad", CellType::Flat, 4, 4};
  static constexpr CellKind kCounted{"structured flat", CellType::Flat, 0, 0};
  const std::size_t count = blockCells(size);
  std::array<std::size_t, 3> step{}; // to the next point; of axes with cells
  std::size_t axes = 0;
  for (std::size_t k = 0, stride = 1; k < 3; stride *= size[k++])
    if (size[k] > 1)
      step[axes++] = stride;
  if (count == 0)
    return 0;
  if (axes < 2 || (axes == 2 && !faces)) {
    appendCells(mesh, kCounted, count);
    return count;
  }
  // Corners in VTK's order, as distances from the first.
  const std::array<std::size_t, 8> corners = {
      0,       step[0],           step[0] + step[1],           step[1],
      step[2], step[0] + step[2], step[0] + step[1] + step[2], step[1] + step[2]};
  const std::size_t used = axes == 3 ? 8 : 4;
  mesh.nodes.reserve(mesh.nodes.size() + used * count);
  const auto cellsAlong = [&](std::size_t axis) {
    return std::max<std::size_t>(size[axis] - 1, 1);
  };
  for (std::size_t k = 0; k < cellsAlong(2); ++k)
    for (std::size_t j = 0; j < cellsAlong(1); ++j)
      for (std::size_t i = 0; i < cellsAlong(0); ++i) {
        const std::size_t first = firstPoint + i + size[0] * (j + size[1] * k);
        for (std::size_t corner = 0; corner < used; ++corner)
          mesh.nodes.push_back(static_cast<std::uint32_t>(first + corners[corner]));
      }
  appendCells(mesh, axes == 3 ? kHexahedron : kQuad, count);
  return count;
}

} // namespace tetvdb
