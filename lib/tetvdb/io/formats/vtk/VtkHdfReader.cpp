// SPDX-License-Identifier: Apache-2.0
//
// The format: "VTKHDF File Format" in VTK's documentation.
#include "tetvdb/io/formats/vtk/VtkHdfReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/formats/vtk/VtkInput.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/Hdf5File.h"
#include "tetvdb/io/source/IsolatedRead.h"
#include "tetvdb/io/source/TimeStep.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace tetvdb {
namespace {

const std::string kRoot = "/VTKHDF";

/// The kinds of cells of a PolyData file in VTK's order, and the types of their cells.
struct PolyKind {
  const char* group;
  std::uint8_t type;
};
constexpr PolyKind kPolyKinds[] = {{"Vertices", 2}, {"Lines", 4}, {"Polygons", 7}, {"Strips", 6}};

/// The positions of a step's numbers.
struct StepStart {
  std::uint64_t firstPart = 0, parts = 0, point = 0;
  std::uint64_t cell[4] = {}, connectivity[4] = {}; ///< one kind, or four of PolyData
};

class VtkHdfFile {
public:
  VtkHdfFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : source_(source), options_(options), report_(report), progress_(progress), file_(source) {
    if (!file_.has(kRoot))
      fail("has no group VTKHDF", "export it again");
    const auto version = file_.integer(kRoot, "Version");
    if (!version || *version < 1 || *version > 2)
      fail("has version " + (version ? std::to_string(*version) : std::string("none")) +
               "; 1 and 2 are read",
           "save it with another version");
    // The first files of version 1 have no type.
    const std::string type =
        file_.text(kRoot, "Type")
            .value_or(file_.has(kRoot + "/Types") ? "UnstructuredGrid" : "no type");
    isPoly_ = type == "PolyData";
    if (!isPoly_ && type != "UnstructuredGrid")
      fail("holds " + vtk::readable(type) + ", not an UnstructuredGrid or PolyData",
           "save the mesh as an unstructured grid");
  }

  std::vector<double> times() const {
    const std::uint64_t steps = stepCount();
    std::vector<double> times;
    if (steps == 0)
      return times;
    std::visit([&](const auto& values) { times.assign(values.begin(), values.end()); },
               file_.read(kRoot + "/Steps/Values"));
    if (times.size() != steps)
      fail(std::to_string(steps) + " steps are declared, but there are " +
           std::to_string(times.size()) + " times");
    return times;
  }

  bool hasSolidCells() const {
    if (isPoly_)
      return false;
    const std::vector<std::uint64_t> types = numbers("Types");
    return std::any_of(types.begin(), types.end(), [](std::uint64_t type) {
      return type < 256 && vtk::cellKind(static_cast<std::uint8_t>(type)).type != CellType::Flat;
    });
  }

  CellMesh read() {
    chooseStep();
    CellMesh whole;
    const std::vector<std::uint64_t> points = numbers("NumberOfPoints");
    if (start_.firstPart > points.size() || start_.parts > points.size() - start_.firstPart)
      fail("a step has parts beyond those of the file");
    std::uint64_t point = start_.point;
    for (std::uint64_t part = 0; part < start_.parts; ++part) {
      CellMesh mesh;
      const std::uint64_t n = points[start_.firstPart + part];
      checkPointCount(n, source_.path);
      readPoints(point, n, mesh);
      readPart(part, mesh);
      point += n;
      vtk::appendPiece(whole, std::move(mesh), report_);
      progress_.check();
    }
    readAttributes("PointData", Attribute::On::Points, start_.point, whole.points.size(), whole);
    std::uint64_t firstCell = 0;
    for (const std::uint64_t cell : start_.cell)
      firstCell += cell;
    if (!options_.faces && !(isPoly_ && start_.parts > 1))
      readAttributes("CellData", Attribute::On::Cells, firstCell, whole.cellCount(), whole);
    whole.times = times();
    return whole;
  }

private:
  [[noreturn]] void fail(const std::string& what, const char* advice = kCut) const {
    throw Error(Status::Invalid, source_.path, what, advice);
  }

  // --- numbers ---

