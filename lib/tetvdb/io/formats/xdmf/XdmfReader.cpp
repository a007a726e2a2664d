// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/xdmf/XdmfReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/cells/StructuredBlock.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/formats/xdmf/XdmfData.h"
#include "tetvdb/io/formats/xdmf/XdmfFunction.h"
#include "tetvdb/io/formats/xdmf/XdmfGrids.h"
#include "tetvdb/io/formats/xdmf/XdmfMarkup.h"
#include "tetvdb/io/formats/xdmf/XdmfNumbers.h"
#include "tetvdb/io/formats/xdmf/XdmfShapes.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

namespace tetvdb {
namespace {

/// A mesh: its topology and geometry, and the grids with attributes on it.
struct Piece {
  pugi::xml_node grid, topology, geometry;
  std::vector<pugi::xml_node> attributes;
  pugi::xml_node function; ///< the domain's temporal collection that contains the grid, if any
};

// --- Meshes -------------------------------------------------------------------------------------

class XdmfFile {
public:
  XdmfFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : source_(source), options_(options), report_(report), progress_(progress), markup_(source),
        grids_(markup_), data_(markup_, source, report, progress) {}

  CellMesh read() {
    findPieces();
    for (const Piece& piece : pieces_)
      need(piece);
    data_.load();
    progress_.update(0.4);
    std::vector<FunctionMesh> meshes;
    std::size_t done = 0;
    for (const Piece& piece : pieces_) {
      addMesh({piece.function, make(piece)}, meshes);
      progress_.update(0.4 +
                       0.6 * static_cast<double>(++done) / static_cast<double>(pieces_.size()));
    }
    CellMesh whole = std::move(meshes.front().mesh);
    for (std::size_t i = 1; i < meshes.size(); ++i)
      vtk::appendPiece(whole, std::exchange(meshes[i].mesh, {}), report_);
    return whole;
  }

  /// By the types of the topologies; none for a mixed one.
  std::optional<bool> hasSolidCells() {
    findPieces();
    std::optional<bool> solid = false;
    for (const Piece& piece : pieces_) {
      if (isStructured(piece.topology)) {
        if (isSolidBlock(blockSize(piece.topology)))
          return true;
        continue;
      }
      const XdmfShape* shape = shapeOf(piece.topology);
      if (shape == nullptr)
        solid = std::nullopt;
      else if (vtk::cellKind(shape->vtk).type != CellType::Flat)
        return true;
    }
    return solid;
  }

private:
  [[noreturn]] void fail(pugi::xml_node node, const std::string& what,
                         const char* advice = kExport) const {
    throw Error(Status::Invalid, markup_.where(node), what, advice);
  }

  struct FunctionMesh {
    pugi::xml_node function; ///< Piece::function
    CellMesh mesh;
  };

  // A repeated mesh, written again for another function, contributes only its arrays.
  static void addMesh(FunctionMesh&& added, std::vector<FunctionMesh>& meshes) {
    CellMesh& mesh = added.mesh;
    const auto sameRun = [](const CellRun& a, const CellRun& b) {
      return a.type == b.type && a.nodesPerCell == b.nodesPerCell && a.count == b.count;
    };
    for (auto& [function, known] : meshes) {
      if (function == added.function || known.points != mesh.points || known.nodes != mesh.nodes ||
          !std::equal(known.runs.begin(), known.runs.end(), mesh.runs.begin(), mesh.runs.end(),
                      sameRun))
        continue;
      for (Attribute& attribute : mesh.attributes)
        if (!hasAttribute(known, attribute.name, attribute.on))
          known.attributes.push_back(std::move(attribute));
      known.unread.insert(known.unread.end(), mesh.unread.begin(), mesh.unread.end());
      return;
    }
    meshes.push_back(std::move(added));
  }
  static bool hasAttribute(const CellMesh& mesh, const std::string& name, Attribute::On on) {
    return std::any_of(mesh.attributes.begin(), mesh.attributes.end(), [&](const Attribute& other) {
      return other.on == on && other.name == name;
    });
  }

