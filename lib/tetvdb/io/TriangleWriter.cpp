// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/TriangleWriter.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/mesh/CheckMesh.h"

namespace tetvdb {

bool writesTriangles(const std::string& path) {
  return formatForEnding(path, FormatUse::WriteTriangles) != nullptr;
}

void writeTriangles(const std::string& path, const TriangleMesh& mesh, Progress& progress) {
  progress.stage("write");
  const Format* format = formatForEnding(path, FormatUse::WriteTriangles);
  if (format == nullptr)
    throw Error(Status::Usage, path, "triangles cannot be written as '" + endingOf(path) + "'",
                "end the name with " + endingList(FormatUse::WriteTriangles));
  checkMesh(mesh);
  format->writeTriangles(path, mesh, progress);
}

} // namespace tetvdb
