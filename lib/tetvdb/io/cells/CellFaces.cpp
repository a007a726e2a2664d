// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/cells/CellFaces.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/mesh/SplitCells.h"

#include <algorithm>
#include <utility>

namespace tetvdb {

bool hasSolidCells(const CellMesh& mesh) {
  return std::any_of(mesh.runs.begin(), mesh.runs.end(), [](const CellRun& run) {
    return run.count > 0 && run.type != CellType::Flat;
  });
}

bool hasPolygons(const CellMesh& mesh) {
  return std::any_of(mesh.runs.begin(), mesh.runs.end(), [](const CellRun& run) {
    return run.count > 0 && run.type == CellType::Flat && run.nodesPerCell >= 3;
  });
}

TriangleMesh trianglesOfFaces(CellMesh&& mesh, const std::string& path) {
  if (hasSolidCells(mesh))
    throw Error(Status::Invalid, path, "holds solid cells, not triangles alone",
                "take it as a mesh of solid cells");
  if (!hasPolygons(mesh))
    throw Error(Status::Invalid, path,
                "no solid cells and no faces; it holds " + describeCells(mesh),
                "points and lines have no inside; export the mesh with its cells or faces");
  TriangleMesh faces;
  faces.points = std::move(mesh.points);
  const std::uint32_t* cell = mesh.nodes.data();
  for (const CellRun& run : mesh.runs)
    for (std::size_t i = 0; i < run.count; ++i, cell += run.nodesPerCell) {
      faces.faceCount += run.nodesPerCell >= 3 ? 1 : 0;
      for (std::uint32_t k = 1; k + 1 < run.nodesPerCell; ++k)
        faces.triangles.insert(faces.triangles.end(), {cell[0], cell[k], cell[k + 1]});
    }
  return faces;
}

} // namespace tetvdb
