// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/PvtuReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/formats/vtk/VtuMarkup.h"
#include "tetvdb/io/formats/vtk/VtuReader.h"
#include "tetvdb/io/source/PathWithin.h"

#include <iterator>
#include <set>
#include <string>
#include <utility>

namespace tetvdb {

namespace {

/// Calls `use` with each piece's source, in the file's order, while it returns true.
template <class UsePiece>
void forPieces(const Source& source, Progress& progress, UsePiece use) {
  const vtk::VtuMarkup markup(source);
  pugi::xml_node grid;
  for (const char* name : {"PUnstructuredGrid", "PStructuredGrid", "PRectilinearGrid"})
    if (!grid)
      grid = markup.root().child(name);
  if (!grid)
    throw Error(Status::Invalid, source.path,
                "has no <PUnstructuredGrid>, <PStructuredGrid> or <PRectilinearGrid>",
                "save the mesh as an unstructured grid");
  const auto pieces = grid.children("Piece");
  const auto count = std::distance(pieces.begin(), pieces.end());
  if (count == 0)
    throw Error(Status::Invalid, source.path, "names no pieces", "export it again");

  std::set<std::string> paths;
  std::size_t done = 0;
  for (const pugi::xml_node piece : pieces) {
    const std::string name = piece.attribute("Source").value();
    if (name.empty())
      throw Error(Status::Invalid, source.path, "piece " + std::to_string(done) + " has no Source",
                  "export it again");
    const std::string path = pathWithin(source.path, name);
    if (!paths.insert(path).second)
      throw Error(Status::Invalid, source.path, "names the piece '" + name + "' twice",
                  "export it again");
    const MappedFile file(path);
    if (!use(file.source()))
      return;
    progress.update(static_cast<double>(++done) / static_cast<double>(count));
  }
}

} // namespace

CellMesh readPvtu(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress) {
  CellMesh whole;
  forPieces(source, progress, [&](const Source& piece) {
    vtk::appendPiece(whole, readVtu(piece, options, report, progress), report);
    return true;
  });
  return whole;
}

bool pvtuHasSolidCells(const Source& source, Report& report, Progress& progress) {
  bool found = false;
  forPieces(source, progress, [&](const Source& piece) {
    found = vtuHasSolidCells(piece, report, progress);
    return !found;
  });
  return found;
}

} // namespace tetvdb
