// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/SplitCells.h"

#include "tetvdb/core/ClosestName.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/mesh/CurvedShape.h"
#include "tetvdb/mesh/CutQuadratic.h"
#include "tetvdb/mesh/SplitByShape.h"
#include "tetvdb/mesh/SplitPolyhedron.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint64_t kMaxTets = 0xfffffffeU;
constexpr std::size_t kCellsPerUpdate = std::size_t(1) << 18;

bool isFiltered(const CellFilter& filter) {
  bool boxed = false;
  for (std::size_t k = 0; k < 3; ++k)
    boxed = boxed || !(filter.boxMin[k] == -std::numeric_limits<double>::infinity()) ||
            !(filter.boxMax[k] == std::numeric_limits<double>::infinity());
  return boxed || !filter.regions.empty() || !filter.exclude.empty();
}

std::string inQuotes(const std::string& text) {
  return "'" + text + "'";
}

/// "1 'steel', 4, 7" of at most a dozen regions.
std::string listRegions(const std::set<std::int32_t>& regions,
                        const std::map<std::int32_t, std::string>& names) {
  std::string text;
  std::size_t n = 0;
  for (const std::int32_t region : regions) {
    if (!text.empty())
      text += ", ";
    if (++n > 12)
      return text + "...";
    text += std::to_string(region);
    if (const auto name = names.find(region); name != names.end())
      text += " " + inQuotes(name->second);
  }
  return text;
}

std::vector<std::string> regionNames(const std::map<std::int32_t, std::string>& names) {
  std::vector<std::string> list;
  for (const auto& [number, name] : names)
    list.push_back(name);
  return list;
}

/// Region numbers that `wanted` names. Throws Error(Usage) for one that is not in the mesh.
std::set<std::int32_t> findRegions(const std::vector<std::string>& wanted, const char* option,
                                   const std::set<std::int32_t>& present,
                                   const std::map<std::int32_t, std::string>& names,
                                   Report& report) {
  std::set<std::int32_t> found;
  for (const std::string& text : wanted) {
    bool known = false;
    for (const auto& [number, name] : names)
      if (name == text) {
        known = true;
        found.insert(number);
        if (present.count(number) == 0)
          report.warn("empty-region", std::string(option) + " " + inQuotes(text) +
                                          " names a region that has no solid cells");
      }
    std::int32_t number = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, number);
    if (!known && error == std::errc() && stop == end && present.count(number) != 0) {
      known = true;
      found.insert(number);
    }
    if (known)
      continue;
    throw Error(Status::Usage, option, "the mesh has no region " + inQuotes(text),
                suggestName(text, regionNames(names),
                            present.empty() ? "it has no regions at all"
                                            : "its regions are " + listRegions(present, names)));
  }
  return found;
}

/// Decides for every cell whether it is kept.
class Chooser {
public:
  Chooser(const CellMesh& mesh, const CellFilter& filter, Report& report)
      : mesh_(mesh), filter_(filter), active_(isFiltered(filter)) {
    if (filter.regions.empty() && filter.exclude.empty())
      return;
    std::set<std::int32_t> present;
    std::size_t cell = 0;
    for (const CellRun& run : mesh.runs) {
      if (run.type != CellType::Flat && !mesh.regions.empty())
        for (std::size_t i = 0; i < run.count; ++i)
          if (i == 0 || mesh.regions[cell + i] != mesh.regions[cell + i - 1])
            present.insert(mesh.regions[cell + i]);
      cell += run.count;
    }
    const auto& names = mesh.regionNames;
    const auto excluded = findRegions(filter.exclude, "`exclude`", present, names, report);
    kept_ = findRegions(filter.regions, "`region`", present, names, report);
    if (filter.regions.empty())
      kept_ = present;
    for (const std::int32_t region : excluded)
      kept_.erase(region);
    byRegion_ = true;
  }

  bool active() const { return active_; }

  bool keeps(std::size_t cell, const std::uint32_t* nodes, std::size_t count) const {
    if (!active_)
      return true;
    if (byRegion_ && kept_.count(mesh_.regions[cell]) == 0)
      return false;
    for (std::size_t k = 0; k < 3; ++k) {
      double low = std::numeric_limits<double>::infinity();
      double high = -low;
      for (std::size_t i = 0; i < count; ++i) {
        low = std::min(low, mesh_.points[nodes[i]][k]);
        high = std::max(high, mesh_.points[nodes[i]][k]);
      }
      if (high < filter_.boxMin[k] || low > filter_.boxMax[k])
        return false;
    }
    return true;
  }

private:
  const CellMesh& mesh_;
  const CellFilter& filter_;
  std::set<std::int32_t> kept_;
  bool active_;
  bool byRegion_ = false;
};

