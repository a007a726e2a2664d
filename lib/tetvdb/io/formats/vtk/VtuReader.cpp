// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtuReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/StructuredBlock.h"
#include "tetvdb/io/formats/vtk/HiddenCells.h"
#include "tetvdb/io/formats/vtk/VtkArray.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/formats/vtk/VtuData.h"
#include "tetvdb/io/formats/vtk/VtuLayout.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

using namespace vtk;

class VtuFile : VtuLayout {
public:
  VtuFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : VtuLayout(source), source_(source), options_(options), report_(report),
        progress_(progress) {
    if (dataset() == Dataset::Image)
      fail(source.path, "holds ImageData, a volume, not a mesh");
  }

  CellMesh read() {
    CellMesh whole;
    const std::vector<pugi::xml_node> all = pieces();
    const std::size_t count = all.size();
    std::size_t done = 0;
    for (const pugi::xml_node piece : all) {
      beginPiece(done++);
      CellMesh mesh = readPiece(piece);
      if (count == 1)
        return mesh;
      appendPiece(whole, std::move(mesh), report_);
      progress_.update(static_cast<double>(done) / static_cast<double>(count));
    }
    return whole;
  }

  /// By the cells' types or the extents only.
  bool hasSolidCells() {
    if (isStructured(dataset())) {
      for (const pugi::xml_node piece : pieces())
        if (isSolidBlock(blockSize(piece)))
          return true;
      return false;
    }
    for (const pugi::xml_node piece : root().child("UnstructuredGrid").children("Piece"))
      if (const std::size_t cells = count(piece, "NumberOfCells"); cells > 0)
        for (const std::uint8_t type : toTypes(array(needed(piece.child("Cells"), "types"), cells)))
          if (cellKind(type).type != CellType::Flat)
            return true;
    return false;
  }

private:
  /// The `numbers` numbers of a <DataArray>. Previous ones have already been used.
  Array array(pugi::xml_node node, std::size_t numbers) {
    source_.release();
    bool isLonger = false;
    Array found = readArray(*this, source_, node, numbers, isLonger, progress_);
    if (isLonger)
      report_.warn("array-too-long", "the array '" + std::string(node.attribute("Name").value()) +
                                         "' has more numbers than the mesh has places for them");
    return found;
  }

  /// An array of offsets, which ends with the length of another array.
  std::vector<std::uint64_t> offsets(pugi::xml_node node, std::size_t n) {
    return toOffsets(array(node, n));
  }

  CellMesh readPiece(pugi::xml_node piece) {
    CellMesh mesh;
    std::size_t cells = 0;
    if (isStructured(dataset())) {
      cells = readBlock(piece, mesh);
    } else {
      readPoints(piece.child("Points"), count(piece, "NumberOfPoints"), mesh);
      progress_.update(0.2);
      cells = dataset() == Dataset::Poly ? polyCellCount(piece) : count(piece, "NumberOfCells");
      if (dataset() == Dataset::Poly)
        readPolyCells(piece, mesh);
      else if (cells > 0)
        readCells(piece.child("Cells"), cells, mesh);
    }
    progress_.update(0.7);
    readAttributes(piece.child("PointData"), Attribute::On::Points, mesh.points.size(), mesh);
    readAttributes(piece.child("CellData"), Attribute::On::Cells, cells, mesh);
    if (isStructured(dataset()))
      removeHiddenCells(mesh);
    source_.release();
    return mesh;
  }

  void readPoints(pugi::xml_node section, std::size_t points, CellMesh& mesh) {
    if (points == 0)
      return;
    const pugi::xml_node node = section.child("DataArray");
    if (!node)
      fail(where(), "<Points> has no array");
    if (components(node, 3) != 3)
      fail(where(), "points have " + std::to_string(components(node, 3)) + " coordinates, not 3");
    mesh.points = toPoints(array(node, product(points, 3)));
    if (points >= 0xffffffffu)
      throw Error(Status::Limit, source_.path, "more than 2^32 - 2 points", "split the mesh");
  }

  /// Points and cells of a structured or rectilinear grid; returns the number of cells.
  std::size_t readBlock(pugi::xml_node piece, CellMesh& mesh) {
    const BlockSize size = blockSize(piece);
    if (dataset() == Dataset::Structured) {
      readPoints(piece.child("Points"),
                 blockPoints(size, std::numeric_limits<std::uint32_t>::max(), where()), mesh);
    } else {
      std::array<std::vector<double>, 3> along;
      const pugi::xml_node section = piece.child("Coordinates");
      pugi::xml_node node = section.child("DataArray");
      for (std::size_t k = 0; k < 3; ++k, node = node.next_sibling("DataArray")) {
        if (!node)
          fail(where(), "<Coordinates> has no three arrays");
        along[k] = toDoubles(array(node, size[k]));
      }
      mesh.points = rectilinearPoints(along, source_.bytes.size(), where());
    }
    progress_.update(0.5);
    return appendBlock(mesh, size, 0, options_.faces);
  }

  void readCells(pugi::xml_node node, std::size_t n, CellMesh& mesh) {
    Cells cells;
    cells.types = toTypes(array(needed(node, "types"), n));
    cells.ends = offsets(needed(node, "offsets"), n);
    Array connectivity = array(needed(node, "connectivity"), product(cells.ends.back(), 1));
    cells.where = connectivity.where;
    cells.connectivity = toIndices(connectivity);
    connectivity.owned.reset();
    progress_.update(0.5);
    if (std::find(cells.types.begin(), cells.types.end(), 42) != cells.types.end())
      readFaces(node, n, cells);
    appendCells(std::move(cells), mesh, progress_, options_.faces);
  }

