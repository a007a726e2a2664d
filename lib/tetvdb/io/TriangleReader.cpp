// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/TriangleReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/AssimpReader.h"
#include "tetvdb/io/ObjReader.h"
#include "tetvdb/io/OffReader.h"
#include "tetvdb/io/PlyReader.h"
#include "tetvdb/io/Source.h"
#include "tetvdb/io/StlReader.h"
#include "tetvdb/io/ThreeMfReader.h"

#include <new>

namespace tetvdb {
namespace {

using ReadFunction = TriangleMesh (*)(const Source&, Report&, Progress&);

ReadFunction readerOf(MeshFormat format) {
  switch (format) {
  case MeshFormat::Stl:
    return readStl;
  case MeshFormat::Obj:
    return readObj;
  case MeshFormat::Off:
    return readOff;
  case MeshFormat::Ply:
    return readPly;
  case MeshFormat::ThreeMf:
    return readThreeMf;
  case MeshFormat::Gltf:
  case MeshFormat::Fbx:
  case MeshFormat::Collada:
    return readScene;
  default:
    return nullptr; // solid cells, or unknown
  }
}

} // namespace

bool holdsTriangles(MeshFormat format) {
  return format >= MeshFormat::Stl;
}

TriangleMesh readTriangles(const std::string& path, Report& report, Progress& progress,
                           MeshFormat* format) {
  const MappedFile file(path);
  const Source source = file.source();
  const MeshFormat found = sniffMeshFormat(source.bytes, path);
  if (format != nullptr)
    *format = found;
  const ReadFunction read = readerOf(found);
  if (read == nullptr)
    throw Error(Status::Invalid, path,
                found == MeshFormat::Unknown
                    ? describeUnknownFormat(source.bytes, path)
                    : "is a file of cells (" + std::string(formatName(found)) +
                          "), not of triangles",
                "readable are .stl, .obj, .off, .ply, .3mf, .gltf, .glb, .fbx and .dae files");
  try {
    return read(source, report, progress);
  } catch (const std::bad_alloc&) {
    throw Error(Status::Limit, path, "not enough memory to read the mesh",
                "split it into several files or use a machine with more memory");
  }
}

} // namespace tetvdb
