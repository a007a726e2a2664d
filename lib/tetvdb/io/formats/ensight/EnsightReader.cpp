// SPDX-License-Identifier: Apache-2.0
//
// The format: EnSight User Manual, chapter 11, "EnSight Gold Geometry File Format" and "EnSight
// Gold Variable File Format".
#include "tetvdb/io/formats/ensight/EnsightReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/cells/StructuredBlock.h"
#include "tetvdb/io/formats/ensight/EnsightCase.h"
#include "tetvdb/io/formats/ensight/EnsightInput.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/TimeStep.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {
namespace ensight {
namespace {

/// The element type of a name, without the "g_" of ghosts; null for unknown names.
const CellKind* kindOf(const std::string& name) {
  static const CellKind kinds[] = {
      {"point", CellType::Flat, 0, 1},
      {"bar2", CellType::Flat, 0, 2},
      {"bar3", CellType::Flat, 0, 3},
      {"tria3", CellType::Flat, 0, 3},
      {"tria6", CellType::Flat, 0, 6},
      {"quad4", CellType::Flat, 0, 4},
      {"quad8", CellType::Flat, 0, 8},
      {"tetra4", CellType::Tetra, 4, 4},
      {"tetra10", CellType::Tetra, 4, 10, keptNodes(CellType::Tetra, 10)},
      {"pyramid5", CellType::Pyramid, 5, 5},
      {"pyramid13", CellType::Pyramid, 5, 13, keptNodes(CellType::Pyramid, 13)},
      {"penta6", CellType::Wedge, 6, 6},
      {"penta15", CellType::Wedge, 6, 15, keptNodes(CellType::Wedge, 15)},
      {"hexa8", CellType::Hexahedron, 8, 8},
      {"hexa20", CellType::Hexahedron, 8, 20, keptNodes(CellType::Hexahedron, 20)}};
  for (const CellKind& kind : kinds)
    if (name == kind.name)
      return &kind;
  return nullptr;
}

/// The first word of a keyword line: "coordinates" of "coordinates partial".
std::string firstWord(const std::string& line) {
  return line.substr(0, line.find(' '));
}

struct Section {
  std::string type; ///< as in the file: "tetra4", "block"
  std::size_t first = 0, count = 0;
};

struct Part {
  std::size_t firstPoint = 0, points = 0;
  std::vector<Section> sections; ///< cells
};

class Geometry {
public:
  /// `step`: of a file that holds several, from 0 on.
  Geometry(const Source& source, std::optional<std::size_t> step, const ReadOptions& options,
           Progress& progress)
      : source_(source), options_(options), progress_(progress), in_(source, step) {}

  void read() {
    in_.line();
    in_.line();
    nodeIds_ = hasIds("node id");
    elementIds_ = hasIds("element id");
    std::string word = in_.atEnd() ? std::string() : in_.keyword();
    if (word == "extents") {
      in_.skipReals(6);
      word = in_.keyword();
    }
    while (!word.empty()) {
      if (word != "part")
        in_.fail("expected 'part', found '" + word + "'", kCut);
      word = readPart();
      source_.release();
      progress_.check();
    }
    if (mesh.points.empty() && !kindsAlone_)
      in_.fail("the geometry has no nodes", kCut);
  }

  /// Reads up to the first section of solid cells, without keeping the mesh.
  bool hasSolidCells() {
    kindsAlone_ = true;
    read();
    return isSolid_;
  }

  bool isBinary() const { return in_.isBinary(); }

  CellMesh mesh;
  std::map<std::int64_t, Part> parts;

private:
  bool hasIds(const std::string& what) {
    const std::string line = in_.keyword();
    if (line.rfind(what, 0) != 0)
      in_.fail("expected '" + what + "', found '" + line + "'", kExport);
    const std::string how = line.substr(std::min(line.size(), line.find_last_of(' ') + 1));
    return how == "given" || how == "ignore";
  }

