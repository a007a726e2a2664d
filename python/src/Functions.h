// SPDX-License-Identifier: Apache-2.0
//
// The functions of the module, one source file each.
#pragma once

#include <nanobind/nanobind.h>

namespace tetvdb::python {

namespace nb = nanobind;

void addVoxelize(nb::module_& module);
void addTetrahedralize(nb::module_& module);
void addRepair(nb::module_& module);
void addQuery(nb::module_& module);
void addRender(nb::module_& module);
void addSlice(nb::module_& module);
void addInfo(nb::module_& module);
void addDataset(nb::module_& module);
void addCheck(nb::module_& module);

} // namespace tetvdb::python
