// SPDX-License-Identifier: Apache-2.0
//
// The format: "CFD General Notation System, Standard Interface Data Structures" (SIDS).
#include "tetvdb/io/formats/cgns/CgnsReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/cells/StructuredBlock.h"
#include "tetvdb/io/formats/cgns/CgnsElements.h"
#include "tetvdb/io/formats/cgns/CgnsFile.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/IsolatedRead.h"
#include "tetvdb/io/source/TimeStep.h"

#include <algorithm>
#include <cgnslib.h>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kName = 33; ///< characters of a name, the ending 0 included

struct Section {
  int number = 0;
  ElementType_t type = ElementTypeNull;
  cgsize_t start = 0, end = 0;
};

class CgnsMesh {
public:
  CgnsMesh(const Source& source, const std::string& path, const ReadOptions& options,
           Report& report, Progress& progress)
      : source_(source), options_(options), report_(report), progress_(progress),
        file_(source, path) {
    int bases = 0;
    file_.check(cg_nbases(file_.id(), &bases), "the bases");
    for (base_ = 1; base_ <= bases; ++base_) {
      char name[kName] = {};
      int cellDimension = 0;
      file_.check(cg_base_read(file_.id(), base_, name, &cellDimension, &dimension_), "a base");
      file_.check(cg_nzones(file_.id(), base_, &zones_), "the zones of a base");
      if (zones_ < 1)
        continue;
      if (dimension_ < 1 || dimension_ > 3)
        file_.fail("a base has " + std::to_string(dimension_) + " dimensions", kExport);
      if (bases > 1)
        report_.warn("several-bases", "of " + std::to_string(bases) + " bases '" + name +
                                          "' is read, the first with zones");
      return;
    }
    file_.fail("has no zones", kExport);
  }

  std::vector<double> times() const {
    char name[kName] = {};
    int steps = 0, arrays = 0;
    std::vector<double> times;
    if (cg_biter_read(file_.id(), base_, name, &steps) != CG_OK || steps < 1)
      return times;
    file_.checked(steps, 4, "steps");
    file_.check(cg_goto(file_.id(), base_, "BaseIterativeData_t", 1, "end"), "the steps");
    file_.check(cg_narrays(&arrays), "the times");
    for (int i = 1; i <= arrays; ++i) {
      char arrayName[kName] = {};
      DataType_t type = DataTypeNull;
      int rank = 0;
      cgsize_t shape[12] = {};
      file_.check(cg_array_info(i, arrayName, &type, &rank, shape), "the times");
      if (std::string(arrayName) != "TimeValues" || rank != 1 || shape[0] != steps)
        continue;
      times.resize(static_cast<std::size_t>(steps));
      file_.check(cg_array_read_as(i, RealDouble, times.data()), "the times");
      return times;
    }
    for (int i = 0; i < steps; ++i) // iterations without times
      times.push_back(i);
    return times;
  }

  CellMesh read() {
    CellMesh whole;
    std::vector<double> allTimes = times();
    const std::size_t steps = allTimes.size();
    step_ = chosenStep(steps, options_.timeStep, source_.path).value_or(0);
    steps_ = steps;
    std::vector<std::int32_t> regions;
    std::map<std::int32_t, std::string> names;
    for (int zone = 1; zone <= zones_; ++zone) {
      CellMesh mesh = readZone(zone);
      const std::string family = familyOf(zone);
      const auto known = std::find_if(names.begin(), names.end(),
                                      [&](const auto& one) { return one.second == family; });
      const std::int32_t region = known != names.end() ? known->first : zone;
      names[region] = family;
      regions.resize(regions.size() + mesh.cellCount(), region);
      vtk::appendPiece(whole, std::move(mesh), report_);
      progress_.update(static_cast<double>(zone) / zones_);
    }
    whole.regions = std::move(regions);
    whole.regionNames = std::move(names);
    whole.times = std::move(allTimes);
    return whole;
  }

