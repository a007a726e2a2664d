// SPDX-License-Identifier: Apache-2.0
#include "DefectReport.h"
#include "Functions.h"
#include "InfoReport.h"
#include "Inputs.h"
#include "Report.h"
#include "Settings.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/surface/SurfaceDefects.h"
#include "tetvdb/volume/Volume.h"

#include <nanobind/stl/string.h>
#include <utility>

namespace tetvdb::python {
namespace {

using Json = nlohmann::ordered_json;

Json aboutVolume(const std::string& name, const MemoryInputs& memory, bool withHash, Report& report,
                 Progress& progress) {
  const Volume volume = readVolumeInput(name, report, progress, memory);
  Json section = {{"path", name}, {"kind", "volume"}, {"metadata", Json::object()}};
  for (const auto& [key, value] : volume.metadata)
    section["metadata"][key] = value;
  section["grids"] = Json::array();
  for (const GridInfo& grid : describe(volume))
    section["grids"].push_back(cli::sectionOf(grid));
  if (withHash)
    section["hash"] = hash(volume);
  return section;
}

Json aboutMesh(const std::string& name, const MemoryInputs& memory, const DefectOptions& defects,
               const ReadOptions& read, Report& report, Progress& progress) {
  InputInfo info;
  if (holdsTriangles(name, memory)) {
    const TriangleMesh mesh = readSoup(name, &info, report, progress, memory);
    return cli::sectionOf(info, mesh, surfaceDefects(mesh, defects, progress),
                          defects.maxIntersections > 0);
  }
  const TetMesh mesh = readTets(name, read, {}, &info, report, progress, memory);
  return cli::sectionOf(info, mesh);
}

nb::object infoOf(const nb::list& given, const nb::dict& keywords) {
  Settings settings(keywords);
  bool withHash = false;
  settings.take("hash", withHash);
  int intersections = 100000;
  settings.take("max_intersections", intersections);
  if (intersections < 0)
    Settings::refuse("max_intersections", "is below 0", "give a number of pairs, 0: do not count");
  DefectOptions defects;
  defects.maxIntersections = static_cast<std::size_t>(intersections);
  ReadOptions read;
  settings.take("region_array", read.regionArray);
  const JobLimits limits = settings.takeLimits();
  settings.finish();
  const Inputs inputs = inputsOf(given);
  const std::string& name = inputs.names.front();
  JobRun work(limits);
  const std::string text = work([&](Report& report, Progress& progress) {
    const Json section = isVolume(name, inputs.memory)
                             ? aboutVolume(name, inputs.memory, withHash, report, progress)
                             : aboutMesh(name, inputs.memory, defects, read, report, progress);
    return section.dump(-1, ' ', false, Json::error_handler_t::replace);
  });
  return reportDict([&] { return text; });
}

} // namespace

void addInfo(nb::module_& module) {
  module.def("info", &infoOf, nb::arg("inputs"), nb::arg("settings"),
             "Internal: tetvdb.info() with its input told apart.");
}

} // namespace tetvdb::python
