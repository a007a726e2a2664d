// SPDX-License-Identifier: Apache-2.0
//
// Triangles from .gltf, .glb, .fbx and .dae, by assimp.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// All meshes of the scene as its nodes place them, with transforms in double; faces of mirrored
/// ones are reversed, n-gons become fans. Coordinates are metres for glTF and COLLADA,
/// centimetres for FBX, whatever the file's unit, and `units` says so; axes stay as they are in the
/// file. Lines and points are passed over; what assimp drops is the warning `scene-faults`, with
/// report.partial. assimp runs in a child process of limited memory. Throws
/// Error(Invalid) where it cannot read the file, nothing is placed, or the library was built
/// without assimp.
TriangleMesh readGltf(const Source& source, Report& report, Progress& progress);
TriangleMesh readFbx(const Source& source, Report& report, Progress& progress);
TriangleMesh readCollada(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
