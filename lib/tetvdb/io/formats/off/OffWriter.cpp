// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/off/OffWriter.h"

#include "tetvdb/io/text/TriangleLines.h"

namespace tetvdb {

void writeOff(const std::string& path, const TriangleMesh& mesh, Progress& progress) {
  const std::string counts =
      std::to_string(mesh.points.size()) + " " + std::to_string(mesh.triangleCount()) + " 0\n";
  writeTriangleLines(path, mesh, {"OFF\n" + counts, "", "3", 0}, progress);
}

} // namespace tetvdb
