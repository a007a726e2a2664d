// SPDX-License-Identifier: Apache-2.0
//
// Triangles from Wavefront .obj.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// Points and faces of all objects and groups; texture coordinates, normals, colours, materials,
/// lines and points are passed over. See FaceCollector for faces that have no meaning. Throws
/// Error(Invalid) where no face is left.
TriangleMesh readObj(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
