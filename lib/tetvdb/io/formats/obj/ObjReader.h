// SPDX-License-Identifier: Apache-2.0
//
// Reads triangles from Wavefront .obj.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// Points and faces of all objects and groups; texture coordinates, normals, colours, materials,
/// lines and points are skipped. See FaceCollector for invalid faces. Throws Error(Invalid) if no
/// face is left.
TriangleMesh readObj(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
