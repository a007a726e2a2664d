// SPDX-License-Identifier: Apache-2.0
//
// VTK's cells (types, offsets, connectivity) into runs of a CellMesh, and meshes in pieces into
// one.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/CellMesh.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb::vtk {

/// What a VTK cell type is to us.
struct CellKind {
  CellType type = CellType::OtherSolid;
  std::uint8_t corners = 0; ///< nodes that we keep; 0: none
  std::uint8_t nodes = 0;   ///< nodes of each cell in a file; 0: any number from `corners` on
  const char* name = "";    ///< at most 15 characters, so that a run's std::string stays inline
};

/// The kind of VTK cell type `type`; types that VTK does not have are OtherSolid, "unknown".
const CellKind& cellKind(std::uint8_t type);

/// Cells as VTK's files hold them.
struct Cells {
  std::vector<std::uint8_t> types;
  std::vector<std::uint64_t> ends; ///< where each cell ends in `connectivity`
  std::vector<std::uint32_t> connectivity;
  /// Polyhedra: face count, then for each face its node count and nodes. Legacy files hold them in
  /// `connectivity` in place of the nodes (facesInConnectivity), XML files in `faces`.
  bool facesInConnectivity = false;
  std::vector<std::uint32_t> faces;
  std::vector<std::uint64_t> faceEnds; ///< where each cell ends in `faces`; beyond 2^62: has none
  std::string where;                   ///< for messages: "file:line" or "file at byte N"
};

/// Appends `cells` to `mesh`, whose points they refer to. Throws Error(Invalid) for offsets that do
/// not rise or do not fit, nodes out of range, node counts that do not fit the type. Kept are the
/// corners, of quadratic cells (mesh/CurvedShape.h) all nodes. A mesh of one linear type is taken
/// over without a copy.
/// With `faces` polygons keep their corners as ReadOptions::faces says.
void appendCells(Cells&& cells, CellMesh& mesh, Progress& progress, bool faces = false);

/// Appends `piece` to `whole`; points are not merged. Attributes that one of the two lacks, or has
/// with other components, are dropped with a warning. Throws Error(Limit) for 2^32 - 1 points.
void appendPiece(CellMesh& whole, CellMesh&& piece, Report& report);

} // namespace tetvdb::vtk
