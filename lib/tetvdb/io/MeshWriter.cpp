// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/MeshWriter.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/mesh/CheckMesh.h"

namespace tetvdb {

void writeTetMesh(const std::string& path, const TetMesh& mesh, Progress& progress) {
  progress.stage("write");
  const Format* format = formatForEnding(path, FormatUse::WriteTets);
  if (format == nullptr)
    throw Error(Status::Usage, path, "meshes cannot be written as '" + endingOf(path) + "'",
                "end the name with " + endingList(FormatUse::WriteTets));
  checkMesh(mesh);
  format->writeTets(path, mesh, progress);
}

} // namespace tetvdb
