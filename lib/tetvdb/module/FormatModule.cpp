// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/module/FormatModule.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Version.h"

#include <dlfcn.h>
#include <string>

namespace tetvdb {
namespace {

[[noreturn]] void fail(const std::string& why) {
  throw Error(Status::Invalid, kFormatModule,
              "this part of TetVDB, which works on netCDF, HDF5, CGNS and assimp's files, cannot "
              "be loaded: " +
                  why,
              "install TetVDB again, or name the module's folder in LD_LIBRARY_PATH");
}

/// Looks in the folders of the caller's RUNPATH, where builds, installations and packages put it.
const FormatFunctions& load() {
  void* const module = ::dlopen(kFormatModule, RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr)
    fail(::dlerror());
  using Get = const FormatFunctions* (*)();
  const auto get = reinterpret_cast<Get>(::dlsym(module, kFormatFunctions));
  if (get == nullptr)
    fail(::dlerror());
  const FormatFunctions& functions = *get();
  if (std::string(functions.version) != version())
    fail(std::string("it is that of version ") + functions.version + ", not of " + version());
  return functions;
}

const FormatFunctions& module() {
  static const FormatFunctions& functions = load();
  functions.allowReferencesOutside(areReferencesAllowedOutside());
  return functions;
}

} // namespace

CellMesh readExodus(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress) {
  return module().readExodus(source, options, report, progress);
}
bool exodusHasSolidCells(const Source& source, Report& report, Progress& progress) {
  return module().exodusHasSolidCells(source, report, progress);
}
std::vector<double> exodusTimes(const Source& source, Report& report, Progress& progress) {
  return module().exodusTimes(source, report, progress);
}

CellMesh readCgns(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress) {
  return module().readCgns(source, options, report, progress);
}
bool cgnsHasSolidCells(const Source& source, Report& report, Progress& progress) {
  return module().cgnsHasSolidCells(source, report, progress);
}
std::vector<double> cgnsTimes(const Source& source, Report& report, Progress& progress) {
  return module().cgnsTimes(source, report, progress);
}

CellMesh readVtkHdf(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress) {
  return module().readVtkHdf(source, options, report, progress);
}
bool vtkHdfHasSolidCells(const Source& source, Report& report, Progress& progress) {
  return module().vtkHdfHasSolidCells(source, report, progress);
}
std::vector<double> vtkHdfTimes(const Source& source, Report& report, Progress& progress) {
  return module().vtkHdfTimes(source, report, progress);
}

TriangleMesh readGltf(const Source& source, Report& report, Progress& progress) {
  return module().readGltf(source, report, progress);
}
TriangleMesh readFbx(const Source& source, Report& report, Progress& progress) {
  return module().readFbx(source, report, progress);
}
TriangleMesh readCollada(const Source& source, Report& report, Progress& progress) {
  return module().readCollada(source, report, progress);
}
TriangleMesh readThreeDs(const Source& source, Report& report, Progress& progress) {
  return module().readThreeDs(source, report, progress);
}

NumberArrays readHdf5(const std::vector<Hdf5Dataset>& datasets, const std::string& path,
                      Report& report, Progress& progress) {
  return module().readHdf5(datasets, path, report, progress);
}
std::vector<std::uint64_t> hdf5Shape(const Hdf5Dataset& dataset, const std::string& path,
                                     Report& report, Progress& progress) {
  return module().hdf5Shape(dataset, path, report, progress);
}

NumberArrays readHdf5Volume(const Source& source, Report& report, Progress& progress) {
  return module().readHdf5Volume(source, report, progress);
}

void writeHdf5(const ArrayContent& content, Progress& progress) {
  module().writeHdf5(content, progress);
}
void writeHdf5Arrays(const std::string& path, const std::vector<NamedArray>& arrays,
                     const ArrayAttributes& about) {
  module().writeHdf5Arrays(path, arrays, about);
}
void joinHdf5Files(const std::string& path,
                   const std::vector<std::pair<std::string, std::string>>& members,
                   Progress& progress) {
  module().joinHdf5Files(path, members, progress);
}

} // namespace tetvdb
