// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/arrays/ArrayVolume.h"

namespace tetvdb {

Volume readArrays(const std::string& path, const ArrayInput& options, Progress& progress) {
  const MappedFile file(path);
  const Format& format = formatOf(sniffFormat(file.bytes(), path));
  if (!can(format, FormatUse::ReadArrays))
    throw Error(Status::Invalid, path,
                "is no file of arrays: neither " + endingList(FormatUse::ReadArrays, "nor"));
  ArrayVolume volume(path, options, progress);
  format.readArrays(file.source(), volume.sink(), progress);
  return volume.finish();
}

} // namespace tetvdb
