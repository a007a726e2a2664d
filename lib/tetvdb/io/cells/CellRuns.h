// SPDX-License-Identifier: Apache-2.0
//
// Functions by which all readers build meshes.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/IdMap.h"
#include "tetvdb/mesh/CellMesh.h"
#include "tetvdb/mesh/CurvedShape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tetvdb {

/// A type of cell in a file format: its first `corners` nodes are the corners in VTK's order.
struct CellKind {
  const char* name; ///< the name in the format
  CellType type;
  std::uint32_t corners; ///< 0 for Flat and OtherSolid
  std::uint32_t nodes;   ///< nodes in the file
  /// Number of nodes that the reader keeps (mesh/CurvedShape.h); 0: the corners.
  std::uint32_t kept = 0;
  /// By kept node: its index in the file; null: the same.
  const std::uint8_t* order = nullptr;

  std::uint32_t stored() const { return kept != 0 ? kept : corners; }
  bool quadratic() const { return corners != 0 && nodes > corners; }
};

/// For CellKind::kept: all nodes of quadratic cells, 0 for others.
inline std::uint32_t keptNodes(CellType type, std::uint32_t nodes) {
  return curvedShape(type, nodes) ? nodes : 0;
}

/// Adds `count` cells of a type, stored() nodes each, to the last run or as a new one.
inline void appendCells(CellMesh& mesh, const CellKind& kind, std::size_t count = 1) {
  if (count == 0)
    return;
  if (mesh.runs.empty() || mesh.runs.back().fileType != kind.name)
    mesh.runs.push_back({kind.type, kind.stored(), 0, kind.name, kind.quadratic()});
  mesh.runs.back().count += count;
}

/// Permutes the last cell's nodes from the file's order to VTK's.
inline void orderLast(CellMesh& mesh, const CellKind& kind) {
  if (kind.order == nullptr)
    return;
  std::array<std::uint32_t, 32> file{};
  std::uint32_t* nodes = mesh.nodes.data() + mesh.nodes.size() - kind.kept;
  std::copy_n(nodes, kind.kept, file.begin());
  for (std::size_t i = 0; i < kind.kept; ++i)
    nodes[i] = file[kind.order[i]];
}

/// Throws Error(Limit) if points cannot be numbered with 32 bits.
inline void checkPointCount(std::uint64_t count, const std::string& path) {
  if (count >= IdMap::kNone)
    throw Error(Status::Limit, path, "more than 4294967294 points", "split it into several files");
}

inline bool isFinite(const Vec3d& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

} // namespace tetvdb
