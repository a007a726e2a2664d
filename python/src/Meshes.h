// SPDX-License-Identifier: Apache-2.0
//
// tetvdb.TetMesh and tetvdb.TriangleMesh: what jobs make, as arrays that share its memory.
#pragma once

#include "Report.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <nanobind/nanobind.h>

namespace tetvdb::python {

void addMeshes(nb::module_& module);

nb::object meshObject(TetMesh mesh, ReportText report);
nb::object meshObject(TriangleMesh mesh, ReportText report);

} // namespace tetvdb::python
