// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/TriangleWriter.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/ObjWriter.h"
#include "tetvdb/io/OffWriter.h"
#include "tetvdb/io/PlyWriter.h"
#include "tetvdb/io/StlWriter.h"
#include "tetvdb/io/ThreeMfWriter.h"

namespace tetvdb {
namespace {

using WriteFunction = void (*)(const std::string&, const TriangleMesh&, Progress&);

/// ".stl" of "a/b.STL"; empty where there is none.
std::string extension(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  std::string ending = dot == path.npos || path[dot] == '/' ? std::string() : path.substr(dot);
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
  return ending;
}

WriteFunction writerOf(const std::string& ending) {
  if (ending == ".stl")
    return writeStl;
  if (ending == ".obj")
    return writeObj;
  if (ending == ".ply")
    return writePly;
  if (ending == ".off")
    return writeOff;
  if (ending == ".3mf")
    return writeThreeMf;
  return nullptr;
}

} // namespace

bool writesTriangles(const std::string& path) {
  return writerOf(extension(path)) != nullptr;
}

void writeTriangles(const std::string& path, const TriangleMesh& mesh, Progress& progress) {
  progress.stage("write");
  const std::string ending = extension(path);
  const WriteFunction write = writerOf(ending);
  if (write == nullptr)
    throw Error(Status::Usage, path, "triangles cannot be written as '" + ending + "'",
                "end the name with .stl, .obj, .ply, .off or .3mf");
  write(path, mesh, progress);
}

} // namespace tetvdb
