// SPDX-License-Identifier: Apache-2.0
//
// Format: TetGen user's manual, "File formats".
#include "tetvdb/io/formats/tetgen/TetGenReader.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/cells/NodeOrder.h"
#include "tetvdb/io/text/NumberParser.h"

#include <limits>

namespace tetvdb {
namespace {

constexpr CellKind kTetra{"tetra", CellType::Tetra, 4, 4};
constexpr CellKind kTetra10{"tetra10", CellType::Tetra, 4, 10, 10};

/// One of the counts in the header line of a file; absent ones are 0.
std::int64_t headNumber(NumberParser& head, NumberParser& in, const char* things,
                        std::int64_t max) {
  std::int64_t n = 0;
  if (head.atEnd())
    return 0;
  if (!head.tryInteger(n) || n < 0 || n > max)
    in.fail(std::string("wrong number of ") + things + " in the head line");
  return n;
}

/// The header line, after blank and comment lines.
NumberParser headLine(NumberParser& in) {
  in.skipSpace();
  return NumberParser(in.line(), in.path(), '#');
}

struct Nodes {
  IdMap ids;
  std::vector<std::vector<double>> attributes;
};

Nodes readNodes(const Source& source, CellMesh& mesh, Progress& progress) {
  NumberParser in(source, '#');
  NumberParser head = headLine(in);
  const std::int64_t declared =
      headNumber(head, in, "nodes", std::numeric_limits<std::int64_t>::max());
  const std::int64_t dimension = headNumber(head, in, "dimensions", 3);
  const std::int64_t attributes = headNumber(head, in, "attributes", 1000);
  const std::int64_t markers = headNumber(head, in, "boundary markers", 1);
  if (dimension != 3 && dimension != 0)
    in.fail("the mesh has " + std::to_string(dimension) + " dimensions",
            "only three-dimensional meshes have a volume");
  in.checkCount(declared, "nodes", static_cast<std::size_t>(2 * (4 + attributes + markers)));
  const auto n = static_cast<std::size_t>(declared);
  checkPointCount(n, source.path);
  Nodes nodes;
  nodes.attributes.resize(static_cast<std::size_t>(attributes));
  for (std::vector<double>& values : nodes.attributes)
    values.reserve(n);
  mesh.points.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    nodes.ids.add(in.integer());
    const double x = in.real(), y = in.real(), z = in.real();
    mesh.points.push_back({x, y, z});
    for (std::vector<double>& values : nodes.attributes)
      values.push_back(in.value());
    if (markers > 0)
      in.value(); // an integer in the format; meshio writes an array here
    if (i % kItemsPerUpdate == 0)
      progress.update(0.5 * static_cast<double>(i) / static_cast<double>(n));
  }
  nodes.ids.finish();
  if (nodes.ids.duplicates() > 0)
    in.fail(std::to_string(nodes.ids.duplicates()) + " node numbers are used twice",
            "renumber the nodes");
  return nodes;
}

/// Requires integers: the array is then the region of every tet.
bool asRegions(const std::vector<double>& values, std::vector<std::int32_t>& regions) {
  regions.clear();
  regions.reserve(values.size());
  for (const double value : values) {
    if (!(std::abs(value) <= 2147483647.0) || value != std::floor(value)) {
      regions = {};
      return false;
    }
    regions.push_back(static_cast<std::int32_t>(value));
  }
  return true;
}

void addAttributes(CellMesh& mesh, std::vector<std::vector<double>>& columns, Attribute::On on) {
  for (std::size_t i = 0; i < columns.size(); ++i)
    mesh.attributes.push_back({"attribute" + std::to_string(i + 1), on, 1, std::move(columns[i])});
}

} // namespace

CellMesh readTetGenPair(const Source& nodeFile, const Source& eleFile, const ReadOptions&, Report&,
                        Progress& progress) {
  CellMesh mesh;
  Nodes nodes = readNodes(nodeFile, mesh, progress);

  NumberParser in(eleFile, '#');
  NumberParser head = headLine(in);
  const std::int64_t declared =
      headNumber(head, in, "tetrahedra", std::numeric_limits<std::int64_t>::max());
  const std::int64_t corners = headNumber(head, in, "nodes a tetrahedron", 10);
  const std::int64_t attributes = headNumber(head, in, "attributes", 1000);
  if (corners != 0 && corners != 4 && corners != 10)
    in.fail("cells have " + std::to_string(corners) + " nodes; tetrahedra have 4 or 10",
            corners == 3 ? "it is a triangle mesh (of Triangle): tetrahedralize it first" : "");
  const CellKind& kind = corners == 10 ? kTetra10 : kTetra;
  in.checkCount(declared, "tetrahedra",
                2 * (1 + kind.nodes + static_cast<std::size_t>(attributes)));
  const auto n = static_cast<std::size_t>(declared);
  mesh.nodes.reserve(kind.stored() * n);
  std::vector<std::vector<double>> columns(static_cast<std::size_t>(attributes));
  for (std::vector<double>& values : columns)
    values.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    in.integer();
    for (std::uint32_t k = 0; k < kind.nodes; ++k) {
      const std::int64_t id = in.integer();
      const std::uint32_t index = nodes.ids.find(id);
      if (index == IdMap::kNone)
        in.fail("a tetrahedron uses node " + std::to_string(id) + ", which " + nodeFile.path +
                    " does not have",
                "check that both files belong together");
      if (k < kind.stored())
        mesh.nodes.push_back(index);
    }
    for (std::vector<double>& values : columns)
      values.push_back(in.value());
    if (i % kItemsPerUpdate == 0)
      progress.update(0.5 + 0.5 * static_cast<double>(i) / static_cast<double>(n));
  }
  appendCells(mesh, kind, n);
  orderMids(mesh);
  if (!columns.empty())
    asRegions(columns[0], mesh.regions);
  addAttributes(mesh, nodes.attributes, Attribute::On::Points);
  addAttributes(mesh, columns, Attribute::On::Cells);
  return mesh;
}

CellMesh readTetGen(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress) {
  const std::size_t dot = source.path.find_last_of('.');
  const std::string ending = dot == std::string::npos ? "" : source.path.substr(dot);
  const bool isNode = ending == ".node" || ending == ".NODE";
  const bool upper = ending == ".NODE" || ending == ".ELE";
  const std::string partner = source.path.substr(0, dot) +
                              (isNode ? (upper ? ".ELE" : ".ele") : (upper ? ".NODE" : ".node"));
  try {
    const MappedFile other(partner);
    return isNode ? readTetGenPair(source, other.source(), options, report, progress)
                  : readTetGenPair(other.source(), source, options, report, progress);
  } catch (const Error& error) {
    if (std::string_view(error.what()).substr(0, partner.size() + 6) == partner + ": cann")
      throw Error(Status::Invalid, source.path, "its other half, " + partner + ", cannot be opened",
                  "TetGen meshes are two files: put .node and .ele side by side");
    throw;
  }
}

} // namespace tetvdb