  /// A list of non-negative numbers.
  std::vector<std::uint64_t> numbers(const std::string& name, const Slab* slab = nullptr) const {
    std::vector<std::uint64_t> all;
    std::visit(
        [&](const auto& values) {
          all.reserve(values.size());
          for (const auto value : values) {
            if (!(value >= 0) || !(static_cast<double>(value) < 9e15))
              fail("'" + name + "' has a number that is no count");
            all.push_back(static_cast<std::uint64_t>(value));
          }
        },
        file_.read(kRoot + "/" + name, slab));
    return all;
  }
  /// Rows [begin, begin + n) of a dataset.
  Attribute::Values rows(const std::string& name, std::uint64_t begin, std::uint64_t n,
                         std::uint32_t* width = nullptr) const {
    const std::vector<std::uint64_t> shape = file_.shape(kRoot + "/" + name);
    if (shape.empty() || shape.size() > 3)
      fail("'" + name + "' has " + std::to_string(shape.size()) + " dimensions");
    if (begin > shape[0] || n > shape[0] - begin)
      fail("'" + name + "' has " + std::to_string(shape[0]) + " rows in place of " +
           std::to_string(begin) + " + " + std::to_string(n));
    Slab slab;
    std::uint64_t each = 1;
    for (std::size_t k = 0; k < shape.size(); ++k) {
      slab.start.push_back(k == 0 ? begin : 0);
      slab.stride.push_back(1);
      slab.count.push_back(k == 0 ? n : shape[k]);
      each *= k == 0 ? 1 : std::min<std::uint64_t>(shape[k], 1u << 20);
    }
    if (each < 1 || each > 1u << 16)
      fail("'" + name + "' has " + std::to_string(each) + " components");
    if (width != nullptr)
      *width = static_cast<std::uint32_t>(each);
    return n == 0 ? Attribute::Values(std::vector<double>())
                  : file_.read(kRoot + "/" + name, &slab);
  }
  std::vector<std::uint64_t> someNumbers(const std::string& name, std::uint64_t begin,
                                         std::uint64_t n) const {
    std::vector<std::uint64_t> all;
    std::visit(
        [&](const auto& values) {
          all.reserve(values.size());
          for (const auto value : values)
            all.push_back(value >= 0 && static_cast<double>(value) < 9e15
                              ? static_cast<std::uint64_t>(value)
                              : std::uint64_t(1) << 63);
        },
        rows(name, begin, n));
    return all;
  }

  // --- steps ---

  std::uint64_t stepCount() const {
    if (!file_.has(kRoot + "/Steps"))
      return 0;
    const auto steps = file_.integer(kRoot + "/Steps", "NSteps");
    if (!steps || *steps < 0 || *steps > 1 << 30)
      fail("the group Steps has no number of steps");
    return static_cast<std::uint64_t>(*steps);
  }

  void chooseStep() {
    const auto step = chosenStep(stepCount(), options_.timeStep, source_.path);
    start_.parts = file_.shape(kRoot + "/NumberOfPoints").at(0);
    if (!step)
      return;
    isStepped_ = true;
    step_ = *step;
    start_.firstPart = ofStep("PartOffsets").value_or(0);
    if (const auto parts = ofStep("NumberOfParts"))
      start_.parts = *parts;
    start_.point = ofStep("PointOffsets").value_or(0);
    for (std::size_t kind = 0; kind < (isPoly_ ? 4 : 1); ++kind) {
      start_.cell[kind] = ofStep("CellOffsets", kind).value_or(0);
      start_.connectivity[kind] = ofStep("ConnectivityIdOffsets", kind).value_or(0);
    }
  }
  /// The number of the step in a list of Steps; for tables that in column `column`.
  std::optional<std::uint64_t> ofStep(const std::string& name, std::size_t column = 0) const {
    const std::string path = "Steps/" + name;
    if (!file_.has(kRoot + "/" + path))
      return {};
    const std::vector<std::uint64_t> row = someNumbers(path, step_, 1);
    const std::uint64_t found = row.at(std::min(column, row.size() - 1));
    if (found >= std::uint64_t(1) << 62)
      fail("'" + path + "' has a number that is no offset");
    return found;
  }

  // --- one part ---

