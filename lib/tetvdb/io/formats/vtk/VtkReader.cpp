// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtkReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/cells/StructuredBlock.h"
#include "tetvdb/io/formats/vtk/HiddenCells.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/formats/vtk/VtkSections.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

using namespace vtk;

class VtkFile : VtkSections {
public:
  VtkFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : VtkSections(source, progress), source_(source), options_(options), report_(report),
        progress_(progress) {}

  CellMesh read() {
    readHeader();
    if (dataset_ == Dataset::Image)
      fail("holds a volume (STRUCTURED_POINTS), not a mesh", "");
    while (!text().atEnd()) {
      const std::string keyword = word();
      if (!readGeometry(keyword) && !readData(keyword))
        fail("unknown keyword '" + readable(keyword) + "'", kExport);
      source_.release();
      progress_.update(static_cast<double>(text().position()) /
                       static_cast<double>(source_.bytes.size()));
    }
    if (dataset_ == Dataset::Rectilinear)
      mesh_.points = rectilinearPoints(coordinates_, source_.bytes.size(), source_.path);
    else if (!seenPoints_)
      fail("the file ends without POINTS", kCut);
    if (dataset_ == Dataset::Poly)
      return finishPolygons();
    if (isStructured(dataset_))
      return finishBlock();
    if (!seenCells_ || !seenTypes_)
      fail(seenCells_ ? "the file ends without CELL_TYPES" : "the file ends without CELLS", kCut);
    checkElements(Attribute::On::Points, mesh_.points.size());
    checkElements(Attribute::On::Cells, cells_.types.size());
    if (cells_.ends.size() != cells_.types.size())
      fail(std::to_string(cells_.ends.size()) + " cells, but " +
               std::to_string(cells_.types.size()) + " cell types",
           kExport);
    cells_.facesInConnectivity = true;
    appendCells(std::move(cells_), mesh_, progress_, options_.faces);
    return std::move(mesh_);
  }

private:
  // --- points and cells ---

  bool readGeometry(const std::string& keyword) {
    if (dataset_ == Dataset::Poly && readPolygons(keyword))
      return true;
    if (isStructured(dataset_) && readStructure(keyword))
      return true;
    if (keyword == "points")
      readPoints();
    else if (keyword == "cells")
      readCells();
    else if (keyword == "cell_types")
      readTypes();
    else if (keyword == "metadata")
      skipMetadata();
    else
      return false;
    return true;
  }

  void once(bool& seen, const char* what) {
    if (seen)
      fail(std::string("a second section ") + what, kExport);
    seen = true;
  }

  void readPoints() {
    once(seenPoints_, "POINTS");
    const std::size_t n = count();
    const Number as = type();
    endLine();
    mesh_.points = toPoints(numbers(as, product(n, 3)));
    if (n >= 0xffffffffu)
      throw Error(Status::Limit, source_.path, "more than 2^32 - 2 points", "split the mesh");
  }

  // Sections of polygonal data in VTK's order, and the types of their cells.
  bool readPolygons(const std::string& keyword) {
    static constexpr std::pair<std::string_view, std::uint8_t> kinds[] = {
        {"vertices", 2}, {"lines", 4}, {"polygons", 7}, {"triangle_strips", 6}};
    for (std::size_t i = 0; i < std::size(kinds); ++i) {
      if (keyword != kinds[i].first)
        continue;
      if (!polygons_[i].ends.empty())
        fail("a second section " + keyword, kExport);
      readConnectivity();
      cells_.types.assign(cells_.ends.size(), kinds[i].second);
      polygons_[i] = std::exchange(cells_, {});
      return true;
    }
    return false;
  }
  CellMesh finishPolygons() {
    std::size_t cells = 0;
    for (const Cells& some : polygons_)
      cells += some.ends.size();
    checkElements(Attribute::On::Points, mesh_.points.size());
    checkElements(Attribute::On::Cells, cells);
    for (Cells& some : polygons_)
      if (!some.ends.empty())
        appendCells(std::move(some), mesh_, progress_, options_.faces);
    return std::move(mesh_);
  }