  /// The keyword after the part; "" at the end.
  std::string readPart() {
    const std::int64_t number = in_.partNumber();
    const std::string name = in_.line();
    if (number < 1 || number > std::numeric_limits<std::int32_t>::max())
      in_.fail("a part has the number " + std::to_string(number), kCut);
    const auto [found, isNew] = parts.emplace(number, Part{});
    if (!isNew)
      in_.fail("a second part " + std::to_string(number), kExport);
    Part& part = found->second;
    part.firstPoint = mesh.points.size();
    if (!name.empty())
      mesh.regionNames[static_cast<std::int32_t>(number)] = name;
    std::string word = in_.keyword();
    const std::string kind = firstWord(word);
    if (kind == "coordinates")
      readCoordinates(part);
    else if (kind == "block")
      readBlock(part, word);
    else
      in_.fail("expected 'coordinates' or 'block', found '" + word + "'", kCut);
    while (!isSolid_ && !in_.atEnd()) {
      word = in_.keyword();
      if (word == "part")
        break;
      readElements(part, word);
      progress_.check();
    }
    mesh.regions.resize(cells_, static_cast<std::int32_t>(number));
    return word == "part" ? word : std::string();
  }

  void readCoordinates(Part& part) {
    part.points = in_.count("nodes", 3);
    if (nodeIds_)
      in_.integers(part.points);
    readPoints(part);
  }
  void readPoints(Part& part) {
    if (kindsAlone_)
      return in_.skipReals(3 * part.points);
    checkPointCount(mesh.points.size() + part.points, source_.path);
    std::vector<float> values(part.points);
    mesh.points.resize(mesh.points.size() + part.points, Vec3d{});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      in_.reals(values.data(), values.size());
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i]))
          in_.fail("a coordinate of node " + std::to_string(i + 1) + " is not finite", kExport);
        mesh.points[part.firstPoint + i][axis] = double(values[i]);
      }
    }
  }

  /// Hexahedra, which follow from their points.
  void readBlock(Part& part, const std::string& line) {
    const bool uniform = line == "block uniform", rectilinear = line == "block rectilinear";
    if (!uniform && !rectilinear && line != "block" && line != "block curvilinear")
      in_.fail("a part is a '" + line + "', which is not read",
               "write it as unstructured elements or as a block without blanked nodes and ghosts");
    const std::vector<std::int64_t> n = in_.integers(3);
    BlockSize size{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (n[k] < 1 || n[k] > std::numeric_limits<std::int32_t>::max())
        in_.fail("a block has " + std::to_string(n[k]) + " nodes along a side", kCut);
      size[k] = static_cast<std::size_t>(n[k]);
    }
    const bool straight = uniform || rectilinear;
    part.points = blockPoints(
        size, straight ? maxRectilinearPoints(source_.bytes.size()) : source_.bytes.size(),
        source_.path);
    if (straight)
      readAxes(part, size, uniform);
    else
      readPoints(part);
    if (kindsAlone_) {
      isSolid_ = isSolidBlock(size);
      return;
    }
    const std::size_t count = appendBlock(mesh, size, part.firstPoint, options_.faces);
    part.sections.push_back({"block", cells_, count});
    cells_ += count;
  }

  /// The coordinates of points along each axis or, `uniform`, the first point and the steps.
  void readAxes(const Part& part, const BlockSize& size, bool uniform) {
    float first[3], step[3];
    if (uniform) {
      in_.reals(first, 3);
      in_.reals(step, 3);
    }
    std::array<std::vector<double>, 3> along;
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<float> values(size[k]);
      if (!uniform)
        in_.reals(values.data(), values.size());
      for (std::size_t i = 0; i < size[k]; ++i)
        along[k].push_back(uniform ? double(first[k]) + double(i) * double(step[k])
                                   : double(values[i]));
    }
    checkPointCount(mesh.points.size() + part.points, source_.path);
    const std::vector<Vec3d> points = rectilinearPoints(along, source_.bytes.size(), source_.path);
    mesh.points.insert(mesh.points.end(), points.begin(), points.end());
  }

  // --- elements ---

  void addCells(Part& part, const std::string& type, const CellKind& kind, std::size_t count) {
    part.sections.push_back({type, cells_, count});
    appendCells(mesh, kind, count);
    cells_ += count;
  }
  std::uint32_t pointOf(const Part& part, std::int64_t node) const {
    if (node < 1 || static_cast<std::uint64_t>(node) > part.points)
      in_.fail("an element refers to node " + std::to_string(node) + ", but its part has " +
                   std::to_string(part.points) + " nodes, numbered from 1",
               kExport);
    return static_cast<std::uint32_t>(part.firstPoint + static_cast<std::size_t>(node) - 1);
  }

  void readElements(Part& part, const std::string& type) {
    const bool ghost = type.rfind("g_", 0) == 0;
    const std::string name = ghost ? type.substr(2) : type;
    const CellKind* known = kindOf(name);
    const bool polygons = name == "nsided", polyhedra = name == "nfaced";
    if (known == nullptr && !polygons && !polyhedra)
      in_.fail("unknown element type '" + type + "'", kCut);
    const std::size_t count = in_.count("elements", known != nullptr ? known->nodes : 1);
    if (kindsAlone_ && !ghost && count > 0 &&
        (polyhedra || (known != nullptr && known->type != CellType::Flat))) {
      isSolid_ = true;
      return;
    }
    if (elementIds_)
      in_.integers(count);
    if (polygons)
      return readPolygons(part, type, count, ghost);
    if (polyhedra)
      return readPolyhedra(part, type, count, ghost);
    const std::vector<std::int64_t> nodes = in_.integers(count * known->nodes);
    CellKind kind = *known;
    if (options_.faces && (name == "tria3" || name == "tria6"))
      kind.kept = 3;
    if (options_.faces && (name == "quad4" || name == "quad8"))
      kind.kept = 4;
    if (ghost)
      kind = {"ghost", CellType::Flat, 0, known->nodes};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const std::uint32_t point = pointOf(part, nodes[i]);
      if (i % known->nodes < kind.stored())
        mesh.nodes.push_back(point);
    }
    addCells(part, type, kind, count);
  }

  void readPolygons(Part& part, const std::string& type, std::size_t count, bool ghost) {
    const std::vector<std::int64_t> sizes = in_.integers(count);
    part.sections.push_back({type, cells_, count});
    for (const std::int64_t size : sizes) {
      if (size < 1)
        in_.fail("a polygon has " + std::to_string(size) + " nodes", kCut);
      const auto n = static_cast<std::size_t>(size);
      const bool kept = options_.faces && !ghost && n <= 0xffffffff;
      for (const std::int64_t node : in_.integers(n)) {
        const std::uint32_t point = pointOf(part, node);
        if (kept)
          mesh.nodes.push_back(point);
      }
      addRun("nsided", CellType::Flat, kept ? static_cast<std::uint32_t>(n) : 0);
    }
  }
  /// Adds a cell to the last run if possible.
  void addRun(const char* name, CellType type, std::uint32_t nodes) {
    if (mesh.runs.empty() || mesh.runs.back().fileType != name ||
        mesh.runs.back().nodesPerCell != nodes)
      mesh.runs.push_back({type, nodes, 0, name, false});
    ++mesh.runs.back().count;
    ++cells_;
  }

  // Faces of each element, then nodes of each face, then the nodes.
  void readPolyhedra(Part& part, const std::string& type, std::size_t count, bool ghost) {
    const std::vector<std::int64_t> faceCounts = in_.integers(count);
    std::size_t faces = 0;
    for (const std::int64_t n : faceCounts) {
      if (n < 0 || static_cast<std::uint64_t>(n) > source_.bytes.size() ||
          (faces += static_cast<std::size_t>(n)) > source_.bytes.size())
        in_.fail("a polyhedron has " + std::to_string(n) + " faces", kCut);
    }
    const std::vector<std::int64_t> sizes = in_.integers(faces);
    part.sections.push_back({type, cells_, count});
    std::size_t face = 0;
    for (const std::int64_t n : faceCounts) {
      const std::size_t before = mesh.nodes.size();
      mesh.nodes.push_back(static_cast<std::uint32_t>(n));
      for (std::int64_t i = 0; i < n; ++i) {
        const std::int64_t size = sizes[face++];
        if (size < 3 || size > 0xffff)
          in_.fail("a face of a polyhedron has " + std::to_string(size) + " nodes", kCut);
        mesh.nodes.push_back(static_cast<std::uint32_t>(size));
        for (const std::int64_t node : in_.integers(static_cast<std::size_t>(size)))
          mesh.nodes.push_back(pointOf(part, node));
      }
      if (ghost || n == 0)
        mesh.nodes.resize(before);
      if (ghost || n == 0)
        addRun("ghost", CellType::Flat, 0);
      else
        addRun("nfaced", CellType::Polyhedron,
               static_cast<std::uint32_t>(mesh.nodes.size() - before));
    }
  }

  const Source& source_;
  const ReadOptions& options_;
  Progress& progress_;
  Input in_;
  bool nodeIds_ = false, elementIds_ = false;
  bool kindsAlone_ = false, isSolid_ = false;
  std::size_t cells_ = 0;
};

