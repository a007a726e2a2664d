// SPDX-License-Identifier: Apache-2.0
//
// Reads triangles from .gltf, .glb, .fbx, .dae and .3ds by assimp.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// All meshes of the scene as placed by its nodes, with transforms in double; faces of mirrored
/// ones are reversed, n-gons are split into fans. Coordinates are metres for glTF and COLLADA,
/// centimetres for FBX, for any unit of the file, and `units` names them; 3DS has none. Axes are
/// those of the file. Lines and points are skipped; if assimp omits something, the warning is
/// `scene-faults`, with report.partial. assimp runs in a child process of limited memory.
/// Throws Error(Invalid) if it cannot read the file, nothing is placed, or the library was
/// built without assimp.
TriangleMesh readGltf(const Source& source, Report& report, Progress& progress);
TriangleMesh readFbx(const Source& source, Report& report, Progress& progress);
TriangleMesh readCollada(const Source& source, Report& report, Progress& progress);
TriangleMesh readThreeDs(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
