// SPDX-License-Identifier: Apache-2.0
//
// The format: GAMBIT User's Guide, appendix C "Neutral File Format".
#include "tetvdb/io/formats/gambit/NeuReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/NumberParser.h"

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

namespace tetvdb {
namespace {

/// An element type with this number of nodes; null for types that the format does not have.
const CellKind* kindOf(std::int64_t type, std::int64_t nodes) {
  static const CellKind flat[] = {{"edge", CellType::Flat, 0, 2},
                                  {"quadrilateral", CellType::Flat, 0, 4},
                                  {"triangle", CellType::Flat, 0, 3}};
  static const CellKind linear[] = {{"brick", CellType::Hexahedron, 8, 8},
                                    {"wedge", CellType::Wedge, 6, 6},
                                    {"tetrahedron", CellType::Tetra, 4, 4},
                                    {"pyramid", CellType::Pyramid, 5, 5}};
  static const CellKind other[] = {{"quadratic brick", CellType::OtherSolid, 0, 0},
                                   {"quadratic wedge", CellType::OtherSolid, 0, 0},
                                   {"quadratic tetrahedron", CellType::OtherSolid, 0, 0},
                                   {"quadratic pyramid", CellType::OtherSolid, 0, 0}};
  if (type >= 1 && type <= 3)
    return &flat[type - 1];
  if (type < 4 || type > 7)
    return nullptr;
  const CellKind& kind = linear[type - 4];
  return nodes == static_cast<std::int64_t>(kind.nodes) ? &kind : &other[type - 4];
}

class NeuFile {
public:
  NeuFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : source_(source), options_(options), report_(report), progress_(progress), in_(source) {}

  CellMesh read() {
    readControl();
    for (std::string_view line; nextHeading(line);) {
      if (contains(line, "NODAL COORDINATES"))
        readNodes();
      else if (contains(line, "ELEMENTS/CELLS"))
        readElements();
      else if (contains(line, "ELEMENT GROUP"))
        readGroup();
      else
        skipSection();
      progress_.update(static_cast<double>(in_.position()) /
                       static_cast<double>(source_.bytes.size()));
    }
    if (mesh_.points.size() != pointCount_ || cells_.size() != cellCount_)
      in_.fail("the file ends after " + std::to_string(mesh_.points.size()) + " of " +
                   std::to_string(pointCount_) + " nodes and " + std::to_string(cells_.size()) +
                   " of " + std::to_string(cellCount_) + " elements",
               kCut);
    return std::move(mesh_);
  }

  /// Reads the file up to the first solid cell.
  bool hasSolidCells() {
    kindsAlone_ = true;
    readControl();
    for (std::string_view line; !isSolid_ && nextHeading(line);) {
      if (contains(line, "ELEMENTS/CELLS"))
        readElements();
      else
        skipSection();
    }
    return isSolid_;
  }

private:
  static bool contains(std::string_view text, std::string_view part) {
    return text.find(part) != text.npos;
  }
  /// The next line that is not empty; false at the end.
  bool nextHeading(std::string_view& line) {
    do {
      if (in_.remaining() == 0)
        return false;
      line = trimmed(in_.line());
    } while (line.empty());
    return true;
  }
  void endSection() {
    std::string_view line;
    if (!nextHeading(line) || line != "ENDOFSECTION")
      in_.fail("a section does not end with ENDOFSECTION", kCut);
  }
  void skipSection() {
    std::string_view line;
    for (std::size_t n = 0; nextHeading(line); ++n) {
      if (line == "ENDOFSECTION")
        return;
      if (n % 65536 == 0)
        progress_.check();
    }
    in_.fail("a section does not end with ENDOFSECTION", kCut);
  }

  // Counts are below the line that names them.
  void readControl() {
    std::string_view line;
    do
      if (!nextHeading(line))
        in_.fail("the file has no line with NUMNP and NELEM", kCut);
    while (!contains(line, "NUMNP"));
    pointCount_ = in_.count("nodes", 6);
    cellCount_ = in_.count("elements", 6);
    checkPointCount(pointCount_, source_.path);
    for (int i = 0; i < 3; ++i) // groups, boundary conditions, coordinates
      in_.integer();
    in_.line();
    skipSection();
  }

  void readNodes() {
    if (!mesh_.points.empty())
      in_.fail("a second section of nodes", kExport);
    mesh_.points.reserve(pointCount_);
    for (std::size_t i = 0; i < pointCount_; ++i) {
      points_.add(in_.integer());
      const double x = in_.real(), y = in_.real();
      // Plane meshes have two coordinates.
      const std::string_view rest = trimmed(in_.line());
      double z = 0;
      if (!rest.empty()) {
        NumberParser last(rest, in_.path());
        z = last.real();
      }
      mesh_.points.push_back({x, y, z});
      if (i % 65536 == 0)
        progress_.check();
    }
    points_.finish();
    if (points_.duplicates() > 0)
      report_.warn("duplicate-ids", std::to_string(points_.duplicates()) +
                                        " nodes have a number that a later one has too");
    endSection();
  }

