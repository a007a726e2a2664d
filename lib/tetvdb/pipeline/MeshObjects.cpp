// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/MeshObjects.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/formats/threemf/ThreeMfReader.h"
#include "tetvdb/io/source/Source.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

// Points of one part and the faces that use them; parts without faces are omitted.
std::vector<NamedMesh> split(const TriangleMesh& whole, const std::vector<MeshPart>& parts,
                             std::size_t firstAssembly) {
  std::vector<NamedMesh> objects;
  std::vector<std::size_t> objectOf(parts.size());
  const auto partOf = [&](std::uint32_t point) {
    const auto after =
        std::upper_bound(parts.begin(), parts.end(), std::size_t(point),
                         [](std::size_t p, const MeshPart& part) { return p < part.firstPoint; });
    return static_cast<std::size_t>(after - parts.begin()) - 1;
  };
  std::vector<std::size_t> faces(parts.size(), 0);
  for (std::size_t i = 0; i < whole.triangles.size(); i += 3)
    ++faces[partOf(whole.triangles[i])];
  for (std::size_t part = 0; part < parts.size(); ++part) {
    if (faces[part] == 0)
      continue;
    objectOf[part] = objects.size();
    NamedMesh object;
    object.name = parts[part].name;
    object.assembly = firstAssembly + parts[part].assembly;
    object.assemblyName = parts[part].assemblyName;
    object.mesh.units = whole.units;
    object.mesh.faceCount = faces[part];
    const std::size_t end =
        part + 1 < parts.size() ? parts[part + 1].firstPoint : whole.points.size();
    object.mesh.points.assign(whole.points.begin() +
                                  static_cast<std::ptrdiff_t>(parts[part].firstPoint),
                              whole.points.begin() + static_cast<std::ptrdiff_t>(end));
    objects.push_back(std::move(object));
  }
  for (std::size_t i = 0; i < whole.triangles.size(); ++i) {
    const std::size_t part = partOf(whole.triangles[i]);
    objects[objectOf[part]].mesh.triangles.push_back(
        whole.triangles[i] - static_cast<std::uint32_t>(parts[part].firstPoint));
  }
  return objects;
}

std::vector<NamedMesh> readParts(const Source& source, std::size_t firstAssembly, InputInfo* info,
                                 Report& report, Progress& progress) {
  const std::size_t warningsBefore = report.warnings.size();
  std::vector<MeshPart> parts;
  const TriangleMesh mesh = readThreeMfParts(source, parts, report, progress);
  for (std::size_t i = warningsBefore; i < report.warnings.size(); ++i)
    if (report.warnings[i].text.find(source.path) == std::string::npos)
      report.warnings[i].text = source.path + ": " + report.warnings[i].text;
  if (info != nullptr) {
    info->path = source.path;
    info->format = FileFormat::ThreeMf;
    info->vertices = mesh.points.size();
    info->triangles = mesh.triangleCount();
    info->units = mesh.units;
  }
  return split(mesh, parts, firstAssembly);
}

} // namespace

std::vector<NamedMesh> readObjects(const std::string& path, std::size_t firstAssembly,
                                   InputInfo* info, Report& report, Progress& progress,
                                   const MemoryInputs& memory) {
  if (inMemory(path, memory) == nullptr) {
    const MappedFile file(path);
    const Source source = file.source();
    if (sniffFormat(source.bytes, path) == FileFormat::ThreeMf)
      return readParts(source, firstAssembly, info, report, progress);
  }
  NamedMesh object;
  object.name = std::filesystem::path(path).stem().string();
  object.assembly = firstAssembly;
  object.mesh = readSoup(path, info, report, progress, memory);
  return {std::move(object)};
}

TriangleMesh joinObjects(const std::vector<NamedMesh>& objects) {
  TriangleMesh all;
  for (const NamedMesh& object : objects) {
    const std::size_t first = all.points.size();
    if (first + object.mesh.points.size() > std::numeric_limits<std::uint32_t>::max())
      throw Error(Status::Limit, "", "the objects have more than 2^32 points together",
                  "take them one at a time");
    if (all.units.empty())
      all.units = object.mesh.units;
    all.points.insert(all.points.end(), object.mesh.points.begin(), object.mesh.points.end());
    for (const std::uint32_t v : object.mesh.triangles)
      all.triangles.push_back(static_cast<std::uint32_t>(first) + v);
    all.faceCount += object.mesh.faceCount;
  }
  return all;
}

bool keepsObjects(const std::string& path) {
  return lowerCase(std::filesystem::path(path).extension().string()) == ".3mf";
}

double metresOf(const std::string& unit, std::string* name) {
  struct Unit {
    const char *name, *other, *abbreviation;
    double metres;
  };
  constexpr Unit units[] = {
      {"micrometre", "micron", "um", 1e-6},     {"millimetre", "millimeter", "mm", 1e-3},
      {"centimetre", "centimeter", "cm", 1e-2}, {"metre", "meter", "m", 1},
      {"inch", "inches", "in", 0.0254},         {"foot", "feet", "ft", 0.3048}};
  for (const Unit& known : units)
    if (unit == known.name || unit == known.other || unit == known.abbreviation) {
      if (name != nullptr)
        *name = known.name;
      return known.metres;
    }
  return 0;
}

} // namespace tetvdb
