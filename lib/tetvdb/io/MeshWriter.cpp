// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/MeshWriter.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/GmshWriter.h"
#include "tetvdb/io/MeditWriter.h"
#include "tetvdb/io/VtuWriter.h"

namespace tetvdb {

void writeTetMesh(const std::string& path, const TetMesh& mesh, Progress& progress) {
  progress.stage("write");
  const std::size_t dot = path.find_last_of("./");
  std::string ending = dot == path.npos || path[dot] == '/' ? std::string() : path.substr(dot);
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
  if (ending == ".msh")
    return writeGmsh(path, mesh, progress);
  if (ending == ".mesh")
    return writeMedit(path, mesh, progress);
  if (ending == ".vtu")
    return writeVtu(path, mesh, progress);
  throw Error(Status::Usage, path, "meshes cannot be written as '" + ending + "'",
              "end the name with .msh, .mesh or .vtu");
}

} // namespace tetvdb