/// One variable's file: values of parts, at nodes or elements.
class VariableFile {
public:
  VariableFile(const Source& source, std::optional<std::size_t> step, const Variable& variable,
               const Geometry& geometry, Progress& progress)
      : variable_(variable), geometry_(geometry), progress_(progress),
        in_(source, geometry.isBinary(), step) {}

  Attribute read() {
    const std::size_t elements =
        variable_.onElements ? geometry_.mesh.cellCount() : geometry_.mesh.points.size();
    values_.assign(elements * variable_.components, std::numeric_limits<float>::quiet_NaN());
    in_.line();
    std::string word = in_.atEnd() ? std::string() : in_.keyword();
    while (!word.empty()) {
      if (word != "part")
        in_.fail("expected 'part', found '" + word + "'", kCut);
      word = readPart();
      progress_.check();
    }
    return {variable_.name, variable_.onElements ? Attribute::On::Cells : Attribute::On::Points,
            variable_.components, std::move(values_)};
  }

private:
  std::string readPart() {
    const std::int64_t number = in_.partNumber();
    const auto found = geometry_.parts.find(number);
    if (found == geometry_.parts.end())
      in_.fail("has values for part " + std::to_string(number) + ", which does not exist", kExport);
    const Part& part = found->second;
    while (!in_.atEnd()) {
      const std::string word = in_.keyword();
      if (word == "part")
        return word;
      const std::string type = firstWord(word);
      const std::string how = word.size() > type.size() ? word.substr(type.size() + 1) : "";
      if (!variable_.onElements) {
        if (type != "coordinates" && type != "block")
          in_.fail("expected 'coordinates', found '" + word + "'", kCut);
        readSection(how, part.firstPoint, part.points);
        continue;
      }
      const auto section = std::find_if(part.sections.begin(), part.sections.end(),
                                        [&](const Section& one) { return one.type == type; });
      if (section == part.sections.end())
        in_.fail("has values for elements '" + word + "', which part " + std::to_string(number) +
                     " has not",
                 kExport);
      readSection(how, section->first, section->count);
    }
    return {};
  }