  void readPoints(std::uint64_t begin, std::uint64_t n, CellMesh& mesh) const {
    std::uint32_t width = 3;
    const Attribute::Values values = rows("Points", begin, n, &width);
    if (n > 0 && width != 3)
      fail("points have " + std::to_string(width) + " coordinates, not 3");
    mesh.points.resize(n);
    std::visit(
        [&](const auto& all) {
          for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t k = 0; k < 3; ++k)
              mesh.points[i][k] = static_cast<double>(all[3 * i + k]);
            if (!isFinite(mesh.points[i]))
              fail("a coordinate of point " + std::to_string(begin + i) + " is not finite",
                   kExport);
          }
        },
        values);
  }

  void readPart(std::uint64_t part, CellMesh& mesh) {
    if (!isPoly_)
      return readCells("", 0, part, 0, mesh);
    for (std::size_t kind = 0; kind < 4; ++kind)
      if (file_.has(kRoot + "/" + kPolyKinds[kind].group))
        readCells(std::string(kPolyKinds[kind].group) + "/", kPolyKinds[kind].type, part, kind,
                  mesh);
  }

  /// Cells of one kind; type 0: types are stored per cell.
  void readCells(const std::string& group, std::uint8_t type, std::uint64_t part, std::size_t kind,
                 CellMesh& mesh) {
    const std::vector<std::uint64_t> cellCounts = numbers(group + "NumberOfCells"),
                                     sizes = numbers(group + "NumberOfConnectivityIds");
    const std::uint64_t number = start_.firstPart + part;
    if (number >= cellCounts.size() || number >= sizes.size())
      fail("'" + group + "NumberOfCells' lacks part " + std::to_string(number));
    std::uint64_t firstCell = start_.cell[kind], firstId = start_.connectivity[kind];
    for (std::uint64_t i = start_.firstPart; i < number; ++i) {
      firstCell += cellCounts[i];
      firstId += sizes[i];
    }
    const std::uint64_t n = cellCounts[number];
    if (n == 0)
      return;
    vtk::Cells cells;
    cells.where = source_.path + ":" + kRoot + "/" + group;
    if (type != 0)
      cells.types.assign(n, type);
    else
      for (const std::uint64_t one : someNumbers("Types", firstCell, n))
        cells.types.push_back(one < 255 ? static_cast<std::uint8_t>(one) : 255);
    if (std::find(cells.types.begin(), cells.types.end(), 42) != cells.types.end())
      fail("holds polyhedra, which are not read from this format", "save it as .vtu");
    // Every part has one more offset than cells.
    cells.ends = someNumbers(group + "Offsets",
                             firstCell + partsBefore(cellCounts, start_.cell[kind]) + part, n + 1);
    if (cells.ends.front() != 0)
      fail("'" + group + "Offsets' of part " + std::to_string(number) + " do not begin with 0");
    cells.ends.erase(cells.ends.begin());
    for (const std::uint64_t node : someNumbers(group + "Connectivity", firstId, sizes[number]))
      cells.connectivity.push_back(
          static_cast<std::uint32_t>(std::min<std::uint64_t>(node, 0xffffffffu)));
    vtk::appendCells(std::move(cells), mesh, progress_, options_.faces);
  }

  /// The number of parts whose cells precede cell `cell` of the file. Steps that share one mesh
  /// have their own parts in the list, but the cells of the first step's.
  std::uint64_t partsBefore(const std::vector<std::uint64_t>& cellCounts,
                            std::uint64_t cell) const {
    std::uint64_t cells = 0, found = cellCounts.size() + 1;
    for (std::uint64_t part = 0; part <= cellCounts.size(); ++part) {
      if (cells == cell && (part == start_.firstPart || found > cellCounts.size()))
        found = part;
      cells += part < cellCounts.size() ? cellCounts[part] : 0;
    }
    if (found > cellCounts.size())
      fail("a step's cells do not begin where a part's do");
    return found;
  }

  // --- arrays ---

  void readAttributes(const std::string& group, Attribute::On on, std::uint64_t first,
                      std::size_t elements, CellMesh& mesh) {
    for (const std::string& name : file_.members(kRoot + "/" + group)) {
      const std::string path = group + "/" + name;
      const bool forRegions = on == Attribute::On::Cells;
      if (!options_.wants(name) && !forRegions) {
        if (options_.attributes)
          mesh.unread.push_back({name, on, 1});
        continue;
      }
      const auto moved = isStepped_ ? ofStep(group + "Offsets/" + name) : std::nullopt;
      const std::vector<std::uint64_t> shape = file_.shape(kRoot + "/" + path);
      const std::uint64_t begin = moved.value_or(first);
      if (shape.empty() || begin > shape[0] || elements > shape[0] - begin) {
        report_.warn("array-of-other-length", "the array '" + name + "' is left out: it has " +
                                                  std::to_string(shape.empty() ? 0 : shape[0]) +
                                                  " elements in place of " +
                                                  std::to_string(begin + elements));
        continue;
      }
      Attribute array;
      array.name = name;
      array.on = on;
      array.values = rows(path, begin, elements, &array.components);
      if (elements > 0)
        mesh.attributes.push_back(std::move(array));
    }
  }

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  Hdf5File file_;
  bool isPoly_ = false, isStepped_ = false;
  std::uint64_t step_ = 0;
  StepStart start_;
};

} // namespace

CellMesh readVtkHdf(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress) {
  const auto read = [&](Report& childReport, Progress& childProgress) {
    return VtkHdfFile(source, options, childReport, childProgress).read();
  };
  return readIsolated(read, source.path, report, progress);
}

bool vtkHdfHasSolidCells(const Source& source, Report& report, Progress& progress) {
  return answerIsolated(
      [&](Report& childReport, Progress& childProgress) {
        const ReadOptions options;
        return VtkHdfFile(source, options, childReport, childProgress).hasSolidCells();
      },
      source.path, report, progress);
}

std::vector<double> vtkHdfTimes(const Source& source, Report& report, Progress& progress) {
  const auto read = [&](Report& childReport, Progress& childProgress) {
    const ReadOptions options;
    return VtkHdfFile(source, options, childReport, childProgress).times();
  };
  return readTimesIsolated(read, source.path, report, progress);
}

} // namespace tetvdb