  bool hasSolidCells() {
    for (int zone = 1; zone <= zones_; ++zone) {
      cgsize_t size[9] = {};
      if (openZone(zone, size) == Structured) {
        if (dimension_ == 3 && std::all_of(size, size + 3, [](cgsize_t n) { return n > 1; }))
          return true;
        continue;
      }
      for (const Section& section : sections())
        if (section.type == NFACE_n ||
            (section.type == MIXED
                 ? isMixedSolid(section)
                 : section.type != NGON_n && cgnsElement(section.type).type != CellType::Flat))
          return true;
    }
    return false;
  }

private:
  /// The zone's family, or its own name.
  std::string familyOf(int zone) const {
    char name[kName] = {}, family[1024] = {};
    cgsize_t size[9] = {};
    file_.check(cg_zone_read(file_.id(), base_, zone, name, size), "a zone");
    if (cg_goto(file_.id(), base_, "Zone_t", zone, "end") == CG_OK &&
        cg_famname_read(family) == CG_OK && family[0] != '\0')
      return family;
    return name;
  }

  /// Makes a zone the one that is read.
  ZoneType_t openZone(int zone, cgsize_t* size) {
    char name[kName] = {};
    ZoneType_t type = ZoneTypeNull;
    file_.check(cg_zone_read(file_.id(), base_, zone, name, size), "a zone");
    file_.check(cg_zone_type(file_.id(), base_, zone, &type), "a zone");
    zone_ = zone;
    zoneName_ = name;
    if (type != Structured && type != Unstructured)
      file_.fail("zone '" + zoneName_ + "' is neither structured nor unstructured", kExport);
    return type;
  }

  CellMesh readZone(int zone) {
    cgsize_t size[9] = {};
    const ZoneType_t type = openZone(zone, size);
    CellMesh mesh;
    rank_ = 1;
    cellOfValue_.clear();
    cellCount_ = 0;
    if (type == Structured) {
      rank_ = 3;
      readBlock(size, mesh);
    } else {
      size_[0] = size[0];
      readPoints(file_.checked(size[0], 4, "points"), mesh);
      readSections(mesh);
    }
    readSolutions(mesh);
    return mesh;
  }

  // --- points ---

  void readPoints(std::size_t n, CellMesh& mesh) {
    checkPointCount(n, source_.path);
    if (n == 0)
      file_.fail("zone '" + zoneName_ + "' has no points", kExport);
    int coordinates = 0;
    file_.check(cg_ncoords(file_.id(), base_, zone_, &coordinates), "the coordinates");
    cgsize_t first[3] = {1, 1, 1}, last[3] = {size_[0], size_[1], size_[2]};
    mesh.points.assign(n, Vec3d{0, 0, 0});
    int found = 0;
    for (int i = 1; i <= coordinates; ++i) {
      char name[kName] = {};
      DataType_t type = DataTypeNull;
      file_.check(cg_coord_info(file_.id(), base_, zone_, i, &type, name), "the coordinates");
      const std::string text = name;
      const std::size_t axis = text == "CoordinateX"   ? 0
                               : text == "CoordinateY" ? 1
                               : text == "CoordinateZ" ? 2
                                                       : 3;
      if (axis == 3)
        continue;
      std::vector<double> values(n);
      file_.check(
          cg_coord_read(file_.id(), base_, zone_, name, RealDouble, first, last, values.data()),
          "the coordinates");
      for (std::size_t p = 0; p < n; ++p) {
        if (!std::isfinite(values[p]))
          file_.fail("coordinate " + text + " of point " + std::to_string(p + 1) + " of zone '" +
                         zoneName_ + "' is not finite",
                     kExport);
        mesh.points[p][axis] = values[p];
      }
      ++found;
    }
    if (found < dimension_)
      file_.fail("zone '" + zoneName_ +
                     "' has no coordinates CoordinateX, CoordinateY, CoordinateZ",
                 kExport);
  }

