// SPDX-License-Identifier: Apache-2.0
//
// Format: AVS Developer's Guide, "UCD file format"; the binary form as in VTK's reader.
#include "tetvdb/io/formats/avs/UcdReader.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

struct UcdKind {
  const char* name; ///< in text files; its index is the number in binary files
  CellKind kind;
};
constexpr UcdKind kKinds[] = {
    {"pt", {"point", CellType::Flat, 0, 1}},
    {"line", {"line", CellType::Flat, 0, 2}},
    {"tri", {"triangle", CellType::Flat, 0, 3}},
    {"quad", {"quad", CellType::Flat, 0, 4}},
    {"tet", {"tetra", CellType::Tetra, 4, 4}},
    {"pyr", {"pyramid", CellType::Pyramid, 5, 5}},
    {"prism", {"wedge", CellType::Wedge, 6, 6}},
    {"hex", {"hexahedron", CellType::Hexahedron, 8, 8}},
};

/// With the corners of triangles and quadrilaterals where they are asked for.
CellKind kept(CellKind kind, const ReadOptions& options) {
  if (options.faces && kind.type == CellType::Flat && kind.nodes >= 3)
    kind.corners = kind.nodes;
  return kind;
}

/// UCD has the apex of a pyramid first; its prisms and hexahedra are VTK's upside down.
void reorder(const CellKind& kind, std::vector<std::uint32_t>& nodes) {
  if (kind.type == CellType::Pyramid)
    std::rotate(nodes.end() - 5, nodes.end() - 4, nodes.end());
}

template <class In>
std::int32_t material(const In& in, std::int64_t number) {
  if (number < std::numeric_limits<std::int32_t>::min() ||
      number > std::numeric_limits<std::int32_t>::max())
    in.fail("a material number is out of range");
  return static_cast<std::int32_t>(number);
}

class TextReader {
public:
  TextReader(const Source& source, const ReadOptions& options, Progress& progress)
      : source_(source), options_(options), progress_(progress), in_(source, '#') {}