/// Removes the elements of Flat runs from an array with `components` numbers a cell.
template <class T>
void removeFlat(std::vector<T>& values, std::size_t components, const std::vector<CellRun>& runs) {
  std::size_t from = 0;
  std::size_t to = 0;
  for (const CellRun& run : runs) {
    const std::size_t n = run.count * components;
    if (run.type != CellType::Flat) {
      if (from != to)
        std::copy(values.begin() + static_cast<std::ptrdiff_t>(from),
                  values.begin() + static_cast<std::ptrdiff_t>(from + n),
                  values.begin() + static_cast<std::ptrdiff_t>(to));
      to += n;
    }
    from += n;
  }
  values.resize(to);
}

void keepSolidValues(CellMesh& mesh, TetMesh& result) {
  const std::size_t cells = mesh.cellCount();
  for (Attribute& attribute : mesh.attributes)
    if (attribute.on == Attribute::On::Cells) {
      if (attribute.size() != cells)
        throw Error(Status::Invalid, "cell array " + inQuotes(attribute.name),
                    "has " + std::to_string(attribute.size()) + " values for " +
                        std::to_string(cells) + " cells");
      std::visit([&](auto& values) { removeFlat(values, attribute.components, mesh.runs); },
                 attribute.values);
    }
  if (!mesh.regions.empty())
    removeFlat(mesh.regions, 1, mesh.runs);
  result.attributes = std::move(mesh.attributes);
  result.unread = std::move(mesh.unread);
  result.regions = std::move(mesh.regions);
  result.regionNames = std::move(mesh.regionNames);
}

/// Cells that need a warning.
struct Tally {
  std::map<std::string, std::size_t> skipped; ///< by the file's name of the kind
  std::size_t quadratic = 0;
  std::size_t concave = 0;
  bool filtered = false; ///< some cell was left out by the filter
};

