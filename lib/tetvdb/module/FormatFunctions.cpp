// SPDX-License-Identifier: Apache-2.0
//
// What the module exports.
#include "tetvdb/core/Version.h"
#include "tetvdb/module/FormatModule.h"

extern "C" [[gnu::visibility("default")]] const tetvdb::FormatFunctions* tetvdbFormatFunctions() {
  static const tetvdb::FormatFunctions functions = {
      tetvdb::version(),         tetvdb::allowReferencesOutside,
      tetvdb::readExodus,        tetvdb::exodusHasSolidCells,
      tetvdb::exodusTimes,       tetvdb::readCgns,
      tetvdb::cgnsHasSolidCells, tetvdb::cgnsTimes,
      tetvdb::readVtkHdf,        tetvdb::vtkHdfHasSolidCells,
      tetvdb::vtkHdfTimes,       tetvdb::readGltf,
      tetvdb::readFbx,           tetvdb::readCollada,
      tetvdb::readThreeDs,       tetvdb::readHdf5,
      tetvdb::hdf5Shape,         tetvdb::readHdf5Volume,
      tetvdb::writeHdf5,         tetvdb::writeHdf5Arrays,
      tetvdb::joinHdf5Files};
  return &functions;
}
