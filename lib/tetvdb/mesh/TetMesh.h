// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/Attribute.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tetvdb {

/// Ten-node tets, each cut into eight tets at its own nodes (mesh/CutTet10.h): values at points are
/// those of the cell's quadratic shape functions, not of the eight tets.
struct CurvedTets {
  static constexpr std::uint32_t kLinear = 0xFFFFFFFFu;

  std::vector<std::uint32_t> nodes; ///< ten points a cell: corners, mids of 01, 12, 02, 03, 13, 23
  /// Of every tet of the mesh the number of its cell in `nodes`; kLinear: it is none of them.
  std::vector<std::uint32_t> cellOfTet;
  std::vector<std::array<std::uint8_t, 4>> corners; ///< which of the ten a tet's corners are

  bool empty() const { return nodes.empty(); }
};

/// Tetrahedra in world space. Orientation is free: voxelizing turns negative ones round.
struct TetMesh {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> tets; ///< four point indices each, all below points.size()
  /// Solid cell of the input that each tet comes from; empty: tet i is cell i. Solid cells are
  /// numbered from 0 in file order, those of kinds that were skipped or filtered out included.
  std::vector<std::uint32_t> cellOfTet;
  CurvedTets curved;                 ///< empty in most meshes
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
