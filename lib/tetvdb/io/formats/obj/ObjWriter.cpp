// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/obj/ObjWriter.h"

#include "tetvdb/io/text/TriangleLines.h"

namespace tetvdb {

void writeObj(const std::string& path, const TriangleMesh& mesh, Progress& progress) {
  writeTriangleLines(path, mesh, {"# TetVDB\n", "v", "f", 1}, progress);
}

} // namespace tetvdb
