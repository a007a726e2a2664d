// SPDX-License-Identifier: Apache-2.0
//
// An unstructured mesh as a file holds it, before its solid cells become tetrahedra. Readers make
// it; splitCells() (mesh/SplitCells.h) turns it into a TetMesh.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/Attribute.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tetvdb {

/// Node order within a cell is VTK's (vtkCellType.h), corners first, for every file format:
/// hexahedron 0-3 bottom, 4-7 top, both counter-clockwise seen from above; voxel in x-y-z lattice
/// order; wedge 0-2, 3-5; pyramid 0-3 base, 4 apex. Quadratic cells may keep all nodes
/// (curvedShape()): the corners, then the others as mesh/CurvedShape.h says.
enum class CellType : std::uint8_t {
  Tetra,
  Voxel, ///< VTK's axis-aligned hexahedron
  Hexahedron,
  Wedge,
  Pyramid,
  Polyhedron,      ///< nodes: face count, then for each face its node count and its nodes
  PentagonalPrism, ///< nodes 0-4, 5-9
  HexagonalPrism,  ///< nodes 0-5, 6-11
  OtherSolid,      ///< three-dimensional, but of a kind that is not read: skipped, leaves a hole
  Flat             ///< points, lines, triangles, polygons: no volume
};

/// Consecutive cells of one kind.
struct CellRun {
  CellType type = CellType::Tetra;
  std::uint32_t nodesPerCell = 4; ///< numbers stored per cell in CellMesh::nodes
  std::size_t count = 0;
  std::string fileType;   ///< the file's own name of the kind, for the report: "tetra10"
  bool quadratic = false; ///< nodes beyond the corners exist in the file (kept in `nodes` or not)
};

/// Cells in file order. Cell i's nodes follow those of cell i - 1 in `nodes`; indices are checked
/// by the reader to be below points.size(). Flat runs may store no nodes (nodesPerCell 0).
struct CellMesh {
  std::vector<Vec3d> points; ///< world space, all finite
  std::vector<std::uint32_t> nodes;
  std::vector<CellRun> runs;
  std::vector<Attribute> attributes; ///< those On::Cells have one element for every cell of `runs`
  std::vector<UnreadArray> unread;   ///< other arrays of the file, for messages
  /// Region (material) number of every cell of `runs`; empty where the file has none.
  std::vector<std::int32_t> regions;
  std::map<std::int32_t, std::string> regionNames;
  std::vector<double> times; ///< of all steps of the file; empty where it has none

  std::size_t cellCount() const {
    std::size_t n = 0;
    for (const CellRun& run : runs)
      n += run.count;
    return n;
  }
};

} // namespace tetvdb