  CellMesh read() {
    const std::int64_t points = in_.integer();
    const std::int64_t cells = in_.integer();
    const std::int64_t nodeData = in_.integer();
    const std::int64_t cellData = in_.integer();
    in_.checkCount(points, "nodes", 8);
    in_.checkCount(cells, "cells", 8);
    in_.line(); // the number of model data, which is left out
    checkPointCount(static_cast<std::uint64_t>(points), source_.path);
    readNodes(static_cast<std::size_t>(points));
    readCells(static_cast<std::size_t>(cells));
    if (options_.attributes || !options_.regionArray.empty()) {
      if (nodeData > 0)
        readData(nodes_, Attribute::On::Points);
      if (cellData > 0)
        readData(cells_, Attribute::On::Cells);
    }
    return std::move(mesh_);
  }

private:
  void readNodes(std::size_t n) {
    mesh_.points.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      nodes_.add(in_.integer());
      const double x = in_.real(), y = in_.real(), z = in_.real();
      mesh_.points.push_back({x, y, z});
      if (i % kItemsPerUpdate == 0)
        update();
    }
    nodes_.finish();
    if (nodes_.duplicates() > 0)
      in_.fail("a node number is used twice", "renumber the nodes");
  }

  void readCells(std::size_t n) {
    mesh_.regions.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      cells_.add(in_.integer());
      mesh_.regions.push_back(material(in_, in_.integer()));
      const std::string_view name = in_.word();
      const auto known = std::find_if(std::begin(kKinds), std::end(kKinds),
                                      [&](const UcdKind& kind) { return kind.name == name; });
      if (known == std::end(kKinds))
        in_.fail("a cell is of no known kind (tet, pyr, prism, hex)");
      const CellKind kind = kept(known->kind, options_);
      for (std::uint32_t k = 0; k < kind.nodes; ++k) {
        const std::int64_t id = in_.integer();
        const std::uint32_t index = nodes_.find(id);
        if (index == IdMap::kNone)
          in_.fail("a cell uses node " + std::to_string(id) + ", which does not exist",
                   "the file is damaged; export it again");
        if (k < kind.corners)
          mesh_.nodes.push_back(index);
      }
      reorder(kind, mesh_.nodes);
      appendCells(mesh_, kind);
      if (i % kItemsPerUpdate == 0)
        update();
    }
    cells_.finish();
  }

  void readData(const IdMap& ids, Attribute::On on) {
    const std::size_t groups = in_.count("data components", 2);
    std::vector<std::size_t> sizes;
    for (std::size_t i = 0; i < groups; ++i)
      sizes.push_back(in_.count("numbers of a data component", 2));
    in_.line();
    std::size_t total = 0;
    for (const std::size_t size : sizes)
      total += size;
    in_.checkCount(static_cast<std::int64_t>(std::min<std::size_t>(total, std::size_t(1) << 62)),
                   "data components", 2);
    const std::size_t n = ids.size();
    if (n > 0)
      in_.checkCount(static_cast<std::int64_t>(n), "rows of data", 2 * (1 + total));
    const std::size_t first = mesh_.attributes.size();
    for (const std::size_t size : sizes) {
      std::string_view label = in_.line();
      label = label.substr(0, label.find(','));
      while (!label.empty() && static_cast<unsigned char>(label.back()) <= ' ')
        label.remove_suffix(1);
      if (size > 0)
        mesh_.attributes.push_back({std::string(label), on, static_cast<std::uint32_t>(size),
                                    std::vector<double>(n * size, kMissing)});
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t id = in_.integer();
      const std::uint32_t index = ids.find(id);
      if (index == IdMap::kNone)
        in_.fail("data for number " + std::to_string(id) + ", which does not exist");
      for (std::size_t a = first; a < mesh_.attributes.size(); ++a) {
        Attribute& attribute = mesh_.attributes[a];
        double* to = std::get<std::vector<double>>(attribute.values).data() +
                     std::size_t(index) * attribute.components;
        for (std::uint32_t c = 0; c < attribute.components; ++c)
          to[c] = in_.value();
      }
      if (i % kItemsPerUpdate == 0)
        update();
    }
  }

  void update() {
    progress_.update(static_cast<double>(in_.position()) /
                     static_cast<double>(source_.bytes.size()));
  }

  static constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
  const Source& source_;
  const ReadOptions& options_;
  Progress& progress_;
  NumberParser in_;
  CellMesh mesh_;
  IdMap nodes_;
  IdMap cells_;
};

// A byte 7, six counts, cells, their nodes, x, y, z, and data, all of them ints and floats.
class BinaryReader {
public:
  BinaryReader(const Source& source, const ReadOptions& options, Progress& progress)
      : source_(source), options_(options), progress_(progress), in_(source) {}

  CellMesh read() {
    // The byte order is known only from the condition that the counts fit the file.
    if (!readCounts(false) && !readCounts(true))
      in_.fail("its counts do not fit the file's size in either byte order", kCut);
    progress_.update(0);
    readCells();
    readPoints();
    if (options_.attributes || !options_.regionArray.empty()) {
      readData(nodeData_, Attribute::On::Points, points_);
      readData(cellData_, Attribute::On::Cells, cells_);
    }
    return std::move(mesh_);
  }

private:
  bool readCounts(bool swap) {
    in_.setSwap(swap);
    in_.seek(1);
    std::int64_t counts[6]; // points, cells, node data, cell data, model data, corners of all cells
    for (std::int64_t& n : counts) {
      n = in_.get<std::int32_t>();
      if (n < 0)
        return false;
    }
    points_ = static_cast<std::size_t>(counts[0]);
    cells_ = static_cast<std::size_t>(counts[1]);
    nodeData_ = static_cast<std::size_t>(counts[2]);
    cellData_ = static_cast<std::size_t>(counts[3]);
    corners_ = static_cast<std::size_t>(counts[5]);
    return 12 * points_ + 16 * cells_ + 4 * corners_ <= in_.remaining();
  }