  // Structured grids have dimensions in place of cells, rectilinear ones coordinates in place of
  // points.
  bool readStructure(const std::string& keyword) {
    if (keyword == "dimensions") {
      once(seenCells_, "DIMENSIONS");
      for (std::size_t& points : size_)
        points = count();
      return true;
    }
    const std::size_t axis = keyword.empty() ? 0 : std::size_t(keyword[0] - 'x');
    if (dataset_ != Dataset::Rectilinear || keyword.substr(1) != "_coordinates" || axis > 2)
      return false;
    if (!coordinates_[axis].empty())
      fail("a second section " + keyword, kExport);
    const std::size_t n = count();
    const Number as = type();
    endLine();
    coordinates_[axis] = toDoubles(numbers(as, n));
    return true;
  }
  CellMesh finishBlock() {
    if (!seenCells_)
      fail("the file ends without DIMENSIONS", kCut);
    for (std::size_t k = 0; k < 3 && dataset_ == Dataset::Rectilinear; ++k)
      if (coordinates_[k].size() != size_[k])
        fail("DIMENSIONS declares " + std::to_string(size_[k]) + " points along " + "xyz"[k] +
                 ", but there are " + std::to_string(coordinates_[k].size()) + " coordinates",
             kExport);
    const std::size_t points = blockPoints(size_, mesh_.points.size(), source_.path);
    if (points != mesh_.points.size())
      fail("DIMENSIONS declares " + std::to_string(points) + " points, but there are " +
               std::to_string(mesh_.points.size()),
           kExport);
    checkElements(Attribute::On::Points, mesh_.points.size());
    checkElements(Attribute::On::Cells, appendBlock(mesh_, size_, 0, options_.faces));
    removeHiddenCells(mesh_);
    return std::move(mesh_);
  }

  void readCells() {
    once(seenCells_, "CELLS");
    readConnectivity();
  }
  void readConnectivity() {
    const std::size_t n = count();
    const std::size_t size = count();
    endLine();
    if (next("offsets"))
      readOffsets(n, size);
    else
      readStream(n, size);
  }

  // Some writers do not include the node counts in the declared size: a text defines its own end.
  void readStream(std::size_t n, std::size_t size) {
    const Array array = numbers(isBinary() ? Number::Int32 : Number::Int64, size);
    std::vector<std::uint32_t> stream = toIndices(array);
    if (!isBinary()) {
      for (std::int64_t more = 0; text().tryInteger(more);)
        stream.push_back(more >= 0 && more < 0xffffffff ? static_cast<std::uint32_t>(more)
                                                        : 0xffffffffu);
      if (stream.size() > size)
        report_.warn("cells-size", "CELLS declares " + std::to_string(size) + " numbers, but has " +
                                       std::to_string(stream.size()));
    }
    unpack(n, std::move(stream), array.where);
  }

  // From version 5: an array of n offsets, the first of which is 0, and one of nodes.
  void readOffsets(std::size_t n, std::size_t size) {
    const Number offsetType = type();
    endLine();
    const Array offsets = numbers(offsetType, n);
    cells_.ends = toOffsets(offsets);
    if (!next("connectivity"))
      fail("CONNECTIVITY is missing", kCut);
    const Number nodeType = type();
    endLine();
    const Array nodes = numbers(nodeType, size);
    cells_.where = nodes.where;
    cells_.connectivity = toIndices(nodes);
    if (cells_.ends.empty() ? size != 0 : cells_.ends.front() != 0 || cells_.ends.back() != size)
      throw Error(Status::Invalid, offsets.where,
                  "OFFSETS do not go from 0 to the length of CONNECTIVITY", kExport);
    if (!cells_.ends.empty())
      cells_.ends.erase(cells_.ends.begin());
  }

  // Up to version 4: for each cell its node count and its nodes. Packed in place.
  void unpack(std::size_t n, std::vector<std::uint32_t> stream, const std::string& start) {
    cells_.where = start;
    if (n > stream.size())
      throw Error(Status::Invalid, start,
                  std::to_string(n) + " cells do not fit into " + std::to_string(stream.size()) +
                      " numbers",
                  kCut);
    cells_.ends.resize(n);
    std::size_t from = 0, to = 0;
    for (std::size_t cell = 0; cell < n; ++cell) {
      const std::size_t left = stream.size() - from;
      if (left == 0 || stream[from] >= left)
        throw Error(Status::Invalid, start,
                    "cell " + std::to_string(cell) + " ends beyond the section CELLS, which has " +
                        std::to_string(stream.size()) + " numbers",
                    kCut);
      const std::uint32_t nodes = stream[from++];
      for (std::uint32_t i = 0; i < nodes; ++i)
        stream[to++] = stream[from++];
      cells_.ends[cell] = to;
    }
    if (from != stream.size())
      throw Error(Status::Invalid, start,
                  "CELLS declares " + std::to_string(stream.size()) + " numbers, but its " +
                      std::to_string(n) + " cells have " + std::to_string(from),
                  kExport);
    stream.resize(to);
    cells_.connectivity = std::move(stream);
  }

