// SPDX-License-Identifier: Apache-2.0
//
// Triangles from .3mf, by lib3mf.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/Source.h"
#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// Everything that the build places, with the transforms of items and components in double; faces
/// of mirrored objects are turned round. `units` is the model's. Beams have no faces: warning
/// `beams` and report.partial. Sizes are checked before lib3mf sees the file, which it reads in a
/// child process of limited memory. Throws Error(Invalid) with lib3mf's words where it cannot read
/// it or nothing is built, Error(Limit) where it would unpack to more than is plausible or memory
/// does not do.
TriangleMesh readThreeMf(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
