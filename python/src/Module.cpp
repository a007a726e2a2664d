// SPDX-License-Identifier: Apache-2.0
//
// The module tetvdb._tetvdb: the library's jobs on plain arrays. The package tetvdb gives them
// their signatures.
#include "DeviceTensor.h"
#include "Functions.h"
#include "Grids.h"
#include "Meshes.h"
#include "RunJob.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/io/source/PathWithin.h"
#include "tetvdb/volume/Grids.h"

NB_MODULE(_tetvdb, module) {
  using namespace tetvdb::python;
  module.doc() = "Jobs of the library TetVDB on plain arrays.";
  module.attr("__version__") = tetvdb::version();
  tetvdb::initializeOpenVDB();
  watchForks();
  addErrors(module);
  addGrids(module);
  addMeshes(module);
  addVoxelize(module);
  addTetrahedralize(module);
  addRepair(module);
  addQuery(module);
  addInfo(module);
  addRender(module);
  addSlice(module);
  addDeviceTensor(module);
  addDataset(module);
  addCheck(module);
  module.def("allow_outside", &tetvdb::allowReferencesOutside, nanobind::arg("allowed") = true,
             "Whether files that are read may refer to files outside of their folders, for this "
             "process; False from the start.");
}
