// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"

#include "RunJob.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/TriangleWriter.h"

#include <limits>
#include <nanobind/ndarray.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <utility>

namespace tetvdb::python {
namespace {

using Points = nb::ndarray<nb::numpy, const double, nb::ndim<2>>;
using Indices = nb::ndarray<nb::numpy, const std::int32_t, nb::ndim<2>>;
using Regions = nb::ndarray<nb::numpy, const std::int32_t, nb::ndim<1>>;

struct PyTets {
  TetMesh mesh;
  ReportText report;
};

struct PyTriangles {
  TriangleMesh mesh;
  ReportText report;
};

// Read-only arrays that keep `owner`, the Python object of the mesh, alive.
Points pointsOf(const std::vector<Vec3d>& points, nb::handle owner) {
  return {points.empty() ? nullptr : points.front().data(), {points.size(), 3}, owner};
}

Indices indicesOf(const std::vector<std::uint32_t>& indices, std::size_t width, std::size_t points,
                  nb::handle owner) {
  if (points > std::size_t(std::numeric_limits<std::int32_t>::max()))
    throw Error(Status::Limit, "", "the mesh has more points than int32 can count",
                "write it to a file");
  return {reinterpret_cast<const std::int32_t*>(indices.data()),
          {indices.size() / width, width},
          owner};
}

template <typename Write>
void writeMesh(nb::handle where, const Write& write) {
  const std::string path = pathOf(where);
  JobRun run({});
  run([&](Report&, Progress& progress) {
    write(path, progress);
    return true;
  });
}

} // namespace

void addMeshes(nb::module_& module) {
  nb::class_<PyTets>(module, "TetMesh", "Tetrahedra that a job made.")
      .def_prop_ro(
          "points",
          [](nb::handle_t<PyTets> self) {
            return pointsOf(nb::cast<const PyTets&>(self).mesh.points, self);
          },
          "float64 (N, 3), a read-only view.")
      .def_prop_ro(
          "tets",
          [](nb::handle_t<PyTets> self) {
            const TetMesh& mesh = nb::cast<const PyTets&>(self).mesh;
            return indicesOf(mesh.tets, 4, mesh.points.size(), self);
          },
          "int32 (M, 4), a read-only view; every tet has positive volume.")
      .def_prop_ro(
          "regions",
          [](nb::handle_t<PyTets> self) {
            const TetMesh& mesh = nb::cast<const PyTets&>(self).mesh;
            return Regions(mesh.regions.data(), {mesh.regions.size()}, self);
          },
          "int32 (M): the number of each tet's input, from 1.")
      .def_prop_ro(
          "region_names", [](const PyTets& self) { return self.mesh.regionNames; },
          "Names by number.")
      .def_prop_ro(
          "report", [](const PyTets& self) { return reportDict(self.report); },
          "What the job did, a dict: the object that the command line writes with --json.")
      .def(
          "write",
          [](const PyTets& self, nb::handle path) {
            writeMesh(path, [&](const std::string& name, Progress& progress) {
              writeTetMesh(name, self.mesh, progress);
            });
          },
          nb::arg("path"), "Writes .msh, .mesh or .vtu.")
      .def("__repr__", [](const PyTets& self) {
        return "<tetvdb.TetMesh: " + std::to_string(self.mesh.points.size()) + " points, " +
               std::to_string(self.mesh.tetCount()) + " tets>";
      });
  const auto points = [](nb::handle_t<PyTriangles> self) {
    return pointsOf(nb::cast<const PyTriangles&>(self).mesh.points, self);
  };
  nb::class_<PyTriangles>(module, "TriangleMesh", "Triangles that a job made.")
      .def_prop_ro("vertices", points, "float64 (N, 3), a read-only view.")
      .def_prop_ro("points", points, "The same as `vertices`.")
      .def_prop_ro(
          "faces",
          [](nb::handle_t<PyTriangles> self) {
            const TriangleMesh& mesh = nb::cast<const PyTriangles&>(self).mesh;
            return indicesOf(mesh.triangles, 3, mesh.points.size(), self);
          },
          "int32 (M, 3), a read-only view; counter-clockwise seen from outside.")
      .def_prop_ro(
          "report", [](const PyTriangles& self) { return reportDict(self.report); },
          "What the job did, a dict: the object that the command line writes with --json.")
      .def(
          "write",
          [](const PyTriangles& self, nb::handle path) {
            writeMesh(path, [&](const std::string& name, Progress& progress) {
              writeTriangles(name, self.mesh, progress);
            });
          },
          nb::arg("path"), "Writes .stl, .obj, .ply, .off or .3mf.")
      .def("__repr__", [](const PyTriangles& self) {
        return "<tetvdb.TriangleMesh: " + std::to_string(self.mesh.points.size()) + " points, " +
               std::to_string(self.mesh.triangleCount()) + " triangles>";
      });
}

nb::object meshObject(TetMesh mesh, ReportText report) {
  return nb::cast(PyTets{std::move(mesh), std::move(report)});
}

nb::object meshObject(TriangleMesh mesh, ReportText report) {
  return nb::cast(PyTriangles{std::move(mesh), std::move(report)});
}

} // namespace tetvdb::python