  void findPieces() {
    const std::vector<pugi::xml_node> all = grids_.children(markup_.domain());
    if (all.empty())
      throw Error(Status::Invalid, source_.path, "has no <Grid>", "export it again");
    const pugi::xml_node temporal = grids_.temporal(markup_.domain());
    const XdmfGrids::Step step = grids_.step(temporal, options_.timeStep);
    for (const pugi::xml_node grid : all) {
      // The mesh to which temporal collections refer is beside them.
      if (temporal && !grids_.temporal(grid))
        continue;
      if (grids_.isTemporal(grid) && grids_.children(grid).size() != step.count)
        leaveOut(grid, "has another number of steps");
      else
        addGrids(grid, step.index, temporal ? grid : pugi::xml_node());
    }
    if (pieces_.empty())
      throw Error(Status::Invalid, source_.path, "has no grid with a topology and a geometry",
                  "export it again");
  }

  void leaveOut(pugi::xml_node grid, const std::string& why) {
    report_.warn("grid-left-out", std::string("the grid '") + grid.attribute("Name").value() +
                                      "' is left out: it " + why);
  }

  void addGrids(pugi::xml_node top, std::size_t step, pugi::xml_node function) {
    std::vector<pugi::xml_node> uniform;
    grids_.uniform(top, step, uniform);
    for (const pugi::xml_node grid : uniform)
      addGrid(grid, function);
  }

  void addGrid(pugi::xml_node grid, pugi::xml_node function) {
    Piece piece{grid, markup_.child(grid, "Topology"), markup_.child(grid, "Geometry"),
                markup_.children(grid, "Attribute"), function};
    if (!piece.topology || !piece.geometry)
      fail(grid, piece.topology ? "has no <Geometry>" : "has no <Topology>", "export it again");
    for (Piece& known : pieces_) {
      if (known.geometry != piece.geometry)
        continue;
      // In a collection these are parts of one mesh; outside they repeat some of its cells.
      if (known.topology != piece.topology && grid.parent() != markup_.domain())
        continue;
      if (known.topology != piece.topology)
        return leaveOut(grid, "has cells of its own on the points of '" +
                                  std::string(known.grid.attribute("Name").value()) + "'");
      known.attributes.insert(known.attributes.end(), piece.attributes.begin(),
                              piece.attributes.end());
      return;
    }
    pieces_.push_back(std::move(piece));
  }

  static bool onPoints(pugi::xml_node attribute) {
    const std::string_view centre = attribute.attribute("Center").value();
    return centre.empty() || sameWord(centre, "Node");
  }
  // Attributes on nodes and cells that are requested, or may define regions.
  bool isWanted(pugi::xml_node attribute) const {
    const std::string_view name = attribute.attribute("Name").value();
    if (isFunction(attribute))
      return options_.wants(name);
    if (!onPoints(attribute) && !sameWord(attribute.attribute("Center").value(), "Cell"))
      return false;
    return options_.wants(name) ||
           (!onPoints(attribute) && (name == options_.regionArray || holdsIntegers(attribute)));
  }
  bool holdsIntegers(pugi::xml_node attribute) const {
    const pugi::xml_node item = markup_.child(attribute, "DataItem");
    std::string_view type = item.attribute("NumberType").value();
    if (type.empty())
      type = item.attribute("DataType").value();
    return !type.empty() && !sameWord(type, "Float");
  }
  static bool isFunction(pugi::xml_node attribute) {
    const std::string_view kind = attribute.attribute("ItemType").value();
    return !kind.empty() && !sameWord(kind, "Uniform");
  }

