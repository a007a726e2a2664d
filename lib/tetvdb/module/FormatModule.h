// SPDX-License-Identifier: Apache-2.0
//
// The functions of this library that call netCDF, HDF5, CGNS or assimp. They are compiled into a
// module, a shared object that is loaded when the first of them is called: these libraries need
// some forty others, whose loading would cost every start of a program more than all of its own
// work. Internal.
#pragma once

#include "tetvdb/io/formats/assimp/AssimpReader.h"
#include "tetvdb/io/formats/cgns/CgnsReader.h"
#include "tetvdb/io/formats/exodus/ExodusReader.h"
#include "tetvdb/io/formats/vtk/VtkHdfReader.h"
#include "tetvdb/io/formats/xdmf/Hdf5Arrays.h"
#include "tetvdb/io/source/PathWithin.h"
#include "tetvdb/io/volume/arrays/ArrayFormats.h"
#include "tetvdb/io/volume/arrays/Hdf5Volume.h"
#include "tetvdb/pipeline/dataset/Hdf5Arrays.h"

namespace tetvdb {

/// The module's functions, each of the name that callers know: FormatModule.cpp forwards them. The
/// module has its own copy of what it uses of the library.
struct FormatFunctions {
  const char* version; ///< of the library that the module was built with
  decltype(&tetvdb::allowReferencesOutside) allowReferencesOutside;
  decltype(&tetvdb::readExodus) readExodus;
  decltype(&tetvdb::exodusHasSolidCells) exodusHasSolidCells;
  decltype(&tetvdb::exodusTimes) exodusTimes;
  decltype(&tetvdb::readCgns) readCgns;
  decltype(&tetvdb::cgnsHasSolidCells) cgnsHasSolidCells;
  decltype(&tetvdb::cgnsTimes) cgnsTimes;
  decltype(&tetvdb::readVtkHdf) readVtkHdf;
  decltype(&tetvdb::vtkHdfHasSolidCells) vtkHdfHasSolidCells;
  decltype(&tetvdb::vtkHdfTimes) vtkHdfTimes;
  decltype(&tetvdb::readGltf) readGltf;
  decltype(&tetvdb::readFbx) readFbx;
  decltype(&tetvdb::readCollada) readCollada;
  decltype(&tetvdb::readThreeDs) readThreeDs;
  decltype(&tetvdb::readHdf5) readHdf5;
  decltype(&tetvdb::hdf5Shape) hdf5Shape;
  decltype(&tetvdb::readHdf5Volume) readHdf5Volume;
  decltype(&tetvdb::writeHdf5) writeHdf5;
  decltype(&tetvdb::writeHdf5Arrays) writeHdf5Arrays;
  decltype(&tetvdb::joinHdf5Files) joinHdf5Files;
};

/// The module's file, and the name of the FormatFunctions that it exports.
constexpr char kFormatModule[] = "tetvdb_formats.so";
constexpr char kFormatFunctions[] = "tetvdbFormatFunctions";

} // namespace tetvdb
