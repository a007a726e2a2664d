// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/openfoam/OpenFoamReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/formats/openfoam/FoamCase.h"
#include "tetvdb/io/formats/openfoam/FoamFile.h"
#include "tetvdb/io/formats/openfoam/PolyMesh.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/TimeStep.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace tetvdb {
namespace openfoam {
namespace {

// Where a part's points and cells begin among those of all.
struct Placed {
  std::size_t firstPoint = 0, points = 0, firstCell = 0, cells = 0;
};

// Appends a mesh, checked; says where it lies.
Placed add(const PolyMesh& poly, const std::string& where, CellMesh& mesh) {
  check(poly, where);
  checkPointCount(mesh.points.size() + poly.points.size(), where);
  const Placed placed{mesh.points.size(), poly.points.size(), mesh.cellCount(), poly.cellCount()};
  append(poly, mesh);
  return placed;
}

// The number of a region, by its name.
std::int32_t regionNumber(CellMesh& mesh, const std::string& name) {
  for (const auto& [number, known] : mesh.regionNames)
    if (known == name)
      return number;
  const auto number = static_cast<std::int32_t>(mesh.regionNames.size() + 1);
  mesh.regionNames[number] = name;
  return number;
}

void addZones(const std::vector<Zone>& zones, const Placed& placed, const std::string& where,
              CellMesh& mesh) {
  for (const Zone& zone : zones) {
    if (zone.cells.empty())
      continue;
    mesh.regions.resize(placed.firstCell + placed.cells, 0);
    const std::int32_t number = regionNumber(mesh, zone.name);
    for (const std::uint32_t cell : zone.cells) {
      if (cell >= placed.cells)
        throw Error(Status::Invalid, where,
                    "a zone has cell " + std::to_string(cell) + " of " +
                        std::to_string(placed.cells),
                    kCut);
      mesh.regions[placed.firstCell + cell] = number;
    }
  }
}

class CaseReader {
public:
  CaseReader(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : source_(source), options_(options), report_(report), progress_(progress), case_(source) {}

  CellMesh read() {
    time_ = chosenStep(case_.times().size(), options_.timeStep, source_.path);
    mesh_.times = case_.times();
    for (const CasePart& part : case_.parts()) {
      progress_.check();
      placed_.push_back(readMesh(part));
    }
    if (!mesh_.regions.empty())
      mesh_.regions.resize(mesh_.cellCount(), 0);
    if (options_.attributes && time_)
      readFields();
    return std::move(mesh_);
  }

private:
  std::string meshFile(const CasePart& part, const char* name) const {
    const auto found = case_.meshFile(part, time_, name);
    if (!found)
      throw Error(Status::Invalid, source_.path,
                  "the mesh" +
                      (part.folder.empty() && part.region.empty()
                           ? std::string()
                           : " of '" + part.folder + part.region + "'") +
                      " has no file '" + name + "'",
                  "copy or make the mesh again");
    return *found;
  }

  Placed readMesh(const CasePart& part) {
    PolyMesh poly;
    const std::string faces = meshFile(part, "faces");
    poly.points = FoamFile(meshFile(part, "points")).points();
    poly.faces = FoamFile(faces).faces();
    poly.owner = FoamFile(meshFile(part, "owner")).labels(poly.faces.count());
    poly.neighbour = FoamFile(meshFile(part, "neighbour")).labels(poly.faces.count());
    const Placed placed = add(poly, faces, mesh_);
    if (!part.region.empty()) {
      mesh_.regions.resize(placed.firstCell, 0);
      mesh_.regions.resize(placed.firstCell + placed.cells, regionNumber(mesh_, part.region));
    } else if (const auto zones = case_.meshFile(part, time_, "cellZones")) {
      addZones(FoamFile(*zones).zones(), placed, *zones, mesh_);
    }
    return placed;
  }

  // The same name can be a field in some parts alone.
  struct Field {
    FieldClass is;
    std::vector<std::pair<std::size_t, std::string>> files; ///< part, path
  };

  void readFields() {
    std::map<std::string, Field> fields;
    for (std::size_t i = 0; i < case_.parts().size(); ++i)
      for (const FieldFile& file : case_.fields(case_.parts()[i], *time_)) {
        const std::optional<FieldClass> is = classOf(file.path);
        if (!is)
          continue;
        Field& field = fields[file.name];
        if (field.files.empty())
          field.is = *is;
        if (field.is.onPoints == is->onPoints && field.is.components == is->components)
          field.files.emplace_back(i, file.path);
      }
    for (const auto& [name, field] : fields) {
      progress_.check();
      const Attribute::On on = field.is.onPoints ? Attribute::On::Points : Attribute::On::Cells;
      if (options_.wants(name))
        readField(name, field, on);
      else
        mesh_.unread.push_back({name, on, field.is.components});
    }
  }

  // Of a file that may be none of OpenFOAM's.
  static std::optional<FieldClass> classOf(const std::string& path) {
    try {
      return FoamFile(path, true).fieldClass();
    } catch (const Error&) {
      return {};
    }
  }

  void readField(const std::string& name, const Field& field, Attribute::On on) {
    const std::uint32_t components = field.is.components;
    const std::size_t all = on == Attribute::On::Points ? mesh_.points.size() : mesh_.cellCount();
    std::vector<double> values(all * components, std::nan(""));
    bool any = false;
    for (const auto& [number, path] : field.files) {
      const Placed& placed = placed_[number];
      const std::size_t count = on == Attribute::On::Points ? placed.points : placed.cells;
      const std::size_t first = on == Attribute::On::Points ? placed.firstPoint : placed.firstCell;
      const auto found = FoamFile(path).internalField(count, components);
      if (!found) {
        report_.warn("array-left-out", path + ": '" + name +
                                           "' is left out: it has no values of its own, but what "
                                           "OpenFOAM computes");
        continue;
      }
      if (found->size() != count * components) {
        report_.warn("array-of-other-length",
                     path + ": '" + name + "' has " + std::to_string(found->size() / components) +
                         " values for " + std::to_string(count) +
                         (on == Attribute::On::Points ? " points" : " cells") + " and is left out");
        continue;
      }
      std::copy(found->begin(), found->end(),
                values.begin() + static_cast<std::ptrdiff_t>(first * components));
      any = true;
    }
    if (any)
      mesh_.attributes.push_back({name, on, components, std::move(values)});
  }

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  FoamCase case_;
  std::optional<std::size_t> time_;
  CellMesh mesh_;
  std::vector<Placed> placed_;
};

} // namespace

CellMesh readTexts(std::string_view texts, Report&, Progress&) {
  const std::string path = "text";
  const auto next = [&] {
    const std::size_t end = std::min(texts.find(kParts), texts.size());
    const std::string_view text = texts.substr(0, end);
    texts.remove_prefix(std::min(end + kParts.size(), texts.size()));
    return text;
  };
  CellMesh mesh;
  PolyMesh poly;
  poly.points = FoamFile(next(), path).points();
  poly.faces = FoamFile(next(), path).faces();
  poly.owner = FoamFile(next(), path).labels(poly.faces.count());
  poly.neighbour = FoamFile(next(), path).labels(poly.faces.count());
  const Placed placed = add(poly, path, mesh);
  if (const std::string_view zones = next(); !zones.empty())
    addZones(FoamFile(zones, path).zones(), placed, path, mesh);
  if (const std::string_view text = next(); !text.empty()) {
    FoamFile field(text, path);
    const auto is = field.fieldClass();
    if (is && !is->onPoints)
      if (auto values = field.internalField(placed.cells, is->components);
          values && values->size() == placed.cells * is->components)
        mesh.attributes.push_back(
            {"field", Attribute::On::Cells, is->components, std::move(*values)});
  }
  return mesh;
}

} // namespace openfoam

CellMesh readOpenFoam(const Source& source, const ReadOptions& options, Report& report,
                      Progress& progress) {
  return openfoam::CaseReader(source, options, report, progress).read();
}

std::vector<std::string> openFoamFiles(const Source& source, int timeStep) {
  const openfoam::FoamCase from(source);
  const std::optional<std::size_t> time = chosenStep(from.times().size(), timeStep, source.path);
  std::vector<std::string> files;
  for (const openfoam::CasePart& part : from.parts()) {
    for (const char* name : {"points", "faces", "owner", "neighbour", "cellZones"})
      if (auto file = from.meshFile(part, time, name))
        files.push_back(std::move(*file));
    if (time)
      for (openfoam::FieldFile& field : from.fields(part, *time))
        files.push_back(std::move(field.path));
  }
  return files;
}

std::vector<double> openFoamTimes(const Source& source, Report&, Progress&) {
  return openfoam::FoamCase(source).times();
}

} // namespace tetvdb
