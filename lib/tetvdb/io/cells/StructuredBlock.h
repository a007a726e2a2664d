// SPDX-License-Identifier: Apache-2.0
//
// The cells of structured grids, which files do not list.
#pragma once

#include "tetvdb/mesh/CellMesh.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace tetvdb {

/// Points of a structured grid along i, j and k; i varies fastest.
using BlockSize = std::array<std::size_t, 3>;

/// The number of points. Throws Error(Invalid) at `where` if there are more than `max`, and
/// Error(Limit) if they cannot be numbered with 32 bits.
std::size_t blockPoints(const BlockSize& size, std::size_t max, const std::string& where);

/// How many points of a rectilinear grid a file of `bytes` may declare: their coordinates take
/// little of it, the arrays of large grids more, compressed.
constexpr std::size_t maxRectilinearPoints(std::size_t bytes) {
  return (std::size_t(1) << 22) + 256 * bytes;
}

/// The points of a rectilinear grid by their coordinates along x, y and z, in a file of `bytes`.
/// Throws as blockPoints(), and Error(Invalid) for coordinates that are not finite.
std::vector<Vec3d> rectilinearPoints(const std::array<std::vector<double>, 3>& coordinates,
                                     std::size_t bytes, const std::string& where);

/// The number of cells: along an axis with a single point the grid has no extent.
std::size_t blockCells(const BlockSize& size);

/// Whether it has hexahedra.
bool isSolidBlock(const BlockSize& size);

/// Appends the cells of a grid whose first point is mesh.points[firstPoint], in the order of their
/// first points: hexahedra; quadrilaterals where one axis has a single point (with their nodes if
/// `faces`, as for ReadOptions::faces); otherwise lines or a vertex, which are only counted. `size`
/// has passed blockPoints(). Returns blockCells().
std::size_t appendBlock(CellMesh& mesh, const BlockSize& size, std::size_t firstPoint, bool faces);

} // namespace tetvdb
