// SPDX-License-Identifier: Apache-2.0
//
// What every reader does to the mesh that it builds.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/IdMap.h"
#include "tetvdb/mesh/CellMesh.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tetvdb {

/// A kind of cell in some file format: its first `corners` nodes are the corners in VTK's order.
struct CellKind {
  const char* name; ///< in the file's own words
  CellType type;
  std::uint32_t corners; ///< nodes kept: 0 for Flat and OtherSolid
  std::uint32_t nodes;   ///< nodes in the file

  bool quadratic() const { return corners != 0 && nodes > corners; }
};

/// Adds `count` cells of a kind, of which the corners are kept, to the last run or as a new one.
inline void appendCells(CellMesh& mesh, const CellKind& kind, std::size_t count = 1) {
  if (count == 0)
    return;
  if (mesh.runs.empty() || mesh.runs.back().fileType != kind.name)
    mesh.runs.push_back({kind.type, kind.corners, 0, kind.name, kind.quadratic()});
  mesh.runs.back().count += count;
}

/// Throws Error(Limit) where points could not be numbered with 32 bits.
inline void checkPointCount(std::uint64_t count, const std::string& path) {
  if (count >= IdMap::kNone)
    throw Error(Status::Limit, path, "more than 4294967294 points", "split it into several files");
}

inline bool isFinite(const Vec3d& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

} // namespace tetvdb