  void need(const Piece& piece) {
    for (const pugi::xml_node item : geometryItems(piece))
      data_.need(item);
    if (!isStructured(piece.topology)) {
      shapeOf(piece.topology);
      data_.need(itemOf(piece.topology));
    }
    for (const pugi::xml_node attribute : piece.attributes)
      if (isWanted(attribute))
        for (const pugi::xml_node item : itemsOf(attribute))
          data_.need(item);
  }

  pugi::xml_node itemOf(pugi::xml_node parent) const {
    const pugi::xml_node item = markup_.child(parent, "DataItem");
    if (!item)
      fail(parent, "has no <DataItem>", "export it again");
    return item;
  }

  // The data items of an attribute: for a function its cells' and its numbers.
  std::vector<pugi::xml_node> itemsOf(pugi::xml_node attribute) const {
    if (!isFunction(attribute))
      return {itemOf(attribute)};
    if (!xdmfFunction(attribute))
      return {};
    std::vector<pugi::xml_node> items = markup_.children(attribute, "DataItem");
    if (items.size() < 2)
      fail(attribute, "has too few data items for a function", "export it again");
    items.resize(2);
    return items;
  }

  static std::string_view typeOf(pugi::xml_node node, const char* name) {
    const std::string_view type = node.attribute(name).value();
    return type.empty() ? node.attribute("Type").value() : type;
  }

  /// How a geometry gives the points.
  struct Points {
    const char* type;
    std::size_t items; ///< data items
    std::size_t width; ///< coordinates of a point
    bool straight;     ///< those of the axes of a rectilinear grid, not of the points
  };
  static constexpr Points kPoints[] = {{"XYZ", 1, 3, false},          {"XY", 1, 2, false},
                                       {"X_Y_Z", 3, 1, false},        {"X_Y", 2, 1, false},
                                       {"VXVYVZ", 3, 1, true},        {"VXVY", 2, 1, true},
                                       {"ORIGIN_DXDYDZ", 2, 3, true}, {"ORIGIN_DXDY", 2, 2, true}};
  const Points& pointsOf(const Piece& piece) const {
    const std::string_view type = typeOf(piece.geometry, "GeometryType");
    for (const Points& known : kPoints)
      if (sameWord(type, known.type) || (type.empty() && &known == kPoints)) {
        if (known.straight && !isStructured(piece.topology))
          fail(piece.geometry,
               "the points are given as " + std::string(type) +
                   ", as those of structured grids are",
               "export the points as XYZ or X_Y_Z");
        return known;
      }
    fail(piece.geometry, "points given as " + std::string(type) + " are not read",
         "export the points as XYZ or X_Y_Z");
  }

  std::vector<pugi::xml_node> geometryItems(const Piece& piece) const {
    const std::size_t needed = pointsOf(piece).items;
    std::vector<pugi::xml_node> items = markup_.children(piece.geometry, "DataItem");
    if (items.size() < needed)
      fail(piece.geometry, "has too few data items", "export it again");
    items.resize(needed);
    return items;
  }

  CellMesh make(const Piece& piece) {
    CellMesh mesh;
    if (isStructured(piece.topology)) {
      readBlock(piece, mesh);
    } else {
      readPoints(piece, mesh);
      readCells(piece.topology, mesh);
    }
    for (const pugi::xml_node attribute : piece.attributes)
      readAttribute(attribute, mesh);
    return mesh;
  }

  void readPoints(const Piece& piece, CellMesh& mesh) {
    const std::vector<pugi::xml_node> items = geometryItems(piece);
    const std::size_t each = pointsOf(piece).width;
    for (std::size_t axis = 0; axis < items.size(); ++axis) {
      const Attribute::Values values = data_.take(items[axis]);
      std::visit(
          [&](const auto& numbers) {
            const std::size_t points = numbers.size() / each;
            if (numbers.size() % each != 0 || (axis > 0 && points != mesh.points.size()))
              fail(piece.geometry,
                   std::to_string(numbers.size()) + " coordinates do not make points");
            checkPointCount(points, source_.path);
            mesh.points.resize(points, Vec3d{0, 0, 0});
            for (std::size_t i = 0; i < points; ++i)
              for (std::size_t k = 0; k < each; ++k)
                mesh.points[i][items.size() == 1 ? k : axis] =
                    static_cast<double>(numbers[i * each + k]);
          },
          values);
    }
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
      if (!isFinite(mesh.points[i]))
        fail(piece.geometry, "point " + std::to_string(i) + " has a coordinate that is not finite");
  }

