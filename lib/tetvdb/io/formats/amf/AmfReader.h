// SPDX-License-Identifier: Apache-2.0
//
// Additive manufacturing files (.amf), plain or in an archive.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// The volumes of all objects, as the constellations that no other one contains place them; objects
/// that none places are taken as they are. `units` are the file's. Curved edges, normals, materials
/// and colours are ignored. Faces without meaning are left out as by FaceCollector. Throws
/// Error(Invalid) with the line for broken XML, a file without faces and an archive without a
/// model; Error(Limit) for constellations that contain one another too often.
TriangleMesh readAmf(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
