// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/SpoolCells.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/formats/xdmf/Hdf5Arrays.h"
#include "tetvdb/io/formats/xdmf/XdmfGrids.h"
#include "tetvdb/io/formats/xdmf/XdmfMarkup.h"
#include "tetvdb/io/formats/xdmf/XdmfNumbers.h"
#include "tetvdb/io/formats/xdmf/XdmfReader.h"
#include "tetvdb/io/formats/xdmf/XdmfShapes.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/PathWithin.h"
#include "tetvdb/io/text/NumberParser.h"
#include "tetvdb/mesh/SpooledMesh.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <variant>

namespace tetvdb {
namespace {

// Rows of a dataset at a time.
constexpr std::uint64_t kRows = std::uint64_t(1) << 20;

// A dataset as rows of equal length.
struct Rows {
  Hdf5Dataset dataset;
  std::vector<std::uint64_t> shape;
  std::uint64_t numbers = 0; ///< as the XML declares, or as the dataset has
};

class XdmfSpooler {
public:
  XdmfSpooler(const Source& source, const ReadOptions& options, SpooledMesh& mesh, Report& report,
              Progress& progress)
      : source_(source), options_(options), mesh_(mesh), report_(report), progress_(progress),
        markup_(source), grids_(markup_), isSolid_(mesh.folder()) {}

  void read() {
    findGrids();
    const pugi::xml_node grid = pieces_.front();
    readPoints(markup_.child(grid, "Geometry"));
    progress_.update(0.3);
    readCells(markup_.child(grid, "Topology"));
    progress_.update(0.7);
    for (const pugi::xml_node piece : pieces_)
      for (const pugi::xml_node attribute : markup_.children(piece, "Attribute"))
        readAttribute(attribute);
  }

private:
  [[noreturn]] void fail(pugi::xml_node node, const std::string& what,
                         const char* advice = kExport) const {
    throw Error(Status::Invalid, markup_.where(node), what, advice);
  }
  static constexpr const char* kWhole = "write it as one mesh of tets first, by `write_mesh`";

  // The grids of one step; all have the first one's mesh.
  void findGrids() {
    const pugi::xml_node temporal = grids_.temporal(markup_.domain());
    const XdmfGrids::Step step = grids_.step(temporal, options_.timeStep);
    if (step.count > 1 && options_.timeStep < 0)
      report_.warn("last-step", source_.path + ": has " + std::to_string(step.count) +
                                    " time steps; the last one is taken");
    for (const pugi::xml_node grid : grids_.children(markup_.domain()))
      if (!temporal || grids_.temporal(grid))
        grids_.uniform(grid, step.index, pieces_);
    if (pieces_.empty())
      throw Error(Status::Invalid, source_.path, "has no grid with a topology and a geometry",
                  "export it again");
    for (const pugi::xml_node piece : pieces_)
      for (const char* part : {"Topology", "Geometry"}) {
        if (!markup_.child(piece, part))
          fail(piece, std::string("has no <") + part + ">", "export it again");
        if (markup_.child(piece, part) != markup_.child(pieces_.front(), part))
          fail(piece, "is another mesh than the first; only one can be prepared", kWhole);
      }
  }

  // The item of a topology, geometry or attribute, whose numbers make rows of `width`; 0: any.
  Rows open(pugi::xml_node parent) const {
    const pugi::xml_node child = markup_.child(parent, "DataItem");
    if (!child)
      fail(parent, "has no <DataItem>", "export it again");
    const pugi::xml_node item = markup_.resolved(child);
    std::string_view kind = item.attribute("ItemType").value();
    if (kind.empty())
      kind = item.attribute("Type").value();
    const std::string_view format = item.attribute("Format").value();
    const bool isHdf =
        sameWord(format, "HDF") || sameWord(format, "HDF5") || sameWord(format, "H5");
    if (!isHdf || (!kind.empty() && !sameWord(kind, "Uniform")))
      fail(item, "does not lie in an HDF5 file as it is; only such numbers can be prepared",
           kWhole);
    const std::string text(trimmedText(item));
    const std::size_t colon = datasetColon(text);
    if (colon == 0 || colon == std::string::npos || colon + 1 == text.size())
      fail(item, "'" + text.substr(0, 80) + "' names no dataset, as file.h5:/path does");
    Rows rows;
    rows.dataset.file = pathWithin(source_.path, text.substr(0, colon));
    rows.dataset.path = text.substr(colon + 1);
    if (rows.dataset.path.front() != '/')
      rows.dataset.path.insert(rows.dataset.path.begin(), '/');
    rows.shape = hdf5Shape(rows.dataset, source_.path, report_, progress_);
    if (rows.shape.empty() || rows.shape.size() > 2)
      fail(item, "a dataset of " + std::to_string(rows.shape.size()) + " dimensions");
    rows.numbers = product(item, rows.shape);
    if (std::string_view(item.attribute("Dimensions").value()).empty())
      return rows;
    std::vector<std::uint64_t> declared;
    NumberParser in(item.attribute("Dimensions").value(), markup_.where(item));
    while (!in.atEnd() && declared.size() < 8)
      declared.push_back(static_cast<std::uint64_t>(std::max<std::int64_t>(in.integer(), 0)));
    const std::uint64_t wanted = product(item, declared);
    if (wanted > rows.numbers)
      fail(item,
           "its dataset has " + std::to_string(rows.numbers) + " numbers in place of " +
               std::to_string(wanted),
           kCut);
    rows.numbers = wanted;
    return rows;
  }

