// SPDX-License-Identifier: Apache-2.0
#include "Inputs.h"

#include "Grids.h"
#include "MeshArrays.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/mesh/CheckMesh.h"

#include <cmath>
#include <memory>
#include <nanobind/stl/string.h>
#include <utility>

namespace tetvdb::python {
namespace {

struct NamedArray {
  std::string name;
  Attribute::On on = Attribute::On::Points;
  AnyArray array;
};

using NamedArrays = std::vector<NamedArray>;

void addData(nb::handle data, Attribute::On on, NamedArrays& arrays) {
  if (data.is_none())
    return;
  for (const auto& [name, array] : nb::cast<nb::dict>(data)) {
    const std::string text = nb::cast<std::string>(name);
    arrays.push_back({text, on, arrayOf(array, text, 0)});
  }
}

void requireFinite(const std::vector<Vec3d>& points, const std::string& name) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!(std::isfinite(points[i][0]) && std::isfinite(points[i][1]) &&
          std::isfinite(points[i][2])))
      throw Error(Status::Invalid, name, "point " + std::to_string(i) + " is not finite");
}

void addAttributes(const NamedArrays& arrays, const std::string& name, CellMesh& mesh) {
  for (const NamedArray& data : arrays) {
    Attribute attribute = attributeOf(data.name, data.on, data.array);
    const std::size_t wanted =
        data.on == Attribute::On::Points ? mesh.points.size() : mesh.cellCount();
    if (attribute.size() != wanted)
      throw Error(Status::Invalid, name,
                  "'" + data.name + "' has " + std::to_string(attribute.size()) + " rows for " +
                      std::to_string(wanted) +
                      (data.on == Attribute::On::Points ? " points" : " cells"));
    mesh.attributes.push_back(std::move(attribute));
  }
}

MemoryInput trianglesOf(const std::string& name, const nb::tuple& given) {
  struct Arrays {
    AnyArray points, faces;
  };
  auto arrays = std::make_shared<Arrays>(
      Arrays{arrayOf(given[2], name + ".points", 2, 3), arrayOf(given[3], name + ".faces", 2, 3)});
  MemoryInput input;
  input.triangles = [arrays, name] {
    TriangleMesh mesh;
    mesh.points = pointsOf(arrays->points);
    mesh.triangles = indicesOf(arrays->faces, name + ".faces");
    mesh.faceCount = mesh.triangleCount();
    checkMesh(mesh);
    return mesh;
  };
  return input;
}

MemoryInput tetsOf(const std::string& name, const nb::tuple& given) {
  struct Arrays {
    AnyArray points, tets;
    NamedArrays data;
  };
  auto arrays = std::make_shared<Arrays>(Arrays{
      arrayOf(given[2], name + ".points", 2, 3), arrayOf(given[3], name + ".tets", 2, 4), {}});
  addData(given[4], Attribute::On::Points, arrays->data);
  addData(given[5], Attribute::On::Cells, arrays->data);
  MemoryInput input;
  input.cells = [arrays, name] {
    CellMesh mesh;
    mesh.points = pointsOf(arrays->points);
    requireFinite(mesh.points, name);
    mesh.nodes = indicesOf(arrays->tets, name + ".tets");
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
      if (mesh.nodes[i] >= mesh.points.size())
        throw Error(Status::Invalid, name,
                    "tet " + std::to_string(i / 4) + " names point " +
                        std::to_string(mesh.nodes[i]) + " of " +
                        std::to_string(mesh.points.size()));
    mesh.runs.push_back({CellType::Tetra, 4, mesh.nodes.size() / 4, "tetra", false});
    addAttributes(arrays->data, name, mesh);
    return mesh;
  };
  return input;
}

MemoryInput cellsOf(const std::string& name, const nb::tuple& given) {
  struct Arrays {
    AnyArray points, types, ends, nodes;
    NamedArrays data;
  };
  auto arrays = std::make_shared<Arrays>(Arrays{arrayOf(given[2], name + ".points", 2, 3),
                                                arrayOf(given[3], name + ".celltypes", 1),
                                                arrayOf(given[4], name + ".offsets", 1),
                                                arrayOf(given[5], name + ".cells", 1),
                                                {}});
  addData(given[6], Attribute::On::Points, arrays->data);
  addData(given[7], Attribute::On::Cells, arrays->data);
  MemoryInput input;
  input.cells = [arrays, name] {
    CellMesh mesh;
    mesh.points = pointsOf(arrays->points);
    requireFinite(mesh.points, name);
    vtk::Cells cells;
    cells.types = bytesOf(arrays->types, name + ".celltypes");
    cells.ends = offsetsOf(arrays->ends, name + ".offsets");
    cells.connectivity = indicesOf(arrays->nodes, name + ".cells");
    cells.facesInConnectivity = true;
    cells.where = name;
    Progress progress;
    vtk::appendCells(std::move(cells), mesh, progress);
    addAttributes(arrays->data, name, mesh);
    return mesh;
  };
  return input;
}

} // namespace

Inputs inputsOf(const nb::list& given) {
  Inputs inputs;
  for (const nb::handle item : given) {
    const auto input = nb::cast<nb::tuple>(item);
    const auto kind = nb::cast<std::string>(input[0]);
    const auto name = nb::cast<std::string>(input[1]);
    inputs.names.push_back(name);
    if (kind == "triangles")
      inputs.memory[name] = trianglesOf(name, input);
    else if (kind == "tets")
      inputs.memory[name] = tetsOf(name, input);
    else if (kind == "cells")
      inputs.memory[name] = cellsOf(name, input);
    else if (kind == "volume")
      inputs.memory[name].volume = volumeOf(input[2]);
  }
  return inputs;
}

bool isVolume(const std::string& name, const MemoryInputs& memory) {
  const MemoryInput* input = inMemory(name, memory);
  return input != nullptr ? input->volume.has_value() : isVolumeFile(name);
}

} // namespace tetvdb::python
