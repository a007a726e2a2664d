// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "DefectReport.h"
#include "Session.h"
#include "tetvdb/surface/SurfaceDefects.h"

#include <nlohmann/json.hpp>
#include <string>

namespace tetvdb::cli {

/// `info` for a file of triangles: fills its section and adds to session.text.
void describeTriangles(const std::string& path, const DefectOptions& options,
                       nlohmann::ordered_json& section, Session& session);

} // namespace tetvdb::cli