  void readBlock(const cgsize_t* size, CellMesh& mesh) {
    BlockSize points{1, 1, 1};
    for (int k = 0; k < 3; ++k) {
      size_[k] = k < dimension_ ? size[k] : 1;
      if (size_[k] < 1)
        file_.fail("zone '" + zoneName_ + "' has no points", kExport);
      points[std::size_t(k)] = static_cast<std::size_t>(size_[k]);
    }
    readPoints(
        file_.checked(double(points[0]) * double(points[1]) * double(points[2]), 4, "points"),
        mesh);
    const std::size_t count = appendBlock(mesh, points, 0, options_.faces);
    for (std::size_t i = 0; i < count; ++i)
      cellOfValue_.push_back(i);
  }

  // --- elements ---

  /// The zone's sections in the order of their elements' numbers.
  std::vector<Section> sections() const {
    int count = 0;
    file_.check(cg_nsections(file_.id(), base_, zone_, &count), "the elements");
    std::vector<Section> all;
    for (int i = 1; i <= count; ++i) {
      Section section;
      section.number = i;
      char name[kName] = {};
      int boundary = 0, parents = 0;
      file_.check(cg_section_read(file_.id(), base_, zone_, i, name, &section.type, &section.start,
                                  &section.end, &boundary, &parents),
                  "a section of elements");
      if (section.start < 1 || section.end < section.start)
        file_.fail("a section of elements has the range " + std::to_string(section.start) + " to " +
                   std::to_string(section.end));
      all.push_back(section);
    }
    std::sort(all.begin(), all.end(),
              [](const Section& a, const Section& b) { return a.start < b.start; });
    return all;
  }

  void readSections(CellMesh& mesh) {
    const std::vector<Section> all = sections();
    faces_.clear();
    faceNodes_.clear();
    for (const Section& section : all) // polyhedra name them
      if (section.type == NGON_n)
        readPolygons(section, mesh);
    for (const Section& section : all) {
      if (section.type == NFACE_n)
        readPolyhedra(section, mesh);
      else if (section.type == MIXED)
        readMixed(section, mesh);
      else if (section.type != NGON_n)
        readFixed(section, mesh);
      progress_.check();
    }
    if (options_.faces && !faces_.empty())
      addPolygons(mesh);
  }

  std::size_t countOf(const Section& section) const {
    return file_.checked(static_cast<double>(section.end) - section.start + 1, 4, "elements");
  }
  std::size_t sizeOf(const Section& section) const {
    cgsize_t size = 0;
    file_.check(cg_ElementDataSize(file_.id(), base_, zone_, section.number, &size),
                "the size of a section");
    return file_.checked(size, 4, "nodes of elements");
  }
  std::uint32_t pointOf(cgsize_t node, const CellMesh& mesh) const {
    if (node < 1 || static_cast<std::size_t>(node) > mesh.points.size())
      file_.fail("an element of zone '" + zoneName_ + "' refers to point " + std::to_string(node) +
                     ", but there are " + std::to_string(mesh.points.size()) +
                     " points, numbered from 1",
                 kExport);
    return static_cast<std::uint32_t>(node - 1);
  }

  /// One element, whose nodes are checked, but for those of flat elements that are not needed: some
  /// writers leave them 0 and name the solid elements beside them instead.
  void addElement(CellKind kind, const cgsize_t* nodes, CellMesh& mesh) {
    if (options_.faces)
      kind.kept = std::max(kind.kept, polygonCorners(kind));
    for (std::uint32_t i = 0; i < (kind.type == CellType::Flat ? kind.stored() : kind.nodes); ++i) {
      const std::uint32_t point = pointOf(nodes[i], mesh);
      if (i < kind.stored())
        mesh.nodes.push_back(point);
    }
    orderLast(mesh, kind);
    if (kind.type != CellType::Flat)
      cellOfValue_.push_back(cellCount_);
    appendCells(mesh, kind);
    ++cellCount_;
  }

  void readFixed(const Section& section, CellMesh& mesh) {
    const CellKind kind = cgnsElement(section.type);
    if (kind.nodes == 0)
      file_.fail("a section has elements of a type that is not known", kExport);
    const std::size_t count = countOf(section), size = sizeOf(section);
    if (size != count * kind.nodes)
      file_.fail("a section of " + std::to_string(count) + " elements has " + std::to_string(size) +
                 " nodes");
    std::vector<cgsize_t> nodes(size);
    file_.check(cg_elements_read(file_.id(), base_, zone_, section.number, nodes.data(), nullptr),
                "the elements");
    for (std::size_t i = 0; i < count; ++i)
      addElement(kind, nodes.data() + i * kind.nodes, mesh);
  }

