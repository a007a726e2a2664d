// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/RoundToFloats.h"

#include <optional>
#include <string>

namespace tetvdb {

/// If the format of a path, by its ending, has float coordinates (Format::hasFloatCoordinates):
/// rounds a repaired mesh to floats (roundToFloats()). Where faces still cross, repairs and rounds
/// it again, up to three times. If some are left, or points that are equal as floats, the report is
/// partial, with the warning "float-crossings". Adds the stage "round".
std::optional<FloatRounding> roundForFormat(TriangleMesh& mesh, const std::string& path,
                                            Report& report, Progress& progress);

} // namespace tetvdb