void tell(const Tally& tally, Report& report) {
  std::size_t skipped = 0;
  std::string kinds;
  for (const auto& [kind, count] : tally.skipped) {
    skipped += count;
    kinds += (kinds.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
  }
  if (skipped > 0) {
    report.partial = true;
    report.warn("skipped-cells", std::to_string(skipped) +
                                     " solid cells could not be split into tetrahedra and leave "
                                     "holes (" +
                                     kinds + ")");
  }
  if (tally.quadratic > 0)
    report.warn("quadratic-cells", std::to_string(tally.quadratic) +
                                       " curved cells of higher order were taken by their corners, "
                                       "with straight edges");
  warnConcave(tally.concave, report);
}

// Whether values at points can be asked for.
bool hasPointArrays(const CellMesh& mesh) {
  return std::any_of(
      mesh.attributes.begin(), mesh.attributes.end(),
      [](const Attribute& attribute) { return attribute.on == Attribute::On::Points; });
}

// Adds a linear cell to `curved`, where `tets` are its own and follow `before` others.
void addLinear(const LinearCell& cell, std::size_t before, const std::vector<std::uint32_t>& tets,
               CurvedCells& curved) {
  const auto number = static_cast<std::uint32_t>(curved.cells.size());
  curved.cells.push_back({curved.nodes.size(), cell.shape()});
  curved.nodes.insert(curved.nodes.end(), cell.begin(), cell.end());
  curved.cellOfTet.resize(before, CurvedCells::kLinear);
  curved.corners.resize(before);
  for (std::size_t t = before; t < tets.size() / 4; ++t) {
    curved.cellOfTet.push_back(number);
    curved.corners.push_back(cell.placesOf(tets.data() + 4 * t));
  }
}

bool holdsOnlyTets(const std::vector<CellRun>& runs) {
  return std::all_of(runs.begin(), runs.end(), [](const CellRun& run) {
    return run.type == CellType::Tetra || run.type == CellType::Flat || run.count == 0;
  });
}

// Whether all solid cells are quadratic ones that kept their nodes: next to others these would
// leave gaps, where a curved face meets a flat one.
bool holdsOnlyCurved(const std::vector<CellRun>& runs) {
  return std::all_of(runs.begin(), runs.end(), [](const CellRun& run) {
    return run.type == CellType::Flat || run.count == 0 ||
           curvedShape(run.type, run.nodesPerCell).has_value();
  });
}

// The tets of a mesh of quadratic cells.
void cutCurved(CellMesh& mesh, const Chooser& chooser, TetMesh& result, Tally& tally,
               Progress& progress) {
  const std::uint32_t* nodes = mesh.nodes.data();
  std::size_t cell = 0;
  std::uint32_t own = 0;
  CurvedCells& curved = result.curved;
  QuadraticCutter cutter(mesh.points);
  for (const CellRun& run : mesh.runs) {
    const std::size_t each = run.nodesPerCell;
    if (run.type == CellType::Flat || run.count == 0) {
      nodes += each * run.count;
      cell += run.count;
      continue;
    }
    const CurvedShape shape = *curvedShape(run.type, each);
    for (std::size_t i = 0; i < run.count; ++i, ++cell, ++own, nodes += each) {
      if (i % kCellsPerUpdate == 0)
        progress.update(static_cast<double>(own) / static_cast<double>(result.cellCount));
      if (!chooser.keeps(cell, nodes, each)) {
        tally.filtered = true;
        continue;
      }
      const auto number = static_cast<std::uint32_t>(curved.cells.size());
      curved.cells.push_back({curved.nodes.size(), shape});
      curved.nodes.insert(curved.nodes.end(), nodes, nodes + each);
      if (cutter.cut(shape, nodes, result.tets, curved.corners))
        ++tally.concave;
      curved.cellOfTet.resize(result.tetCount(), number);
      result.cellOfTet.resize(result.tetCount(), own);
    }
  }
  for (Attribute& array : mesh.attributes)
    if (array.on == Attribute::On::Points)
      cutter.addValues(array);
}

void refuseAbove(std::uint64_t count) { // of tets, or of points
  if (count > kMaxTets)
    throw Error(Status::Limit, "mesh", "more than 4294967294 tetrahedra or points",
                "split it into several files or choose a part with `bbox` or `region`");
}

std::uint64_t solidCells(const std::vector<CellRun>& runs) {
  std::uint64_t solid = 0;
  for (const CellRun& run : runs)
    if (run.type != CellType::Flat)
      solid += run.count;
  return solid;
}

// The tets of all solid cells; of polyhedra one each.
std::uint64_t expectedTets(const std::vector<CellRun>& runs, bool curved) {
  std::uint64_t tets = 0;
  for (const CellRun& run : runs) {
    if (run.type == CellType::Flat || run.count == 0)
      continue;
    const CellShape* shape = shapeOf(run.type);
    tets += run.count * (curved             ? tetsOf(*curvedShape(run.type, run.nodesPerCell))
                         : shape != nullptr ? static_cast<std::uint64_t>(shape->tets)
                                            : 1);
  }
  return tets;
}

// The tets of a mesh of tets alone; those that are kept move down within the mesh's own nodes.
void keepTets(CellMesh& mesh, const Chooser& chooser, TetMesh& result, Tally& tally,
              Progress& progress) {
  std::vector<std::uint32_t>& nodes = mesh.nodes;
  std::size_t from = 0, to = 0, cell = 0; // cell: number in the file
  std::uint32_t own = 0;                  // number among the solid cells
  for (const CellRun& run : mesh.runs) {
    const std::size_t each = run.nodesPerCell;
    if (run.type == CellType::Flat) {
      from += each * run.count;
      cell += run.count;
      continue;
    }
    if (run.quadratic)
      tally.quadratic += run.count;
    if (!chooser.active() && each == 4 && from == to) {
      from = to += 4 * run.count;
      cell += run.count;
      own += static_cast<std::uint32_t>(run.count);
      continue;
    }
    for (std::size_t i = 0; i < run.count; ++i, ++cell, ++own, from += each) {
      if (i % kCellsPerUpdate == 0)
        progress.update(static_cast<double>(own) / static_cast<double>(result.cellCount));
      const std::uint32_t* corner = nodes.data() + from;
      if (!chooser.keeps(cell, corner, 4)) {
        tally.filtered = true;
        continue;
      }
      std::copy(corner, corner + 4, nodes.data() + to);
      to += 4;
      if (chooser.active())
        result.cellOfTet.push_back(own);
    }
  }
  nodes.resize(to);
  result.tets = std::move(nodes);
}

// Adds the tets of a cell. False where the filter leaves it out.
bool splitCell(CellMesh& mesh, const CellRun& run, std::size_t cell, const std::uint32_t* corner,
               const Chooser& chooser, bool shaped, TetMesh& result, PolyhedronCutter& cutter,
               Tally& tally) {
  std::vector<std::uint32_t>& made = result.tets;
  if (run.type == CellType::Tetra) {
    if (!chooser.keeps(cell, corner, 4))
      return false;
    made.insert(made.end(), corner, corner + 4);
  } else if (const CellShape* shape = shapeOf(run.type)) {
    if (!chooser.keeps(cell, corner, static_cast<std::size_t>(shape->corners)))
      return false;
    const std::size_t before = made.size();
    if (splitByShape(*shape, corner, mesh.points.data(), made))
      ++tally.concave;
    const std::optional<CurvedShape> kind = shaped ? cornerShape(run.type) : std::nullopt;
    if (kind && made.size() > before)
      addLinear({*kind, run.type, corner}, before / 4, made, result.curved);
  } else if (run.type == CellType::Polyhedron) {
    const auto faces = polyhedronFaces(corner, run.nodesPerCell);
    if (!chooser.keeps(cell, faces.nodes.data(), faces.nodes.size()))
      return false;
    const PolyhedronCut cut = cutter.cut(faces, made);
    if (cut == PolyhedronCut::None)
      ++tally.skipped[run.fileType];
    if (cut == PolyhedronCut::Concave)
      ++tally.concave;
  } else {
    ++tally.skipped[run.fileType];
  }
  return true;
}

// The tets of a mesh of several kinds of cells.
void splitRuns(CellMesh& mesh, const Chooser& chooser, TetMesh& result, Tally& tally,
               Progress& progress) {
  const bool shaped = hasPointArrays(mesh);
  PolyhedronCutter cutter(mesh.points);
  const std::uint32_t* corner = mesh.nodes.data();
  std::size_t cell = 0;
  std::uint32_t own = 0;
  for (const CellRun& run : mesh.runs) {
    const std::size_t each = run.nodesPerCell;
    if (run.type == CellType::Flat) {
      corner += each * run.count;
      cell += run.count;
      continue;
    }
    if (run.quadratic)
      tally.quadratic += run.count;
    for (std::size_t i = 0; i < run.count; ++i, ++cell, ++own, corner += each) {
      if (i % kCellsPerUpdate == 0)
        progress.update(static_cast<double>(own) / static_cast<double>(result.cellCount));
      if (!splitCell(mesh, run, cell, corner, chooser, shaped, result, cutter, tally))
        tally.filtered = true;
      refuseAbove(result.tetCount());
      refuseAbove(mesh.points.size());
      result.cellOfTet.resize(result.tetCount(), own);
    }
  }
  for (Attribute& array : mesh.attributes)
    if (array.on == Attribute::On::Points)
      cutter.addValues(array);
}

} // namespace