  void readTypes() {
    once(seenTypes_, "CELL_TYPES");
    const std::size_t n = count();
    endLine();
    if (isTypeOfAll(n)) {
      report_.warn("cell-types",
                   "CELL_TYPES names one type in place of a list; it is taken for the "
                   "type of all cells");
      cells_.types.assign(cells_.ends.size(), static_cast<std::uint8_t>(n));
      return;
    }
    cells_.types = toTypes(numbers(Number::Int32, n));
  }

  // Bullet's files end with "CELL_TYPES 10": the type of all cells. A file truncated there would
  // have as many types as cells.
  bool isTypeOfAll(std::size_t n) {
    if (isBinary() || !seenCells_ || n > 255 || n == cells_.ends.size() || !text().atEnd())
      return false;
    const CellProperties& kind = cellKind(static_cast<std::uint8_t>(n));
    return kind.nodes != 0 && cells_.connectivity.size() == kind.nodes * cells_.ends.size();
  }

  // --- arrays ---

  void readArray(std::string label, std::size_t width, std::size_t tuples, Number as) override {
    const std::size_t n = product(width, tuples);
    const bool isAsked = !(options_.faces && on_ == Attribute::On::Cells) &&
                         (options_.wants(label) || label == options_.regionArray ||
                          (on_ == Attribute::On::Cells && isInteger(as)));
    const bool wanted = inData_ && width > 0 && width <= 1u << 16 && tuples == elements_ &&
                        (isAsked || (isStructured(dataset_) && label == kGhostArray));
    if (!wanted) {
      if (inData_ && tuples != elements_)
        report_.warn("array-of-other-length",
                     "the array '" + label + "' is left out: it has " + std::to_string(tuples) +
                         " elements in place of " + std::to_string(elements_));
      else if (inData_ && options_.attributes && width > 0 && width <= 1u << 16)
        mesh_.unread.push_back({std::move(label), on_, static_cast<std::uint32_t>(width)});
      return skipNumbers(as, n);
    }
    const Array array = numbers(as, n);
    mesh_.attributes.push_back(
        toAttribute(std::move(label), on_, static_cast<std::uint32_t>(width), array));
  }

  void checkElements(Attribute::On on, std::size_t elements) const {
    const auto& declared = on == Attribute::On::Points ? pointElements_ : cellElements_;
    if (declared && *declared != elements)
      throw Error(Status::Invalid, source_.path,
                  std::string(on == Attribute::On::Points ? "POINT_DATA" : "CELL_DATA") + " has " +
                      std::to_string(*declared) + " elements, the mesh " + std::to_string(elements),
                  kExport);
  }

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  bool seenPoints_ = false, seenCells_ = false, seenTypes_ = false;
  CellMesh mesh_;
  Cells cells_;
  std::array<Cells, 4> polygons_;                  ///< of polygonal data
  BlockSize size_{};                               ///< of structured grids
  std::array<std::vector<double>, 3> coordinates_; ///< of rectilinear ones
};

} // namespace

CellMesh readVtk(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress) {
  return VtkFile(source, options, report, progress).read();
}

bool vtkHasSolidCells(const Source& source, Report& report, Progress& progress) {
  const auto isSolid = [](std::int64_t type) {
    return type >= 0 && type < 256 &&
           cellKind(static_cast<std::uint8_t>(type)).type != CellType::Flat;
  };
  NumberParser in(source);
  in.line();
  in.line();
  const bool binary = keywordOf(in.word()) == "binary";
  in.word();
  const std::string dataset = keywordOf(in.word());
  if ((dataset == "structured_grid" || dataset == "rectilinear_grid") &&
      keywordOf(in.peekWord()) == "dimensions") {
    in.word();
    return in.integer() > 1 && in.integer() > 1 && in.integer() > 1;
  }
  // The types follow the cells; arrays may follow.
  const std::size_t at = source.bytes.rfind("CELL_TYPES");
  if (at == source.bytes.npos) {
    ReadOptions options;
    options.attributes = false;
    options.faces = true;
    return hasSolidCells(readVtk(source, options, report, progress));
  }
  in.seek(at + std::string_view("CELL_TYPES").size());
  std::int64_t count = 0, type = 0;
  if (!in.tryInteger(count) || count < 0)
    throw Error(Status::Invalid, in.where(), "CELL_TYPES has no number of cells", kExport);
  in.line();
  if (binary) {
    ByteReader bytes(source);
    bytes.skip(in.position());
    bytes.setSwap(true);
    const std::size_t n = bytes.checkCount(count, 4, "types of cells");
    for (std::size_t i = 0; i < n; ++i)
      if (isSolid(bytes.get<std::int32_t>()))
        return true;
    return false;
  }
  for (std::int64_t i = 0; i < count; ++i)
    if (isSolid(type = in.integer()))
      return true;
  return false;
}

} // namespace tetvdb
