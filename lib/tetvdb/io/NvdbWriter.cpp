// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/VolumeFormats.h"
namespace tetvdb {
void writeNvdb(const std::string& path, const Volume&, Progress&) {
  throw Error(Status::Usage, path, ".nvdb is not supported yet");
}
Volume readNvdb(const std::string& path, Progress&) {
  throw Error(Status::Invalid, path, ".nvdb is not supported yet");
}
} // namespace tetvdb