  // --- structured grids: 3DSMesh, 2DRectMesh, ... ---

  static bool isStructured(pugi::xml_node topology) {
    const std::string name = xdmfTypeName(typeOf(topology, "TopologyType"));
    return name.find("mesh") != std::string::npos && (name[0] == '2' || name[0] == '3');
  }
  /// From the numbers of points, which are listed along z first.
  BlockSize blockSize(pugi::xml_node topology) const {
    std::string_view text = topology.attribute("Dimensions").value();
    if (text.empty())
      text = topology.attribute("NumberOfElements").value();
    NumberParser in(text, markup_.where(topology));
    std::vector<std::size_t> points;
    while (!in.atEnd()) {
      const std::int64_t number = in.integer();
      if (number < 1 || points.size() == 3)
        fail(topology, "has no numbers of points along the axes");
      points.insert(points.begin(), static_cast<std::size_t>(number));
    }
    if (points.size() < 2)
      fail(topology, "has no numbers of points along the axes");
    points.resize(3, 1);
    return {points[0], points[1], points[2]};
  }

  void readBlock(const Piece& piece, CellMesh& mesh) {
    const BlockSize size = blockSize(piece.topology);
    if (pointsOf(piece).straight)
      mesh.points = straightPoints(piece, size);
    else
      readPoints(piece, mesh);
    if (blockPoints(size, mesh.points.size(), markup_.where(piece.topology)) != mesh.points.size())
      fail(piece.topology,
           "has fewer points than its geometry, " + std::to_string(mesh.points.size()));
    appendBlock(mesh, size, 0, options_.faces);
  }

  std::vector<Vec3d> straightPoints(const Piece& piece, const BlockSize& size) {
    const Points& points = pointsOf(piece);
    const std::size_t axes = std::max(points.items, points.width);
    std::array<std::vector<double>, 3> along;
    if (axes == 2)
      along[2] = {0};
    std::vector<std::vector<double>> given;
    for (const pugi::xml_node item : geometryItems(piece)) {
      given.emplace_back();
      std::visit([&](const auto& n) { given.back().assign(n.begin(), n.end()); }, data_.take(item));
    }
    std::size_t bytes = source_.bytes.size(); // of what the grid's values lie in
    for (const pugi::xml_node attribute : piece.attributes)
      for (const pugi::xml_node item : markup_.children(attribute, "DataItem"))
        bytes += data_.fileBytes(item);
    blockPoints(size, maxRectilinearPoints(bytes), markup_.where(piece.topology));
    for (std::size_t axis = 0; axis < axes; ++axis) {
      if (points.width == 1) {
        along[axis] = std::move(given[axis]);
        if (along[axis].size() != size[axis])
          fail(piece.geometry, "has " + std::to_string(along[axis].size()) +
                                   " coordinates along an axis of " + std::to_string(size[axis]) +
                                   " points");
      } else { // origin and spacing, along z first
        if (given[0].size() != axes || given[1].size() != axes)
          fail(piece.geometry, "has no origin and spacing");
        for (std::size_t i = 0; i < size[axis]; ++i)
          along[axis].push_back(given[0][axes - 1 - axis] +
                                static_cast<double>(i) * given[1][axes - 1 - axis]);
      }
    }
    return rectilinearPoints(along, bytes, markup_.where(piece.geometry));
  }