  void readElements() {
    if (mesh_.points.empty() && !kindsAlone_)
      in_.fail("elements stand before the nodes", kExport);
    if (cells_.size() > 0)
      in_.fail("a second section of elements", kExport);
    for (std::size_t i = 0; i < cellCount_; ++i) {
      const std::int64_t id = in_.integer(), type = in_.integer(), nodes = in_.integer();
      const CellKind* known = kindOf(type, nodes);
      if (known == nullptr || nodes < 1 || nodes > 27 || nodes < known->corners)
        in_.fail("element " + std::to_string(id) + " has the type " + std::to_string(type) +
                     " with " + std::to_string(nodes) + " nodes",
                 kExport);
      if (kindsAlone_) {
        isSolid_ = known->type != CellType::Flat;
        if (isSolid_)
          return;
        for (std::int64_t k = 0; k < nodes; ++k)
          in_.integer();
        continue;
      }
      CellKind kind = *known;
      // Their other nodes are between the corners in the file's order.
      if (options_.faces && ((type == 2 && nodes == 4) || (type == 3 && nodes == 3)))
        kind.kept = kind.nodes;
      for (std::int64_t k = 0; k < nodes; ++k) {
        const std::int64_t number = in_.integer();
        const std::uint32_t node = points_.find(number);
        if (node == IdMap::kNone)
          in_.fail("element " + std::to_string(id) + " refers to node " + std::to_string(number) +
                       ", which does not exist",
                   kExport);
        if (k < static_cast<std::int64_t>(kind.stored()))
          mesh_.nodes.push_back(node);
      }
      if (kind.type == CellType::Hexahedron || kind.type == CellType::Pyramid)
        orderBases(mesh_.nodes.data() + mesh_.nodes.size() - kind.nodes, kind.nodes);
      appendCells(mesh_, kind);
      cells_.add(id);
      if (i % 65536 == 0) {
        progress_.check();
        source_.release();
      }
    }
    if (!kindsAlone_)
      cells_.finish();
    endSection();
  }

  double distance(std::uint32_t a, std::uint32_t b) const {
    const Vec3d &p = mesh_.points[a], &q = mesh_.points[b];
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
  }
  /// Gambit's bricks and pyramids number their bases row by row, other programs' around them: two
  /// opposite sides of a quadrilateral together are shorter than its diagonals.
  void orderBases(std::uint32_t* nodes, std::size_t count) const {
    double around = 0, byRows = 0;
    for (const std::uint32_t* n = nodes; n + 4 <= nodes + count; n += 4) {
      around += distance(n[1], n[2]) + distance(n[3], n[0]);
      byRows += distance(n[1], n[3]) + distance(n[2], n[0]);
    }
    for (std::uint32_t* n = nodes; byRows < around && n + 4 <= nodes + count; n += 4)
      std::swap(n[2], n[3]);
  }

  void readGroup() {
    const std::string_view head = in_.line();
    const std::int64_t number = numberAfter(head, "GROUP:"), count = numberAfter(head, "ELEMENTS:"),
                       flags = numberAfter(head, "NFLAGS:");
    if (number < std::numeric_limits<std::int32_t>::min() ||
        number > std::numeric_limits<std::int32_t>::max())
      in_.fail("a group has the number " + std::to_string(number), kExport);
    const auto region = static_cast<std::int32_t>(number);
    const std::string_view name = trimmed(in_.line());
    if (!name.empty())
      mesh_.regionNames[region] = std::string(name);
    in_.checkCount(flags, "flags");
    for (std::int64_t i = 0; i < flags; ++i)
      in_.integer();
    in_.checkCount(count, "elements of a group");
    mesh_.regions.resize(cells_.size(), 0);
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t id = in_.integer();
      const std::uint32_t cell = cells_.find(id);
      if (cell == IdMap::kNone)
        in_.fail("the group '" + std::string(name) + "' has element " + std::to_string(id) +
                     ", which does not exist",
                 kExport);
      mesh_.regions[cell] = region;
      if (i % 65536 == 0)
        progress_.check();
    }
    in_.line();
    endSection();
  }
  std::int64_t numberAfter(std::string_view line, std::string_view label) const {
    const std::size_t at = line.find(label);
    NumberParser number(at == line.npos ? std::string_view() : line.substr(at + label.size()),
                        in_.path());
    std::int64_t value = 0;
    if (!number.tryInteger(value))
      in_.fail("an element group has no number after '" + std::string(label) + "'", kCut);
    return value;
  }

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  NumberParser in_;
  std::size_t pointCount_ = 0, cellCount_ = 0;
  bool kindsAlone_ = false, isSolid_ = false; ///< of hasSolidCells()
  IdMap points_, cells_;
  CellMesh mesh_;
};

} // namespace

CellMesh readNeu(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress) {
  return NeuFile(source, options, report, progress).read();
}

bool neuHasSolidCells(const Source& source, Report& report, Progress& progress) {
  const ReadOptions options;
  return NeuFile(source, options, report, progress).hasSolidCells();
}

} // namespace tetvdb