  std::uint64_t product(pugi::xml_node item, const std::vector<std::uint64_t>& factors) const {
    std::uint64_t all = 1;
    for (const std::uint64_t factor : factors) {
      if (factor != 0 && all > (std::uint64_t(1) << 50) / factor)
        fail(item, "its dimensions are too large");
      all *= factor;
    }
    return all;
  }

  // Calls take(values, first row) for rows of `width` numbers, some at a time.
  template <typename Take>
  void eachRows(pugi::xml_node node, const Rows& rows, std::uint64_t width, const Take& take) {
    if (width == 0 || rows.numbers % width != 0 ||
        (rows.shape.size() == 2 && rows.shape[1] != width))
      fail(node,
           std::to_string(rows.numbers) + " numbers do not make rows of " + std::to_string(width));
    const std::uint64_t count = rows.numbers / width;
    for (std::uint64_t first = 0; first < count; first += kRows) {
      const std::uint64_t n = std::min(kRows, count - first);
      Hdf5Dataset part = rows.dataset;
      part.sliced = true;
      part.min = static_cast<std::size_t>(n * width);
      if (rows.shape.size() == 2)
        part.slab = {{first, 0}, {1, 1}, {n, width}};
      else
        part.slab = {{first * width}, {1}, {n * width}};
      NumberArrays values = readHdf5({part}, source_.path, report_, progress_);
      std::visit([&](auto& v) { v.resize(part.min); }, values.front());
      take(std::move(values.front()), first);
    }
  }

  void readPoints(pugi::xml_node geometry) {
    std::string_view type = geometry.attribute("GeometryType").value();
    if (type.empty())
      type = geometry.attribute("Type").value();
    if (!type.empty() && !sameWord(type, "XYZ"))
      fail(geometry, "points are given as " + std::string(type) + "; only XYZ can be prepared",
           kWhole);
    const Rows rows = open(geometry);
    checkPointCount(rows.numbers / 3, source_.path);
    eachRows(geometry, rows, 3, [&](const Attribute::Values& values, std::uint64_t first) {
      std::vector<Vec3d> points;
      std::visit(
          [&](const auto& v) {
            points.resize(v.size() / 3);
            for (std::size_t i = 0; i < v.size(); ++i)
              points[i / 3][i % 3] = static_cast<double>(v[i]);
          },
          values);
      const auto bad = std::find_if_not(points.begin(), points.end(), isFinite);
      if (bad != points.end())
        fail(geometry,
             "point " + std::to_string(first + static_cast<std::uint64_t>(bad - points.begin())) +
                 " has a coordinate that is not finite");
      mesh_.points.append(points);
    });
  }

  void readCells(pugi::xml_node topology) {
    std::string_view type = topology.attribute("TopologyType").value();
    if (type.empty())
      type = topology.attribute("Type").value();
    const std::string name = xdmfTypeName(type);
    if (topology.attribute("BaseOffset"))
      offset_ = static_cast<std::uint64_t>(
          NumberParser(topology.attribute("BaseOffset").value(), markup_.where(topology))
              .integer());
    const Rows rows = open(topology);
    if (name == "mixed") {
      readMixedCells(topology, rows);
    } else {
      const XdmfShape* shape = xdmfShape(name);
      if (shape == nullptr || isFlat(*shape))
        refuseToSpool(markup_.where(topology), std::string(type));
      requireLinear(topology, *shape);
      eachRows(topology, rows, shape->nodes,
               [&](const Attribute::Values& values, std::uint64_t first) {
                 std::vector<std::uint32_t> nodes;
                 std::visit(
                     [&](const auto& v) {
                       nodes.resize(v.size());
                       for (std::size_t i = 0; i < v.size(); ++i)
                         nodes[i] = xdmfNode(xdmfIndex(v[i]), offset_);
                     },
                     values);
                 addCells(topology, *shape, first, nodes);
               });
      cells_ = mesh_.cellCount();
    }
    requireDeclared(topology);
  }