  // Components one after the other; "undef" is followed by the value that represents missing
  // values, "partial" by the indices that have values.
  void readSection(const std::string& how, std::size_t first, std::size_t count) {
    float undefined = std::numeric_limits<float>::quiet_NaN();
    std::vector<std::int64_t> places;
    if (how == "undef") {
      in_.reals(&undefined, 1);
    } else if (how == "partial") {
      places = in_.integers(in_.count("values"));
      for (const std::int64_t place : places)
        if (place < 1 || static_cast<std::uint64_t>(place) > count)
          in_.fail("a partial variable has a value for element " + std::to_string(place), kCut);
    } else if (!how.empty()) {
      in_.fail("unknown word '" + how + "'", kExport);
    }
    const std::size_t n = how == "partial" ? places.size() : count;
    // Asymmetric tensors are stored by rows like VTK's.
    std::vector<float> numbers(n);
    for (std::uint32_t c = 0; c < variable_.components; ++c) {
      in_.reals(numbers.data(), n);
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t place = places.empty() ? i : static_cast<std::size_t>(places[i]) - 1;
        values_[(first + place) * variable_.components + componentOf(c)] =
            numbers[i] == undefined ? std::numeric_limits<float>::quiet_NaN() : numbers[i];
      }
    }
  }
  /// EnSight's symmetric tensors are xx, yy, zz, xy, xz, yz; ours xx, yy, zz, xy, yz, xz.
  std::uint32_t componentOf(std::uint32_t c) const {
    return variable_.components == 6 && c >= 4 ? 9 - c : c;
  }

  const Variable& variable_;
  const Geometry& geometry_;
  Progress& progress_;
  Input in_;
  std::vector<float> values_;
};

} // namespace

