// SPDX-License-Identifier: Apache-2.0
//
// Triangles from .3mf.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/MeshPart.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <vector>

namespace tetvdb {

/// Everything that the build places, with the transforms of items and components in double; faces
/// of mirrored objects are reversed. `units` is the model's. Faces that have no meaning: see
/// FaceCollector. Beams have no faces: warning `beams`; objects that do not exist or hold something
/// else than a mesh: warning `missing-objects`; both set report.partial. Sizes are checked before
/// anything is unpacked. Throws Error(Invalid) for damaged archives and XML and where nothing is
/// built, Error(Limit) where it would unpack to more than is plausible or components repeat one
/// another beyond measure.
TriangleMesh readThreeMf(const Source& source, Report& report, Progress& progress);

/// The same; `parts` become the meshes that are placed, those of one item of the build as one
/// assembly.
TriangleMesh readThreeMfParts(const Source& source, std::vector<MeshPart>& parts, Report& report,
                              Progress& progress);

} // namespace tetvdb
