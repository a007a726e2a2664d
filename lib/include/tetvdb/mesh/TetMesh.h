// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/Attribute.h"
#include "tetvdb/mesh/CurvedShape.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tetvdb {

/// Cells whose values at points are those of their shape functions, not of the tets that they are
/// cut into: quadratic ones, cut at their own nodes (mesh/CutQuadratic.h), and linear hexahedra,
/// wedges and pyramids.
struct CurvedCells {
  static constexpr std::uint32_t kLinear = 0xFFFFFFFFu;
  struct Cell {
    std::uint64_t first = 0; ///< of its points in `nodes`
    CurvedShape shape = CurvedShape::Tet10;
  };

  std::vector<std::uint32_t> nodes; ///< points, as many a cell as its shape has nodes
  std::vector<Cell> cells;
  /// Of every tet of the mesh the number of its cell; kLinear: it is none of them.
  std::vector<std::uint32_t> cellOfTet;
  std::vector<std::array<std::uint8_t, 4>>
      corners; ///< which places of its cell a tet's corners are

  bool empty() const { return cells.empty(); }
};

/// Tetrahedra in world space. Orientation is free: voxelizing reverses negative ones.
struct TetMesh {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> tets; ///< four point indices each, all below points.size()
  /// Solid cell of the input that each tet comes from; empty: tet i is cell i. Solid cells are
  /// numbered from 0 in file order, those of kinds that were skipped or filtered out included.
  std::vector<std::uint32_t> cellOfTet;
  CurvedCells curved;                ///< empty in meshes of linear tets
  std::size_t cellCount = 0;         ///< solid cells of the input
  std::vector<Attribute> attributes; ///< On::Points over `points`, On::Cells over solid cells
  std::vector<UnreadArray> unread;   ///< other arrays of the input, for messages
  std::vector<std::int32_t> regions; ///< of every solid cell; empty where the input has none
  std::map<std::int32_t, std::string> regionNames;

  std::size_t tetCount() const { return tets.size() / 4; }
  std::uint32_t cell(std::size_t tet) const {
    return cellOfTet.empty() ? static_cast<std::uint32_t>(tet) : cellOfTet[tet];
  }
};

} // namespace tetvdb