  // The shape of all cells; null for a mixed topology.
  const XdmfShape* shapeOf(pugi::xml_node topology) const {
    const std::string_view type = typeOf(topology, "TopologyType");
    const std::string name = xdmfTypeName(type);
    if (name == "mixed")
      return nullptr;
    if (const XdmfShape* shape = xdmfShape(name))
      return shape;
    fail(topology, "cells of type '" + std::string(type) + "' are not read",
         "export the mesh with other cells");
  }

  std::uint64_t attributeNumber(pugi::xml_node node, const char* name,
                                std::uint64_t missing) const {
    const std::string_view text = node.attribute(name).value();
    if (text.empty())
      return missing;
    NumberParser in(text, markup_.where(node));
    std::uint64_t all = 1;
    while (!in.atEnd()) { // "4 5" is 20
      const std::int64_t number = in.integer();
      if (number < 0 || (number > 0 && all > (std::uint64_t(1) << 40) / std::uint64_t(number)))
        fail(node, std::string(name) + " is no count");
      all *= static_cast<std::uint64_t>(number);
    }
    return all;
  }

  void readCells(pugi::xml_node topology, CellMesh& mesh) {
    const XdmfShape* shape = shapeOf(topology);
    const std::uint64_t offset = attributeNumber(topology, "BaseOffset", 0);
    const Attribute::Values values = data_.take(itemOf(topology));
    vtk::Cells cells;
    cells.where = markup_.where(topology);
    std::visit(
        [&](const auto& numbers) {
          if (shape != nullptr)
            uniformCells(topology, *shape, numbers, offset, cells);
          else
            mixedCells(topology, numbers, offset, cells);
        },
        values);
    std::uint64_t declared = attributeNumber(topology, "NumberOfElements", kNoXdmfIndex);
    if (declared == kNoXdmfIndex)
      declared = attributeNumber(topology, "NumberOfCells", kNoXdmfIndex);
    if (declared != kNoXdmfIndex && declared != cells.types.size())
      fail(topology, std::to_string(declared) + " cells are declared, but there are " +
                         std::to_string(cells.types.size()));
    vtk::appendCells(std::move(cells), mesh, progress_, options_.faces);
  }

  template <class Numbers>
  void uniformCells(pugi::xml_node topology, const XdmfShape& shape, const Numbers& numbers,
                    std::uint64_t offset, vtk::Cells& cells) const {
    std::uint64_t each = shape.nodes;
    if (each == 0)
      each = attributeNumber(topology, "NodesPerElement", shape.mixed == 2 ? 2 : 1);
    if (each == 0 || numbers.size() % each != 0)
      fail(topology, std::to_string(numbers.size()) + " numbers do not make cells of " +
                         std::to_string(each) + " nodes");
    const std::size_t n = numbers.size() / each;
    cells.types.assign(n, shape.vtk);
    cells.ends.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      cells.ends[i] = (i + 1) * each;
    cells.connectivity.resize(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i)
      cells.connectivity[i] = xdmfNode(xdmfIndex(numbers[i]), offset);
  }

  // For each cell the number of its shape, the number of its nodes if it varies, and its nodes.
  template <class Numbers>
  void mixedCells(pugi::xml_node topology, const Numbers& numbers, std::uint64_t offset,
                  vtk::Cells& cells) const {
    for (std::size_t at = 0; at < numbers.size();) {
      const std::uint64_t number = xdmfIndex(numbers[at++]);
      const XdmfShape* shape = xdmfShapeOf(number);
      const auto cell = "cell " + std::to_string(cells.types.size());
      if (shape == nullptr)
        fail(topology,
             number == 16 ? cell + " is a polyhedron, which is not read"
                          : cell + " has an unknown type",
             "export the mesh with other cells");
      std::uint64_t nodes = shape->nodes;
      if (nodes == 0 && at < numbers.size())
        nodes = xdmfIndex(numbers[at++]);
      if (nodes > numbers.size() - at)
        fail(topology, cell + " ends beyond the topology's numbers");
      for (const std::size_t end = at + nodes; at < end; ++at)
        cells.connectivity.push_back(xdmfNode(xdmfIndex(numbers[at]), offset));
      cells.types.push_back(shape->vtk);
      cells.ends.push_back(cells.connectivity.size());
    }
  }

