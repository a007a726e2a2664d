// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/PvtuReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/VtkCells.h"
#include "tetvdb/io/VtuMarkup.h"
#include "tetvdb/io/VtuReader.h"

#include <filesystem>
#include <iterator>
#include <utility>

namespace tetvdb {

CellMesh readPvtu(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress) {
  const vtk::VtuMarkup markup(source);
  const pugi::xml_node grid = markup.root().child("PUnstructuredGrid");
  if (!grid)
    throw Error(Status::Invalid, source.path, "has no <PUnstructuredGrid>",
                "save the mesh as an unstructured grid");
  const auto pieces = grid.children("Piece");
  const auto count = std::distance(pieces.begin(), pieces.end());
  if (count == 0)
    throw Error(Status::Invalid, source.path, "names no pieces", "export it again");

  const std::filesystem::path folder = std::filesystem::path(source.path).parent_path();
  CellMesh whole;
  std::size_t done = 0;
  for (const pugi::xml_node piece : pieces) {
    const std::string name = piece.attribute("Source").value();
    if (name.empty())
      throw Error(Status::Invalid, source.path, "piece " + std::to_string(done) + " has no Source",
                  "export it again");
    const std::string path = (folder / name).string();
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
      throw Error(Status::Invalid, source.path, "the piece '" + path + "' is missing",
                  "put the pieces beside the .pvtu, where their names say");
    const MappedFile file(path);
    vtk::appendPiece(whole, readVtu(file.source(), options, report, progress), report);
    progress.update(static_cast<double>(++done) / static_cast<double>(count));
  }
  return whole;
}

} // namespace tetvdb
