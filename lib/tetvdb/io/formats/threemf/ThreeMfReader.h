// SPDX-License-Identifier: Apache-2.0
//
// Reads triangles from .3mf.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/MeshPart.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <vector>

namespace tetvdb {

/// All objects of the build, with the transforms of items and components in double; faces of
/// mirrored objects are reversed. `units` is that of the model. Invalid faces: see
/// FaceCollector. Beam lattices become closed surfaces (BeamLattice.h), or the mesh that the file
/// names as their representation; beams that are invalid, or are not cut off as the file says by
/// another object: warning `beams`; objects that do not exist or are not a mesh: warning
/// `missing-objects`; all these set report.partial. Sizes are checked before anything is unpacked.
/// Throws Error(Invalid) for damaged archives and XML and if nothing is built, Error(Limit) if the
/// unpacked size is implausible or components are repeated excessively.
TriangleMesh readThreeMf(const Source& source, Report& report, Progress& progress);

/// The same; `parts` receives the meshes of the build, those of one item as one
/// assembly.
TriangleMesh readThreeMfParts(const Source& source, std::vector<MeshPart>& parts, Report& report,
                              Progress& progress);

} // namespace tetvdb