  void readAttribute(pugi::xml_node node, CellMesh& mesh) {
    std::string name = node.attribute("Name").value();
    if (name.empty())
      name = "unnamed";
    const auto on = onPoints(node) ? Attribute::On::Points : Attribute::On::Cells;
    if (!isWanted(node)) {
      if (const std::optional<XdmfFunction> function = xdmfFunction(node)) {
        mesh.unread.push_back({std::move(name), function->on, 1});
        return;
      }
      const bool elsewhere =
          on == Attribute::On::Cells && !sameWord(node.attribute("Center").value(), "Cell");
      if (options_.attributes && !elsewhere)
        mesh.unread.push_back({std::move(name), on, 1});
      return;
    }
    if (const std::optional<XdmfFunction> function = xdmfFunction(node))
      return readFunction(node, *function, std::move(name), mesh);
    if (isFunction(node)) {
      report_.warn("array-left-out", "the array '" + name + "' is a '" +
                                         node.attribute("ItemType").value() +
                                         "', which is not read, and is left out");
      return;
    }
    Attribute attribute;
    attribute.values = data_.take(itemOf(node));
    if (hasAttribute(mesh, name, on))
      return;
    const std::size_t elements =
        on == Attribute::On::Points ? mesh.points.size() : mesh.cellCount();
    const std::size_t numbers =
        std::visit([](const auto& values) { return values.size(); }, attribute.values);
    constexpr std::size_t maxComponents = 1u << 16;
    if (elements == 0)
      return;
    if (numbers % elements != 0 || numbers == 0 || numbers / elements > maxComponents)
      fail(node, std::to_string(numbers) + " numbers for " + std::to_string(elements) +
                     (on == Attribute::On::Points ? " points" : " cells"));
    attribute.name = std::move(name);
    attribute.on = on;
    attribute.components = static_cast<std::uint32_t>(numbers / elements);
    if (attribute.components == 6 && sameWord(node.attribute("AttributeType").value(), "Tensor6"))
      std::visit([](auto& values) { orderXdmfTensor(values); }, attribute.values);
    mesh.attributes.push_back(std::move(attribute));
  }

  void readFunction(pugi::xml_node node, const XdmfFunction& function, std::string&& name,
                    CellMesh& mesh) {
    const std::vector<pugi::xml_node> items = itemsOf(node);
    const Attribute::Values dofs = data_.take(items[0]), numbers = data_.take(items[1]);
    if (hasAttribute(mesh, name, function.on))
      return;
    if (function.degree > 1)
      report_.warn("linear-array", "the array '" + name + "' is a function of degree " +
                                       std::to_string(function.degree) +
                                       "; its values at the corners of cells are taken, between "
                                       "them it becomes linear");
    Attribute attribute = arrayOf(function, dofs, numbers, mesh, markup_.where(node));
    attribute.name = std::move(name);
    mesh.attributes.push_back(std::move(attribute));
  }

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  XdmfMarkup markup_;
  XdmfGrids grids_;
  XdmfData data_;
  std::vector<Piece> pieces_;
};

} // namespace

CellMesh readXdmf(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress) {
  CellMesh mesh = XdmfFile(source, options, report, progress).read();
  mesh.times = xdmfTimes(source);
  return mesh;
}

bool xdmfHasSolidCells(const Source& source, Report& report, Progress& progress) {
  ReadOptions options;
  options.attributes = false;
  const std::optional<bool> solid = XdmfFile(source, options, report, progress).hasSolidCells();
  return solid ? *solid : hasSolidCells(readXdmf(source, options, report, progress));
}

} // namespace tetvdb