CellMesh readGeometry(const Source& source, const ReadOptions& options, Progress& progress) {
  Geometry geometry(source, {}, options, progress);
  geometry.read();
  return std::move(geometry.mesh);
}

} // namespace ensight

CellMesh readEnsight(const Source& source, const ReadOptions& options, Report& report,
                     Progress& progress) {
  using namespace ensight;
  const Case theCase = parseCase(source);
  for (const std::string& kind : theCase.otherVariables)
    if (options.attributes)
      report.warn("array-left-out", "a variable is left out: '" + kind + "' is not read");
  std::vector<double> times = theCase.times();
  const std::size_t step = chosenStep(times.size(), options.timeStep, source.path).value_or(0);
  const StepPlace place = theCase.placeOf(theCase.geometry, step, source.path);
  const MappedFile file(place.path);
  const Source bytes = file.source();
  Geometry geometry(bytes, place.number, options, progress);
  geometry.read();
  progress.update(0.5);
  for (const Variable& variable : theCase.variables) {
    const auto on = variable.onElements ? Attribute::On::Cells : Attribute::On::Points;
    if (!options.wants(variable.name) && variable.name != options.regionArray) {
      if (options.attributes)
        geometry.mesh.unread.push_back({variable.name, on, variable.components});
      continue;
    }
    const StepPlace there = theCase.placeOf(variable.file, step, source.path);
    const MappedFile values(there.path);
    geometry.mesh.attributes.push_back(
        VariableFile(values.source(), there.number, variable, geometry, progress).read());
  }
  geometry.mesh.times = std::move(times);
  return std::move(geometry.mesh);
}

bool ensightHasSolidCells(const Source& source, Report&, Progress& progress) {
  using namespace ensight;
  const Case theCase = parseCase(source);
  const StepPlace place =
      theCase.placeOf(theCase.geometry,
                      chosenStep(theCase.times().size(), -1, source.path).value_or(0), source.path);
  const MappedFile file(place.path);
  const Source bytes = file.source();
  const ReadOptions options;
  return Geometry(bytes, place.number, options, progress).hasSolidCells();
}

std::vector<std::string> ensightFiles(const Source& source, int timeStep) {
  using namespace ensight;
  const Case theCase = parseCase(source);
  const std::size_t step = chosenStep(theCase.times().size(), timeStep, source.path).value_or(0);
  std::vector<std::string> files{theCase.placeOf(theCase.geometry, step, source.path).path};
  for (const Variable& variable : theCase.variables)
    files.push_back(theCase.placeOf(variable.file, step, source.path).path);
  return files;
}

std::vector<double> ensightTimes(const Source& source, Report&, Progress&) {
  return ensight::parseCase(source).times();
}

} // namespace tetvdb