  /// The kinds of cells of polygonal data in VTK's order, and the types of their cells.
  struct PolyKind {
    const char* section;
    const char* count;
    std::uint8_t type;
  };
  static constexpr PolyKind kPolyKinds[] = {{"Verts", "NumberOfVerts", 2},
                                            {"Lines", "NumberOfLines", 4},
                                            {"Polys", "NumberOfPolys", 7},
                                            {"Strips", "NumberOfStrips", 6}};
  std::size_t polyCellCount(pugi::xml_node piece) const {
    std::size_t n = 0;
    for (const PolyKind& kind : kPolyKinds)
      if (piece.attribute(kind.count))
        n += std::min(count(piece, kind.count), std::size_t(1) << 60);
    return n;
  }
  void readPolyCells(pugi::xml_node piece, CellMesh& mesh) {
    for (const PolyKind& kind : kPolyKinds) {
      const std::size_t n = piece.attribute(kind.count) ? count(piece, kind.count) : 0;
      if (n == 0)
        continue;
      const pugi::xml_node node = piece.child(kind.section);
      Cells cells;
      cells.ends = offsets(needed(node, "offsets"), n);
      cells.types.assign(n, kind.type);
      Array connectivity = array(needed(node, "connectivity"), product(cells.ends.back(), 1));
      cells.where = connectivity.where;
      cells.connectivity = toIndices(connectivity);
      appendCells(std::move(cells), mesh, progress_, options_.faces);
    }
  }

  // Before version 2.3 each polyhedron has a stream of faces; from then on faces are numbered.
  void readFaces(pugi::xml_node node, std::size_t n, Cells& cells) {
    if (!named(node, "polyhedron_to_faces")) {
      cells.faceEnds = offsets(needed(node, "faceoffsets"), n);
      std::uint64_t size = 0;
      for (const std::uint64_t end : cells.faceEnds)
        if (end < std::uint64_t(1) << 62)
          size = std::max(size, end);
      cells.faces = toIndices(array(needed(node, "faces"), product(size, 1)));
      return;
    }
    const auto cellEnds = offsets(needed(node, "polyhedron_offsets"), n);
    const auto faceOfCell =
        toIndices(array(needed(node, "polyhedron_to_faces"), product(cellEnds.back(), 1)));
    // The number of faces is not stored: it is one more than the highest used number.
    std::size_t faces = 0;
    for (const std::uint32_t face : faceOfCell)
      faces = std::max(faces, std::size_t(face) + 1);
    if (faces == 0)
      return;
    const auto faceEnds = offsets(needed(node, "face_offsets"), faces);
    const auto nodes =
        toIndices(array(needed(node, "face_connectivity"), product(faceEnds.back(), 1)));
    // A face belongs to at most two cells; far more would be an attempt to exhaust the memory.
    const std::size_t max = 8 * (nodes.size() + faceOfCell.size() + n);
    cells.faceEnds.resize(n);
    for (std::size_t cell = 0; cell < n; ++cell) {
      const std::uint64_t first = cell == 0 ? 0 : cellEnds[cell - 1], last = cellEnds[cell];
      if (first > last || last > faceOfCell.size())
        fail(cells.where, "polyhedron_offsets do not rise");
      if (first < last)
        cells.faces.push_back(static_cast<std::uint32_t>(last - first));
      for (std::uint64_t i = first; i < last; ++i) {
        const std::uint32_t face = faceOfCell[i];
        const std::uint64_t from = face == 0 ? 0 : faceEnds[face - 1], to = faceEnds[face];
        if (from > to || to > nodes.size() || cells.faces.size() + (to - from) > max)
          fail(cells.where, "face_offsets do not fit the faces of cell " + std::to_string(cell));
        cells.faces.push_back(static_cast<std::uint32_t>(to - from));
        cells.faces.insert(cells.faces.end(), nodes.data() + from, nodes.data() + to);
      }
      cells.faceEnds[cell] = cells.faces.size();
    }
  }

  void readAttributes(pugi::xml_node section, Attribute::On on, std::size_t elements,
                      CellMesh& mesh) {
    for (const pugi::xml_node node : section.children("DataArray")) {
      const auto type = xmlNumber(node.attribute("type").value());
      std::string name = node.attribute("Name").value();
      if (!type)
        continue; // strings
      const bool isGhost = isStructured(dataset()) && name == kGhostArray;
      if (!isGhost && options_.faces && on == Attribute::On::Cells)
        continue;
      if (!isGhost && !options_.attributes && name != options_.regionArray &&
          (on == Attribute::On::Points || !isInteger(*type)))
        continue;
      if (name.empty())
        name = "unnamed";
      const bool known =
          std::any_of(mesh.attributes.begin(), mesh.attributes.end(),
                      [&](const Attribute& a) { return a.on == on && a.name == name; });
      if (known) // time steps of one array
        continue;
      const std::uint32_t width = components(node, 1);
      const bool forRegions =
          on == Attribute::On::Cells && (isInteger(*type) || name == options_.regionArray);
      if (!isGhost && options_.attributes && !options_.wants(name) && !forRegions) {
        mesh.unread.push_back({std::move(name), on, width});
        continue;
      }
      mesh.attributes.push_back(
          toAttribute(std::move(name), on, width, array(node, product(elements, width))));
      progress_.update(0.9);
    }
  }

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
};

} // namespace

CellMesh readVtu(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress) {
  return VtuFile(source, options, report, progress).read();
}

bool vtuHasSolidCells(const Source& source, Report& report, Progress& progress) {
  const ReadOptions options;
  return VtuFile(source, options, report, progress).hasSolidCells();
}

} // namespace tetvdb
