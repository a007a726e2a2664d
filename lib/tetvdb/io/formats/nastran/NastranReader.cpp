// SPDX-License-Identifier: Apache-2.0
//
// Elements: MSC Nastran Quick Reference Guide, CHEXA, CPENTA, CPYRAM, CTETRA and the shells.
#include "tetvdb/io/formats/nastran/NastranReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/formats/nastran/CoordinateSystems.h"
#include "tetvdb/io/formats/nastran/NastranDeck.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/PathWithin.h"

#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

// The midpoints of the upper base come last, in VTK before those of the vertical edges.
constexpr std::uint8_t kHexahedron20[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,
                                          10, 11, 16, 17, 18, 19, 12, 13, 14, 15};
constexpr std::uint8_t kWedge15[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11};

/// The kind of an element with all of its nodes, and its corners.
struct ElementType {
  const char* name;
  CellKind kind;
  std::uint32_t corners;
};

const ElementType* typeOf(const std::string& name) {
  static const ElementType types[] = {
      {"CTETRA", {"CTETRA10", CellType::Tetra, 4, 10, 10}, 4},
      {"CHEXA", {"CHEXA20", CellType::Hexahedron, 8, 20, 20, kHexahedron20}, 8},
      {"CPENTA", {"CPENTA15", CellType::Wedge, 6, 15, 15, kWedge15}, 6},
      {"CPYRAM", {"CPYRAM13", CellType::Pyramid, 5, 13, 13}, 5},
      {"CPYRA", {"CPYRAM13", CellType::Pyramid, 5, 13, 13}, 5},
      {"CTRIA3", {"CTRIA", CellType::Flat, 0, 3}, 3},
      {"CTRIAR", {"CTRIA", CellType::Flat, 0, 3}, 3},
      {"CTRIA6", {"CTRIA", CellType::Flat, 0, 3}, 3},
      {"CQUAD4", {"CQUAD", CellType::Flat, 0, 4}, 4},
      {"CQUADR", {"CQUAD", CellType::Flat, 0, 4}, 4},
      {"CQUAD8", {"CQUAD", CellType::Flat, 0, 4}, 4},
      {"CQUAD", {"CQUAD", CellType::Flat, 0, 4}, 4},
      {"CSHEAR", {"CQUAD", CellType::Flat, 0, 4}, 4}};
  // meshio adds '_' to the names of quadratic elements.
  const std::string_view plain(name.data(), name.size() - (!name.empty() && name.back() == '_'));
  for (const ElementType& type : types)
    if (plain == type.name)
      return &type;
  return nullptr;
}

class NastranFile {
public:
  NastranFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : source_(source), options_(options), report_(report), progress_(progress) {}

  bool hasSolidCells() {
    bool found = false;
    forEntries(source_, 0, [&] {
      const ElementType* type = typeOf(deck_->name());
      found = type != nullptr && type->kind.type != CellType::Flat;
      return !found;
    });
    return found;
  }

  CellMesh read() {
    forEntries(source_, 0, [&] {
      const std::string& name = deck_->name();
      if (name == "GRID")
        readGrid();
      else if (const ElementType* type = typeOf(name))
        readElement(*type);
      else if (name.substr(0, 4) == "CORD")
        readSystem();
      else if (name == "GRDSET")
        defaultSystem_ = deck_->integer(2).value_or(0);
      return true;
    });
    finish();
    return std::move(mesh_);
  }

private:
  /// Calls take() for every entry of a file and of those that it includes, until it returns false.
  /// Returns whether it never did.
  template <typename Take>
  bool forEntries(const Source& source, std::size_t depth, const Take& take) {
    NastranDeck deck(source);
    for (std::size_t n = 0; deck.next(); ++n) {
      deck_ = &deck;
      if (deck.name() == "INCLUDE") {
        if (depth == kDeepestInclusion || ++included_ > kMostInclusions)
          deck.fail("too many files include one another", "put the data into one file");
        const MappedFile file(pathWithin(source.path, deck.includedFile()));
        if (!forEntries(file.source(), depth + 1, take))
          return false;
      } else if (!take()) {
        return false;
      }
      if (n % 65536 == 0) {
        progress_.check();
        if (depth == 0)
          progress_.update(static_cast<double>(deck.position()) /
                           static_cast<double>(source.bytes.size()));
        source.release();
      }
    }
    return true;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(Status::Invalid, source_.path, what, kExport);
  }

  std::int64_t number(std::size_t field, const char* thing) const {
    const auto found = deck_->integer(field);
    if (!found || *found < 1 || *found >= IdMap::kNone)
      deck_->fail(std::string("it has no ") + thing + " from 1 to 4294967294", kExport);
    return *found;
  }