  void readCells() {
    ByteReader nodes(source_, in_.swap(), in_.position() + 16 * cells_);
    mesh_.regions.reserve(cells_);
    std::size_t used = 0;
    for (std::size_t i = 0; i < cells_; ++i) {
      in_.get<std::int32_t>(); // the cell's number
      mesh_.regions.push_back(in_.get<std::int32_t>());
      const auto count = in_.get<std::int32_t>();
      const auto type = in_.get<std::int32_t>();
      if (type < 0 || type >= static_cast<std::int32_t>(std::size(kKinds)) ||
          count != static_cast<std::int32_t>(kKinds[type].kind.nodes))
        in_.fail("a cell of unknown kind", "the file is damaged; export it again");
      const CellKind kind = kept(kKinds[type].kind, options_);
      used += kind.nodes;
      if (used > corners_)
        in_.fail("cells use more corners than declared");
      for (std::uint32_t k = 0; k < kind.nodes; ++k) {
        const auto number = nodes.get<std::int32_t>();
        if (number < 1 || static_cast<std::size_t>(number) > points_)
          nodes.fail("a cell uses node " + std::to_string(number) + " of " +
                         std::to_string(points_),
                     "the file is damaged; export it again");
        if (k < kind.corners)
          mesh_.nodes.push_back(static_cast<std::uint32_t>(number - 1));
      }
      reorder(kind, mesh_.nodes);
      appendCells(mesh_, kind);
    }
    in_.skip(4 * corners_);
  }

  void readPoints() {
    mesh_.points.resize(points_);
    for (std::size_t k = 0; k < 3; ++k)
      for (Vec3d& point : mesh_.points)
        point[k] = in_.get<float>();
    for (const Vec3d& point : mesh_.points)
      if (!isFinite(point))
        in_.fail("a coordinate is not a finite number", "repair the mesh");
  }

  /// Labels and units, 1024 bytes each; the number of arrays and the components of each of at most
  /// as many as there are columns; min and max values; columns of values.
  void readData(std::size_t columns, Attribute::On on, std::size_t n) {
    if (columns == 0)
      return;
    const std::string_view labels = in_.take(1024);
    in_.take(1024);
    const std::size_t arrays = in_.checkCount(in_.get<std::int32_t>(), 4, "arrays");
    if (arrays > columns)
      in_.fail("more arrays than columns of data");
    in_.checkCount(columns, 12 + 4 * n, "columns of data");
    std::vector<std::size_t> sizes(columns);
    for (std::size_t& size : sizes)
      size = static_cast<std::uint32_t>(in_.get<std::int32_t>());
    in_.skip(8 * columns);
    std::size_t used = 0;
    std::string_view rest = labels.substr(0, labels.find('\0'));
    for (std::size_t i = 0; i < arrays; ++i) {
      const std::size_t size = sizes[i];
      if (size == 0 || size > columns - used)
        in_.fail("an array of impossible size");
      used += size;
      const std::size_t dot = rest.find('.');
      Attribute attribute{std::string(rest.substr(0, dot)), on, static_cast<std::uint32_t>(size),
                          std::vector<float>(n * size)};
      rest = dot == rest.npos ? std::string_view() : rest.substr(dot + 1);
      auto& values = std::get<std::vector<float>>(attribute.values);
      for (std::size_t c = 0; c < size; ++c)
        for (std::size_t k = 0; k < n; ++k)
          values[k * size + c] = in_.get<float>();
      mesh_.attributes.push_back(std::move(attribute));
    }
    in_.skip(4 * columns); // whether each array holds missing values
  }

  const Source& source_;
  const ReadOptions& options_;
  Progress& progress_;
  ByteReader in_;
  CellMesh mesh_;
  std::size_t points_ = 0;
  std::size_t cells_ = 0;
  std::size_t nodeData_ = 0;
  std::size_t cellData_ = 0;
  std::size_t corners_ = 0;
};

} // namespace

CellMesh readUcd(const Source& source, const ReadOptions& options, Report&, Progress& progress) {
  if (!source.bytes.empty() && source.bytes[0] == '\x07')
    return BinaryReader(source, options, progress).read();
  return TextReader(source, options, progress).read();
}

bool ucdHasSolidCells(const Source& source, Report& report, Progress& progress) {
  ReadOptions options;
  options.attributes = false;
  return hasSolidCells(readUcd(source, options, report, progress));
}

} // namespace tetvdb
