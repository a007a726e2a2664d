// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/MeshFileName.h"

#include "tetvdb/io/Formats.h"

namespace tetvdb {

bool isMeshFileName(const std::string& path) {
  if (formatForEnding(path, FormatUse::ReadTriangles) != nullptr)
    return true;
  const Format* cells = formatForEnding(path, FormatUse::ReadCells);
  return cells != nullptr && (cells->id != FileFormat::TetGen || endingOf(path) == ".ele");
}

} // namespace tetvdb