  /// Elements of several lengths and where each begins.
  void readTable(const Section& section, std::vector<cgsize_t>& nodes,
                 std::vector<cgsize_t>& offsets) const {
    nodes.resize(sizeOf(section));
    offsets.resize(countOf(section) + 1);
    file_.check(cg_poly_elements_read(file_.id(), base_, zone_, section.number, nodes.data(),
                                      offsets.data(), nullptr),
                "the elements");
    for (std::size_t i = 0; i < offsets.size(); ++i)
      if (offsets[i] < (i == 0 ? 0 : offsets[i - 1]) ||
          static_cast<std::size_t>(offsets[i]) > nodes.size())
        file_.fail("the offsets of a section do not rise or end beyond it");
  }

  /// Calls `use` with each element's kind and nodes, as long as it returns true.
  template <class UseElement>
  void forMixed(const Section& section, UseElement use) const {
    std::vector<cgsize_t> nodes, offsets;
    readTable(section, nodes, offsets);
    for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
      const std::size_t begin = static_cast<std::size_t>(offsets[i]),
                        end = static_cast<std::size_t>(offsets[i + 1]);
      const CellKind kind =
          begin < end ? cgnsElement(static_cast<ElementType_t>(nodes[begin])) : CellKind{};
      if (begin == end || kind.nodes == 0 || end - begin - 1 != kind.nodes)
        file_.fail("element " + std::to_string(i + 1) + " of a mixed section has " +
                   std::to_string(end - begin) + " numbers, which its type does not have");
      if (!use(kind, nodes.data() + begin + 1))
        return;
    }
  }
  void readMixed(const Section& section, CellMesh& mesh) {
    forMixed(section, [&](const CellKind& kind, const cgsize_t* nodes) {
      addElement(kind, nodes, mesh);
      return true;
    });
  }
  bool isMixedSolid(const Section& section) const {
    bool found = false;
    forMixed(section, [&](const CellKind& kind, const cgsize_t*) {
      found = kind.type != CellType::Flat;
      return !found;
    });
    return found;
  }

  void readPolygons(const Section& section, const CellMesh& mesh) {
    std::vector<cgsize_t> nodes, offsets;
    readTable(section, nodes, offsets);
    for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
      const std::size_t begin = faceNodes_.size();
      for (cgsize_t k = offsets[i]; k < offsets[i + 1]; ++k)
        faceNodes_.push_back(pointOf(nodes[static_cast<std::size_t>(k)], mesh));
      faces_[section.start + static_cast<cgsize_t>(i)] = {begin, faceNodes_.size()};
    }
  }

  // Faces by their numbers, negative where they are seen from the other side.
  void readPolyhedra(const Section& section, CellMesh& mesh) {
    std::vector<cgsize_t> elements, offsets;
    readTable(section, elements, offsets);
    // A face belongs to two cells at most; far more would be an attempt to fill the memory.
    const std::size_t max = mesh.nodes.size() + 8 * (faceNodes_.size() + elements.size() + 16);
    for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
      const std::size_t before = mesh.nodes.size();
      mesh.nodes.push_back(static_cast<std::uint32_t>(offsets[i + 1] - offsets[i]));
      for (cgsize_t k = offsets[i]; k < offsets[i + 1]; ++k) {
        const cgsize_t number = elements[static_cast<std::size_t>(k)];
        const auto face = faces_.find(number < 0 ? -number : number);
        if (number == std::numeric_limits<cgsize_t>::min() || face == faces_.end() ||
            face->second.second < face->second.first + 3)
          file_.fail("a polyhedron has face " + std::to_string(number) +
                         ", which does not exist or has fewer than three points",
                     kExport);
        const auto [begin, end] = face->second;
        if (mesh.nodes.size() + (end - begin) > max)
          file_.fail("a face belongs to too many polyhedra");
        mesh.nodes.push_back(static_cast<std::uint32_t>(end - begin));
        mesh.nodes.insert(mesh.nodes.end(), faceNodes_.begin() + static_cast<std::ptrdiff_t>(begin),
                          faceNodes_.begin() + static_cast<std::ptrdiff_t>(end));
      }
      cellOfValue_.push_back(cellCount_++);
      const auto nodes = static_cast<std::uint32_t>(mesh.nodes.size() - before);
      if (mesh.runs.empty() || mesh.runs.back().fileType != "NFACE_n" ||
          mesh.runs.back().nodesPerCell != nodes)
        mesh.runs.push_back({CellType::Polyhedron, nodes, 0, "NFACE_n", false});
      ++mesh.runs.back().count;
    }
  }

  void addPolygons(CellMesh& mesh) {
    for (const auto& [number, range] : faces_) {
      mesh.nodes.insert(mesh.nodes.end(),
                        faceNodes_.begin() + static_cast<std::ptrdiff_t>(range.first),
                        faceNodes_.begin() + static_cast<std::ptrdiff_t>(range.second));
      mesh.runs.push_back({CellType::Flat, static_cast<std::uint32_t>(range.second - range.first),
                           1, "NGON_n", false});
      ++cellCount_;
    }
  }

  // --- solutions ---

  /// The names of the zone's solutions of the step; empty where it does not say.
  std::string solutionOfStep() const {
    char name[kName] = {};
    int arrays = 0;
    if (steps_ == 0 || cg_ziter_read(file_.id(), base_, zone_, name) != CG_OK ||
        cg_goto(file_.id(), base_, "Zone_t", zone_, "ZoneIterativeData_t", 1, "end") != CG_OK ||
        cg_narrays(&arrays) != CG_OK)
      return {};
    for (int i = 1; i <= arrays; ++i) {
      char arrayName[kName] = {};
      DataType_t type = DataTypeNull;
      int rank = 0;
      cgsize_t shape[12] = {};
      file_.check(cg_array_info(i, arrayName, &type, &rank, shape), "the steps of a zone");
      if (std::string(arrayName) != "FlowSolutionPointers" || type != Character || rank != 2 ||
          shape[0] != 32 || static_cast<std::size_t>(shape[1]) != steps_)
        continue;
      std::string text(file_.checked(32.0 * static_cast<double>(steps_), 1, "names"), '\0');
      file_.check(cg_array_read(i, text.data()), "the steps of a zone");
      std::string found = text.substr(32 * step_, 32);
      found = found.substr(0, found.find('\0'));
      while (!found.empty() && found.back() == ' ')
        found.pop_back();
      return found;
    }
    return {};
  }

  void readSolutions(CellMesh& mesh) {
    if (!options_.attributes && options_.regionArray.empty())
      return;
    const std::string wanted = solutionOfStep();
    int count = 0;
    file_.check(cg_nsols(file_.id(), base_, zone_, &count), "the solutions");
    for (int i = 1; i <= count; ++i) {
      char name[kName] = {};
      GridLocation_t location = GridLocationNull;
      file_.check(cg_sol_info(file_.id(), base_, zone_, i, name, &location), "a solution");
      if (!wanted.empty() && wanted != name && steps_ > 1)
        continue;
      if (location == Vertex)
        readFields(i, Attribute::On::Points, mesh);
      else if (location == CellCenter)
        readFields(i, Attribute::On::Cells, mesh);
    }
  }

  void readFields(int solution, Attribute::On on, CellMesh& mesh) {
    int fields = 0, rank = 0;
    cgsize_t shape[12] = {};
    file_.check(cg_nfields(file_.id(), base_, zone_, solution, &fields), "a solution");
    file_.check(cg_sol_size(file_.id(), base_, zone_, solution, &rank, shape), "a solution");
    const std::size_t values =
        on == Attribute::On::Points ? mesh.points.size() : cellOfValue_.size();
    // Of blocks in space: the shape without rind planes, which are not asked for.
    cgsize_t first[3] = {1, 1, 1}, last[3] = {1, 1, 1};
    if (rank_ == 3)
      for (int k = 0; k < 3; ++k)
        last[k] = on == Attribute::On::Points ? size_[k] : std::max<cgsize_t>(1, size_[k] - 1);
    else
      last[0] = static_cast<cgsize_t>(values);
    for (int i = 1; i <= fields; ++i) {
      char name[kName] = {};
      DataType_t type = DataTypeNull;
      file_.check(cg_field_info(file_.id(), base_, zone_, solution, i, &type, name), "a field");
      if (!options_.wants(name) && options_.regionArray != name) {
        if (options_.attributes)
          mesh.unread.push_back({name, on, 1});
        continue;
      }
      if (std::any_of(mesh.attributes.begin(), mesh.attributes.end(),
                      [&](const Attribute& a) { return a.on == on && a.name == name; }))
        continue;
      if (rank == 1 && rank_ == 1 && static_cast<std::size_t>(shape[0]) < values) {
        report_.warn("array-of-other-length",
                     "the array '" + std::string(name) + "' is left out: it has " +
                         std::to_string(shape[0]) + " elements in place of " +
                         std::to_string(values));
        continue;
      }
      file_.checked(static_cast<double>(values), 1, "values");
      if (type == RealSingle)
        readField<float>(solution, name, RealSingle, first, last, on, values, mesh);
      else
        readField<double>(solution, name, RealDouble, first, last, on, values, mesh);
    }
  }

  template <class T>
  void readField(int solution, const char* name, DataType_t type, const cgsize_t* first,
                 const cgsize_t* last, Attribute::On on, std::size_t values, CellMesh& mesh) {
    std::vector<T> read(values);
    if (values > 0)
      file_.check(
          cg_field_read(file_.id(), base_, zone_, solution, name, type, first, last, read.data()),
          "a field");
    if (on == Attribute::On::Cells) {
      // Flat elements have no values.
      std::vector<T> all(mesh.cellCount(), std::numeric_limits<T>::quiet_NaN());
      for (std::size_t i = 0; i < values; ++i)
        all[cellOfValue_[i]] = read[i];
      read = std::move(all);
    }
    mesh.attributes.push_back({name, on, 1, std::move(read)});
  }

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  CgnsFile file_;
  int base_ = 1, zones_ = 0, dimension_ = 3;
  std::size_t steps_ = 0, step_ = 0;
  // The zone that is read.
  int zone_ = 0, rank_ = 1;
  std::string zoneName_;
  cgsize_t size_[3] = {1, 1, 1}; ///< points along the sides of a block; all of them in the first
  std::size_t cellCount_ = 0;
  std::vector<std::size_t> cellOfValue_; ///< solid cells in the order of values at cell centres
  std::map<cgsize_t, std::pair<std::size_t, std::size_t>> faces_; ///< ranges in faceNodes_
  std::vector<std::uint32_t> faceNodes_;
};

} // namespace

CellMesh readCgns(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress) {
  const CgnsBytes file(source, progress);
  const auto read = [&](Report& childReport, Progress& childProgress) {
    return CgnsMesh(source, file.path(), options, childReport, childProgress).read();
  };
  return readIsolated(read, source.path, report, progress);
}

bool cgnsHasSolidCells(const Source& source, Report& report, Progress& progress) {
  const CgnsBytes file(source, progress);
  return answerIsolated(
      [&](Report& childReport, Progress& childProgress) {
        const ReadOptions options;
        return CgnsMesh(source, file.path(), options, childReport, childProgress).hasSolidCells();
      },
      source.path, report, progress);
}

std::vector<double> cgnsTimes(const Source& source, Report& report, Progress& progress) {
  const CgnsBytes file(source, progress);
  const auto read = [&](Report& childReport, Progress& childProgress) {
    const ReadOptions options;
    return CgnsMesh(source, file.path(), options, childReport, childProgress).times();
  };
  return readTimesIsolated(read, source.path, report, progress);
}

} // namespace tetvdb