  static bool isFlat(const XdmfShape& shape) {
    return vtk::cellKind(shape.vtk).type == CellType::Flat;
  }
  void requireLinear(pugi::xml_node topology, const XdmfShape& shape) const {
    const vtk::CellProperties& kind = vtk::cellKind(shape.vtk);
    if (kind.nodes != SpooledMesh::cornersOf(kind.type))
      refuseToSpool(markup_.where(topology), kind.name);
  }

  void requireDeclared(pugi::xml_node topology) const {
    for (const char* name : {"NumberOfElements", "NumberOfCells"}) {
      const std::string_view text = topology.attribute(name).value();
      if (text.empty())
        continue;
      NumberParser in(text, markup_.where(topology));
      std::vector<std::uint64_t> declared;
      while (!in.atEnd() && declared.size() < 8)
        declared.push_back(static_cast<std::uint64_t>(std::max<std::int64_t>(in.integer(), 0)));
      if (const std::uint64_t count = product(topology, declared); count != cells_)
        fail(topology, std::to_string(count) + " cells are declared, but there are " +
                           std::to_string(cells_));
      return;
    }
  }

  // `first`: the number of the first of the cells.
  void addCells(pugi::xml_node topology, const XdmfShape& shape, std::uint64_t first,
                const std::vector<std::uint32_t>& nodes) {
    const std::size_t points = mesh_.pointCount();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (nodes[i] >= points)
        fail(topology, "cell " + std::to_string(first + i / shape.nodes) +
                           " refers to a point that is not there: there are " +
                           std::to_string(points));
    const vtk::CellProperties& kind = vtk::cellKind(shape.vtk);
    mesh_.addCells(kind.type, nodes.data(), nodes.size() / shape.nodes);
    mesh_.cells[kind.name] += nodes.size() / shape.nodes;
  }

  // For each cell the number of its shape, the number of its nodes if it varies, and its nodes: a
  // cell may lie in several parts of the dataset.
  void readMixedCells(pugi::xml_node topology, const Rows& rows) {
    const XdmfShape* shape = nullptr; // of the cell that is being read
    bool countFollows = false;
    std::uint64_t left = 0;
    std::vector<std::uint32_t> nodes; // of cells of `shape` before this one, and its own
    std::uint64_t first = 0;
    std::vector<std::uint8_t> solid;
    const auto flush = [&] {
      // The last cell may not be complete.
      const auto whole = nodes.end() - static_cast<std::ptrdiff_t>(
                                           left > 0 && !nodes.empty() ? shape->nodes - left : 0);
      if (whole != nodes.begin())
        addCells(topology, *shape, first, {nodes.begin(), whole});
      nodes.erase(nodes.begin(), whole);
      first = cells_;
    };
    const auto endCell = [&] {
      ++cells_;
      solid.push_back(isFlat(*shape) ? 0 : 1);
    };
    const auto begin = [&](std::uint64_t number) {
      const XdmfShape* next = xdmfShapeOf(number);
      const auto cell = [&] { return "cell " + std::to_string(cells_); };
      if (next == nullptr)
        fail(topology,
             number == 16 ? cell() + " is a polyhedron, which is not read"
                          : cell() + " has an unknown type",
             "export the mesh with other cells");
      if (next != shape)
        flush();
      shape = next;
      if (!isFlat(*next))
        requireLinear(topology, *next);
      else
        ++mesh_.cells[vtk::cellKind(next->vtk).name];
      countFollows = next->nodes == 0;
      left = next->nodes;
    };
    const auto take = [&](std::uint64_t number) {
      if (countFollows) {
        countFollows = false;
        left = number;
        if (left == 0)
          endCell();
        return;
      }
      if (left == 0)
        return begin(number);
      if (!isFlat(*shape))
        nodes.push_back(xdmfNode(number, offset_));
      if (--left == 0)
        endCell();
    };
    eachRows(topology, rows, 1, [&](const Attribute::Values& values, std::uint64_t) {
      std::visit(
          [&](const auto& v) {
            for (const auto number : v)
              take(xdmfIndex(number));
          },
          values);
      flush();
      isSolid_.append(solid);
      solid.clear();
    });
    if (left > 0 || countFollows)
      fail(topology, "cell " + std::to_string(cells_) + " ends beyond the topology's numbers");
    isSolid_.finish();
  }

