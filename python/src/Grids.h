// SPDX-License-Identifier: Apache-2.0
//
// tetvdb.Volume and tetvdb.Grid.
#pragma once

#include "Report.h"
#include "tetvdb/volume/Volume.h"

#include <nanobind/nanobind.h>

namespace tetvdb::python {

namespace nb = nanobind;

void addGrids(nb::module_& module);

/// The Python object of a volume that a job made.
nb::object volumeObject(Volume volume, ReportText report);

/// The volume of a tetvdb.Volume.
Volume volumeOf(nb::handle object);

} // namespace tetvdb::python
