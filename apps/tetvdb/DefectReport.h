// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "JobReport.h"
#include "tetvdb/surface/SurfaceDefects.h"

#include <nlohmann/json.hpp>

namespace tetvdb::cli {

/// The "defects" of a report. Self-intersections are null where they were not counted.
nlohmann::ordered_json toJson(const SurfaceDefects& defects, bool intersections);

/// The text of `info` about triangles.
nlohmann::ordered_json sectionOf(const InputInfo& info, const TriangleMesh& mesh,
                                 const SurfaceDefects& defects, bool intersections,
                                 TextOf textOf = plainText);

} // namespace tetvdb::cli
