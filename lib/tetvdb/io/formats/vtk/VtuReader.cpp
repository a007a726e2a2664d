// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtuReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/formats/vtk/VtkArray.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/formats/vtk/VtuData.h"
#include "tetvdb/io/formats/vtk/VtuMarkup.h"
#include "tetvdb/io/source/Advice.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

using namespace vtk;

constexpr std::uint32_t kBigEndianMark = 0x01020304u;

class VtuFile {
public:
  VtuFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : source_(source), options_(options), report_(report), progress_(progress), markup_(source) {}

  CellMesh read() {
    readEncoding();
    CellMesh whole;
    const auto pieces =
        markup_.root().child(isPoly_ ? "PolyData" : "UnstructuredGrid").children("Piece");
    const auto count = std::distance(pieces.begin(), pieces.end());
    if (count == 0)
      fail(source_.path, "the file has no <Piece>", "export it again");
    std::size_t done = 0;
    for (const pugi::xml_node piece : pieces) {
      piece_ = done++;
      CellMesh mesh = readPiece(piece);
      if (count == 1)
        return mesh;
      appendPiece(whole, std::move(mesh), report_);
      progress_.update(static_cast<double>(done) / static_cast<double>(count));
    }
    return whole;
  }

  /// By the cells' types only.
  bool hasSolidCells() {
    readEncoding();
    for (const pugi::xml_node piece : markup_.root().child("UnstructuredGrid").children("Piece"))
      if (const std::size_t cells = count(piece, "NumberOfCells"); cells > 0)
        for (const std::uint8_t type : toTypes(array(needed(piece.child("Cells"), "types"), cells)))
          if (cellKind(type).type != CellType::Flat)
            return true;
    return false;
  }

private:
  [[noreturn]] void fail(const std::string& where, const std::string& what,
                         const char* advice = kExport) const {
    throw Error(Status::Invalid, where, what, advice);
  }
  /// "file", with the piece if there are several.
  std::string where() const {
    return piece_ == 0 ? source_.path : source_.path + ", piece " + std::to_string(piece_);
  }

  void readEncoding() {
    const pugi::xml_node root = markup_.root();
    const std::string_view type = root.attribute("type").value();
    isPoly_ = type == "PolyData";
    if (type != "UnstructuredGrid" && !isPoly_)
      fail(source_.path,
           "holds " + std::string(type.empty() ? "no type" : type) +
               ", not an UnstructuredGrid or PolyData",
           "save the mesh as an unstructured grid");
    const std::string_view compressor = root.attribute("compressor").value();
    if (compressor == "vtkZLibDataCompressor")
      encoding_.compressor = Compressor::Zlib;
    else if (compressor == "vtkLZ4DataCompressor")
      encoding_.compressor = Compressor::Lz4;
    else if (compressor == "vtkLZMADataCompressor")
      encoding_.compressor = Compressor::Lzma;
    else if (!compressor.empty())
      fail(source_.path, "is compressed by '" + std::string(compressor) + "', which is not known",
           "save it with zlib, lz4, lzma or without compression");
    const std::string_view header = root.attribute("header_type").value();
    if (!header.empty() && header != "UInt32" && header != "UInt64")
      fail(source_.path, "header_type is neither UInt32 nor UInt64");
    encoding_.wideHeader = header == "UInt64";
    const std::string_view order = root.attribute("byte_order").value();
    if (!order.empty() && order != "LittleEndian" && order != "BigEndian")
      fail(source_.path, "byte_order is neither LittleEndian nor BigEndian");
    encoding_.swap = order == "BigEndian"; // of little-endian machines
  }

  std::size_t count(pugi::xml_node node, const char* name) const {
    const std::string_view text = node.attribute(name).value();
    NumberParser in(text, where());
    std::int64_t n = -1;
    if (!in.tryInteger(n) || n < 0 || !in.atEnd())
      fail(where(), std::string(name) + " is not a count");
    return static_cast<std::size_t>(n);
  }

  std::uint32_t components(pugi::xml_node node, std::uint32_t missing) const {
    if (!node.attribute("NumberOfComponents"))
      return missing;
    const std::size_t n = count(node, "NumberOfComponents");
    if (n > 1u << 16)
      fail(where(), "an array has " + std::to_string(n) + " components");
    return std::max<std::uint32_t>(1, static_cast<std::uint32_t>(n)); // some writers put 0
  }

  std::size_t product(std::size_t a, std::size_t b) const {
    if (b != 0 && a > std::numeric_limits<std::size_t>::max() / 16 / b)
      fail(where(), "more numbers are declared than the file holds", kCut);
    return a * b;
  }

