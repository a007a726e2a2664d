// SPDX-License-Identifier: Apache-2.0
//
// Converts VTK's cells (types, offsets, connectivity) to runs of a CellMesh, and merges meshes in
// pieces.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/CellMesh.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb::vtk {

/// Kinds of VTK's data sets; each stores its cells in another way. Images have none.
enum class Dataset { Unstructured, Poly, Structured, Rectilinear, Image };

/// Whether its cells are those of a block (io/cells/StructuredBlock.h).
constexpr bool isStructured(Dataset dataset) {
  return dataset == Dataset::Structured || dataset == Dataset::Rectilinear;
}

/// Properties of a VTK cell type.
struct CellProperties {
  CellType type = CellType::OtherSolid;
  std::uint8_t corners = 0; ///< nodes that are kept; 0: none
  std::uint8_t nodes = 0;   ///< nodes of each cell in a file; 0: any number from `corners` on
  const char* name = "";    ///< at most 15 characters, so that a run's std::string stays inline
};

/// The kind of VTK cell type `type`; types that VTK does not have are OtherSolid, "unknown".
const CellProperties& cellKind(std::uint8_t type);

/// Cells as stored in VTK's files.
struct Cells {
  std::vector<std::uint8_t> types;
  std::vector<std::uint64_t> ends; ///< the end of each cell in `connectivity`
  std::vector<std::uint32_t> connectivity;
  /// Polyhedra: face count, then for each face its node count and nodes. Legacy files store them in
  /// `connectivity` instead of the nodes (facesInConnectivity), XML files in `faces`.
  bool facesInConnectivity = false;
  std::vector<std::uint32_t> faces;
  std::vector<std::uint64_t> faceEnds; ///< the end of each cell in `faces`; beyond 2^62: none
  std::string where;                   ///< for messages: "file:line" or "file at byte N"
};

/// Appends `cells` to `mesh`, whose points they refer to. Throws Error(Invalid) for offsets that do
/// not ascend or exceed the range, nodes out of range, node counts that do not match the type.
/// Keeps the corners, and all nodes of quadratic cells (mesh/CurvedShape.h). A mesh of one linear
/// type is moved without a copy. With `faces`, polygons keep their corners as for
/// ReadOptions::faces.
void appendCells(Cells&& cells, CellMesh& mesh, Progress& progress, bool faces = false);

/// Appends `piece` to `whole`; points are not merged. Attributes that one of the two lacks, or has
/// with other components, are removed with a warning. Throws Error(Limit) for 2^32 - 1 points.
void appendPiece(CellMesh& whole, CellMesh&& piece, Report& report);

} // namespace tetvdb::vtk