  void readGrid() {
    const std::int64_t id = number(1, "number");
    const std::int64_t system = deck_->integer(2).value_or(defaultSystem_);
    checkPointCount(mesh_.points.size(), source_.path);
    if (system > 0) // -1 says the same as 0
      placed_.emplace_back(static_cast<std::uint32_t>(mesh_.points.size()), system);
    points_.add(id);
    mesh_.points.push_back({deck_->real(3), deck_->real(4), deck_->real(5)});
  }

  void readElement(const ElementType& type) {
    constexpr std::size_t firstNode = 3;
    number(1, "number");
    const std::int64_t region = deck_->integer(2).value_or(0);
    if (region < 0 || region > std::numeric_limits<std::int32_t>::max())
      deck_->fail("its property is " + std::to_string(region), kExport);
    CellKind kind = type.kind;
    if (kind.type == CellType::Flat) {
      kind.kept = options_.faces ? type.corners : 0;
    } else {
      for (std::size_t k = type.corners; k < kind.nodes; ++k)
        if (deck_->integer(firstNode + k).value_or(0) == 0) {
          kind = {type.name, kind.type, type.corners, type.corners};
          break;
        }
    }
    for (std::size_t k = 0; k < kind.stored(); ++k)
      mesh_.nodes.push_back(static_cast<std::uint32_t>(number(firstNode + k, "node")));
    orderLast(mesh_, kind);
    appendCells(mesh_, kind);
    mesh_.regions.push_back(static_cast<std::int32_t>(region));
  }

  void readSystem() {
    const std::string& name = deck_->name();
    if (name.size() != 6 || (name[4] != '1' && name[4] != '2'))
      return;
    CoordinateSystem system;
    system.kind = name[5] == 'C'   ? CoordinateKind::Cylindrical
                  : name[5] == 'S' ? CoordinateKind::Spherical
                                   : CoordinateKind::Rectangular;
    if (name[4] == '1') { // one or two of them
      for (std::size_t first = 1; first <= 5; first += 4)
        if (const auto id = deck_->integer(first)) {
          for (std::size_t k = 0; k < 3; ++k)
            system.grids[k] = number(first + 1 + k, "point");
          systems_.add(*id, system);
        }
      return;
    }
    system.reference = deck_->integer(2).value_or(0);
    for (std::size_t i = 0; i < 9; ++i)
      system.points[i / 3][i % 3] = deck_->real(3 + i);
    systems_.add(number(1, "number"), system);
  }

  void finish() {
    if (mesh_.points.empty())
      fail("there are no points (GRID)");
    points_.finish();
    if (points_.duplicates() > 0)
      report_.warn("duplicate-ids", std::to_string(points_.duplicates()) +
                                        " nodes have a number that a later one has too");
    placePoints();
    for (std::uint32_t& node : mesh_.nodes) {
      const std::uint32_t index = points_.find(node);
      if (index == IdMap::kNone)
        fail("an element refers to node " + std::to_string(node) + ", which does not exist");
      node = index;
    }
  }

  // Into the basic system. A system may be defined by points of another one.
  void placePoints() {
    if (placed_.empty())
      return;
    std::vector<std::int64_t> systemOf(mesh_.points.size(), 0);
    for (const auto& [point, system] : placed_)
      systemOf[point] = system;
    const std::vector<Vec3d> given = mesh_.points;
    CoordinateSystems::GridPosition positionOf;
    positionOf = [&](std::int64_t grid) -> std::optional<Vec3d> {
      const std::uint32_t point = points_.find(grid);
      if (point == IdMap::kNone)
        return {};
      return systems_.toBasic(systemOf[point], given[point], positionOf);
    };
    for (const auto& [point, system] : placed_) {
      const auto position = systems_.toBasic(system, given[point], positionOf);
      if (!position)
        fail("points are given in coordinate system " + std::to_string(system) +
             ", which does not exist or is not defined by three points that span a plane");
      mesh_.points[point] = *position;
    }
  }

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  const NastranDeck* deck_ = nullptr; ///< of the file that is read
  std::size_t included_ = 0;          ///< files
  CellMesh mesh_;                     ///< nodes are the file's numbers until finish()
  IdMap points_;
  CoordinateSystems systems_;
  std::int64_t defaultSystem_ = 0;
  std::vector<std::pair<std::uint32_t, std::int64_t>> placed_; ///< points in systems of their own
};

} // namespace

CellMesh readNastran(const Source& source, const ReadOptions& options, Report& report,
                     Progress& progress) {
  return NastranFile(source, options, report, progress).read();
}

bool nastranHasSolidCells(const Source& source, Report& report, Progress& progress) {
  const ReadOptions options;
  return NastranFile(source, options, report, progress).hasSolidCells();
}

} // namespace tetvdb