  /// The `numbers` numbers of a <DataArray>. Previous ones have already been used.
  Array array(pugi::xml_node node, std::size_t numbers) {
    source_.release();
    const std::string name = node.attribute("Name").value();
    const std::string_view typeName = node.attribute("type").value();
    const auto type = xmlNumber(typeName);
    if (!type)
      fail(where(),
           "the array '" + name + "' has the unknown type '" + std::string(typeName) + "'");
    std::string_view format = node.attribute("format").value();
    if (format.empty())
      format = node.attribute("Format").value();

    Excerpt from;
    if (format == "appended") {
      const std::size_t offset = count(node, "offset");
      from = markup_.appended();
      if (offset > from.bytes.size() || (numbers > 0 && offset == from.bytes.size()))
        fail(where(), "the array '" + name + "' begins beyond the appended data", kCut);
      from.begin += offset;
      from.bytes.remove_prefix(offset);
    } else {
      from = markup_.text(node);
      if (format == "ascii" || format.empty())
        return textArray(from, *type, numbers, name);
      if (format != "binary")
        fail(where(),
             "the array '" + name + "' has the unknown format '" + std::string(format) + "'");
    }
    const bool base64 = format != "appended" || !markup_.appendedIsRaw();
    const std::uint64_t min = bytesFor(*type, numbers);
    Decoded decoded = decode(from, base64, encoding_, min, source_.path, progress_);
    if (decoded.size > min)
      warnExtra(name);
    Array out;
    out.type = *type;
    out.swap = encoding_.swap;
    out.data = decoded.data;
    out.count = numbers;
    out.owned = std::move(decoded.owned);
    out.where = source_.path + " at byte " + std::to_string(from.begin);
    return out;
  }

  Array textArray(const Excerpt& from, Number type, std::size_t numbers, const std::string& name) {
    NumberParser in(source_.bytes.substr(0, from.begin + from.bytes.size()), source_.path, 0,
                    from.begin);
    Array out = parseText(in, type, numbers, progress_);
    if (!in.atEnd())
      warnExtra(name);
    in.seek(from.begin);
    out.where = in.where();
    return out;
  }

  void warnExtra(const std::string& name) {
    report_.warn("array-too-long",
                 "the array '" + name + "' has more numbers than the mesh has places for them");
  }

  pugi::xml_node named(pugi::xml_node cells, const char* name) const {
    return cells.find_child_by_attribute("DataArray", "Name", name);
  }
  pugi::xml_node needed(pugi::xml_node cells, const char* name) const {
    const pugi::xml_node node = named(cells, name);
    if (!node)
      fail(where(),
           "<" + std::string(isPoly_ ? "Polys" : "Cells") + "> has no array '" + name + "'");
    return node;
  }
  /// An array of offsets, which ends with the length of another array.
  std::vector<std::uint64_t> offsets(pugi::xml_node node, std::size_t n) {
    return toOffsets(array(node, n));
  }

  CellMesh readPiece(pugi::xml_node piece) {
    const std::size_t points = count(piece, "NumberOfPoints");
    const std::size_t cells = isPoly_ ? polyCellCount(piece) : count(piece, "NumberOfCells");
    CellMesh mesh;
    if (points > 0) {
      const pugi::xml_node node = piece.child("Points").child("DataArray");
      if (!node)
        fail(where(), "<Points> has no array");
      if (components(node, 3) != 3)
        fail(where(), "points have " + std::to_string(components(node, 3)) + " coordinates, not 3");
      mesh.points = toPoints(array(node, product(points, 3)));
      if (points >= 0xffffffffu)
        throw Error(Status::Limit, source_.path, "more than 2^32 - 2 points", "split the mesh");
      progress_.update(0.2);
    }
    if (isPoly_)
      readPolyCells(piece, mesh);
    else if (cells > 0)
      readCells(piece.child("Cells"), cells, mesh);
    progress_.update(0.7);
    readAttributes(piece.child("PointData"), Attribute::On::Points, points, mesh);
    if (!options_.faces)
      readAttributes(piece.child("CellData"), Attribute::On::Cells, cells, mesh);
    source_.release();
    return mesh;
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
      if (!options_.attributes && name != options_.regionArray &&
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
      if (options_.attributes && !options_.wants(name) && !forRegions) {
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
  VtuMarkup markup_;
  Encoding encoding_;
  bool isPoly_ = false;
  std::size_t piece_ = 0;
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
