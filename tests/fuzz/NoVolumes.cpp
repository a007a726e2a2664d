// SPDX-License-Identifier: Apache-2.0
//
// The fuzz targets read meshes: the readers and writers of volumes, which the table of formats
// names, are left out with OpenVDB.
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/io/volume/arrays/ArrayFormats.h"

namespace tetvdb {
namespace {

[[noreturn]] void refuse(const std::string& path) {
  throw Error(Status::Usage, path, "is a volume");
}

} // namespace

void writeVdb(const std::string& path, const Volume&, Progress&) {
  refuse(path);
}
void writeNvdb(const std::string& path, const Volume&, Progress&) {
  refuse(path);
}
Volume readVdb(const std::string& path, Progress&) {
  refuse(path);
}
Volume readNvdb(const std::string& path, Progress&) {
  refuse(path);
}
void writeNpy(const ArrayContent&, Progress&) {
  refuse("");
}
void writeNpz(const ArrayContent&, Progress&) {
  refuse("");
}
void writeVti(const ArrayContent&, Progress&) {
  refuse("");
}
void writeNrrd(const ArrayContent&, Progress&) {
  refuse("");
}
void writeHdf5(const ArrayContent&, Progress&) {
  refuse("");
}
void writeTiff(const ArrayContent&, Progress&) {
  refuse("");
}
void writeRaw(const ArrayContent&, Progress&) {
  refuse("");
}
void writeBinvox(const ArrayContent&, Progress&) {
  refuse("");
}

} // namespace tetvdb