std::string describeCells(const CellMesh& mesh) {
  std::vector<std::pair<std::string, std::size_t>> kinds;
  for (const CellRun& run : mesh.runs) {
    if (run.count == 0)
      continue;
    const auto known = std::find_if(kinds.begin(), kinds.end(),
                                    [&](const auto& kind) { return kind.first == run.fileType; });
    if (known == kinds.end())
      kinds.emplace_back(run.fileType, run.count);
    else
      known->second += run.count;
  }
  std::string text;
  for (auto [kind, count] : kinds) {
    // "694 triangles" and "694 vertices", but "694 tetra" and "694 triangle6".
    if (count != 1 && kind.size() > 2 && kind.compare(kind.size() - 2, 2, "ex") == 0)
      kind.replace(kind.size() - 2, 2, "ices");
    else if (count != 1 && !kind.empty() && kind.back() != 's' && kind.back() != 'a' &&
             std::isalpha(static_cast<unsigned char>(kind.back())) != 0)
      kind += 's';
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
  }
  return text.empty() ? "no cells" : text;
}

TetMesh splitCells(CellMesh&& mesh, const CellFilter& filter, Report& report, Progress& progress) {
  const std::uint64_t solid = solidCells(mesh.runs);
  if (solid == 0)
    throw Error(Status::Invalid, "mesh",
                "no tetrahedra or other solid cells; it holds " + describeCells(mesh));
  refuseAbove(solid);
  const bool curved = holdsOnlyCurved(mesh.runs);
  const std::uint64_t expected = expectedTets(mesh.runs, curved);
  const Chooser chooser(mesh, filter, report);
  if (!chooser.active())
    refuseAbove(expected);
  TetMesh result;
  result.cellCount = static_cast<std::size_t>(solid);
  Tally tally;
  if (!curved && holdsOnlyTets(mesh.runs)) {
    keepTets(mesh, chooser, result, tally, progress);
  } else {
    if (!chooser.active())
      result.tets.reserve(static_cast<std::size_t>(expected) * 4);
    if (curved)
      cutCurved(mesh, chooser, result, tally, progress);
    else
      splitRuns(mesh, chooser, result, tally, progress);
    refuseAbove(result.tetCount());
    mesh.nodes = {};
  }
  if (!result.curved.empty()) {
    result.curved.cellOfTet.resize(result.tetCount(), CurvedCells::kLinear);
    result.curved.corners.resize(result.tetCount());
  }
  tell(tally, report);
  if (result.tets.empty())
    throw Error(Status::Invalid, "mesh",
                tally.filtered
                    ? "no cell is left by `region`, `exclude` and `bbox`"
                    : "no solid cell can be split into tetrahedra; it holds " + describeCells(mesh),
                tally.filtered ? "widen them" : "");
  keepSolidValues(mesh, result);
  result.points = std::move(mesh.points);
  return result;
}

} // namespace tetvdb