  // Leaves out the rows of cells without a volume.
  void keepSolid(std::uint64_t first, std::uint64_t width, Attribute::Values& values) const {
    std::visit(
        [&](auto& v) {
          const auto* solid = isSolid_.as<std::uint8_t>() + first;
          auto to = v.begin();
          for (std::size_t i = 0; i < v.size() / width; ++i) {
            const auto from = v.begin() + static_cast<std::ptrdiff_t>(i * width);
            if (solid[i] != 0)
              to = std::copy(from, from + static_cast<std::ptrdiff_t>(width), to);
          }
          v.erase(to, v.end());
        },
        values);
    isSolid_.release();
  }

  bool holdsIntegers(pugi::xml_node attribute) const {
    const pugi::xml_node item = markup_.child(attribute, "DataItem");
    std::string_view type = item.attribute("NumberType").value();
    if (type.empty())
      type = item.attribute("DataType").value();
    return !type.empty() && !sameWord(type, "Float");
  }

  void readAttribute(pugi::xml_node node) {
    std::string name = node.attribute("Name").value();
    if (name.empty())
      name = "unnamed";
    const std::string_view centre = node.attribute("Center").value();
    const bool onPoints = centre.empty() || sameWord(centre, "Node");
    const auto on = onPoints ? Attribute::On::Points : Attribute::On::Cells;
    if (!onPoints && !sameWord(centre, "Cell"))
      return;
    const std::string_view kind = node.attribute("ItemType").value();
    const bool isFunction = !kind.empty() && !sameWord(kind, "Uniform");
    const bool forRegions =
        !onPoints && !isFunction && (name == options_.regionArray || holdsIntegers(node));
    if (!options_.wants(name) && !forRegions) {
      if (options_.attributes)
        mesh_.unread.push_back({name, on, 1});
      return;
    }
    if (isFunction)
      fail(node, "is a function, which can only be read with the whole mesh", kWhole);
    const Rows rows = open(node);
    const std::size_t elements = onPoints ? mesh_.pointCount() : std::size_t(cells_);
    constexpr std::uint64_t kMaxComponents = 1u << 16;
    if (elements == 0)
      return;
    const std::uint64_t width = rows.numbers / elements;
    if (rows.numbers % elements != 0 || width == 0 || width > kMaxComponents)
      fail(node, std::to_string(rows.numbers) + " numbers for " + std::to_string(elements) +
                     (onPoints ? " points" : " cells"));
    if (mesh_.find(name, on) != nullptr)
      return;
    const bool isTensor =
        width == 6 && sameWord(node.attribute("AttributeType").value(), "Tensor6");
    eachRows(node, rows, width, [&](Attribute::Values&& values, std::uint64_t first) {
      if (isTensor)
        std::visit([](auto& v) { orderXdmfTensor(v); }, values);
      if (!onPoints && isSolid_.size() > 0)
        keepSolid(first, width, values);
      if (first == 0)
        mesh_.add(name, on, static_cast<std::uint32_t>(width), values.index());
      SpooledArray* array = mesh_.find(name, on);
      if (array->type != values.index())
        fail(node, "its dataset has numbers of several types");
      const auto [bytes, size] = bytesOf(values);
      array->values->append(bytes, size);
    });
  }

  const Source& source_;
  const ReadOptions& options_;
  SpooledMesh& mesh_;
  Report& report_;
  Progress& progress_;
  XdmfMarkup markup_;
  XdmfGrids grids_;
  std::vector<pugi::xml_node> pieces_;
  std::uint64_t offset_ = 0; ///< of the first point's number
  std::uint64_t cells_ = 0;  ///< of the file, also those without a volume
  FileSpool isSolid_;        ///< one std::uint8_t a cell of a Mixed topology
};

} // namespace

void spoolXdmf(const Source& source, const ReadOptions& options, SpooledMesh& mesh, Report& report,
               Progress& progress) {
  XdmfSpooler(source, options, mesh, report, progress).read();
}

} // namespace tetvdb
