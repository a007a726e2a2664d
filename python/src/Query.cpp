// SPDX-License-Identifier: Apache-2.0
#include "Functions.h"
#include "Inputs.h"
#include "MeshArrays.h"
#include "Settings.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/pipeline/CleanInput.h"
#include "tetvdb/pipeline/MergeMeshes.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/pipeline/SolidQuery.h"
#include "tetvdb/surface/TetSurface.h"

#include <memory>
#include <nanobind/stl/string.h>
#include <utility>
#include <vector>

namespace tetvdb::python {
namespace {

struct PySolid {
  std::unique_ptr<const SolidQuery> query;
  JobLimits limits;
};

// The surface of an input: triangles as they are, cells by their tets.
TriangleMesh surfaceOf(const std::string& name, const MemoryInputs& memory, bool& isSoup,
                       Report& report, Progress& progress) {
  if (holdsTriangles(name, memory))
    return readSoup(name, nullptr, report, progress, memory);
  isSoup = false;
  ReadOptions options;
  options.attributes = false;
  return tetSurface(readTets(name, options, {}, nullptr, report, progress, memory), progress);
}

PySolid makeSolid(const nb::list& given, const nb::dict& keywords) {
  Settings settings(keywords);
  CleanOptions clean;
  settings.takeCleaning(clean);
  PySolid solid;
  solid.limits = settings.takeLimits();
  settings.finish();
  const Inputs inputs = inputsOf(given);
  JobRun work(solid.limits);
  solid.query = work([&](Report& report, Progress& progress) {
    return inArena(solid.limits.threads, [&] {
      std::vector<TriangleMesh> meshes;
      bool isSoup = true;
      for (const std::string& name : inputs.names)
        meshes.push_back(surfaceOf(name, inputs.memory, isSoup, report, progress));
      TriangleMesh mesh = mergeMeshes(std::move(meshes), report);
      if (isSoup)
        cleanInput(mesh, "", cleaningFor(SolidOptions{}, clean), report, progress);
      return std::make_unique<const SolidQuery>(std::move(mesh), progress);
    });
  });
  return solid;
}

nb::tuple ask(const PySolid& self, nb::handle where, bool occupancy, bool distance) {
  const AnyArray array = arrayOf(where, "points", 2, 3);
  std::vector<std::uint8_t> inside;
  std::vector<double> distances;
  JobRun work(self.limits);
  work([&](Report&, Progress& progress) {
    return inArena(self.limits.threads, [&] {
      const std::vector<Vec3d> points = pointsOf(array);
      if (occupancy)
        inside.resize(points.size());
      if (distance)
        distances.resize(points.size());
      self.query->at(points.data(), points.size(), occupancy ? inside.data() : nullptr,
                     distance ? distances.data() : nullptr, progress);
      return true;
    });
  });
  const nb::object none = nb::none();
  const std::vector<std::size_t> shape{array.shape(0)};
  return nb::make_tuple(occupancy ? arrayObject(std::move(inside), shape, nb::dtype<bool>()) : none,
                        distance ? arrayObject(std::move(distances), shape, nb::dtype<double>())
                                 : none);
}

} // namespace

void addQuery(nb::module_& module) {
  nb::class_<PySolid>(module, "_Solid")
      .def("ask", &ask, nb::arg("points"), nb::arg("occupancy"), nb::arg("distance"))
      .def_prop_ro("open_edges", [](const PySolid& self) { return self.query->openEdges(); });
  module.def("solid", &makeSolid, nb::arg("inputs"), nb::arg("settings"),
             "Internal: tetvdb.Solid() with its inputs told apart.");
}

} // namespace tetvdb::python
