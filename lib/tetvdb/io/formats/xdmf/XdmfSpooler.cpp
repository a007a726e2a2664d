// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/formats/xdmf/Hdf5Arrays.h"
#include "tetvdb/io/formats/xdmf/XdmfGrids.h"
#include "tetvdb/io/formats/xdmf/XdmfMarkup.h"
#include "tetvdb/io/formats/xdmf/XdmfNumbers.h"
#include "tetvdb/io/formats/xdmf/XdmfReader.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/Hdf5File.h"
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
        markup_(source), grids_(markup_) {}

  void read() {
    findGrids();
    const pugi::xml_node grid = pieces_.front();
    readPoints(markup_.child(grid, "Geometry"));
    progress_.update(0.3);
    readTets(markup_.child(grid, "Topology"));
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
    rows.shape = shapeOf(rows.dataset);
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

  // By a child process, as the numbers.
  std::vector<std::uint64_t> shapeOf(const Hdf5Dataset& dataset) const {
    const NumberArrays found = readArraysIsolated(
        [&](Report&, Progress&) {
          const std::vector<std::uint64_t> shape = Hdf5File(dataset.file).shape(dataset.path);
          return NumberArrays{std::vector<std::int64_t>(shape.begin(), shape.end())};
        },
        source_.path, {std::uint64_t(2) << 30, 60}, report_, progress_);
    const auto* shape =
        found.size() == 1 ? std::get_if<std::vector<std::int64_t>>(&found.front()) : nullptr;
    if (shape == nullptr || std::any_of(shape->begin(), shape->end(), [](auto n) { return n < 0; }))
      throw Error(Status::Invalid, source_.path, "its HDF5 file cannot be read");
    return {shape->begin(), shape->end()};
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

  void readTets(pugi::xml_node topology) {
    std::string_view type = topology.attribute("TopologyType").value();
    if (type.empty())
      type = topology.attribute("Type").value();
    if (lowerCase(type) != "tetrahedron")
      fail(topology,
           "cells are of type '" + std::string(type) +
               "'; only meshes of linear tets can be prepared",
           kWhole);
    std::uint64_t offset = 0;
    if (topology.attribute("BaseOffset"))
      offset = static_cast<std::uint64_t>(
          NumberParser(topology.attribute("BaseOffset").value(), markup_.where(topology))
              .integer());
    const std::size_t points = mesh_.pointCount();
    eachRows(topology, open(topology), 4,
             [&](const Attribute::Values& values, std::uint64_t first) {
               std::vector<std::uint32_t> tets;
               std::visit(
                   [&](const auto& v) {
                     tets.resize(v.size());
                     for (std::size_t i = 0; i < v.size(); ++i)
                       tets[i] = xdmfNode(xdmfIndex(v[i]), offset);
                   },
                   values);
               for (std::size_t i = 0; i < tets.size(); ++i)
                 if (tets[i] >= points)
                   fail(topology, "cell " + std::to_string(first + i / 4) +
                                      " refers to a point that is not there: there are " +
                                      std::to_string(points));
               mesh_.tets.append(tets);
               mesh_.cells["tetra"] += tets.size() / 4;
             });
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
    const std::size_t elements = onPoints ? mesh_.pointCount() : mesh_.tetCount();
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
};

} // namespace

void spoolXdmf(const Source& source, const ReadOptions& options, SpooledMesh& mesh, Report& report,
               Progress& progress) {
  XdmfSpooler(source, options, mesh, report, progress).read();
}

} // namespace tetvdb
