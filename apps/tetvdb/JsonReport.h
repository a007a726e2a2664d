// SPDX-License-Identifier: Apache-2.0
//
// The machine-readable report, --json.
#pragma once

#include "Session.h"
#include "tetvdb/volume/Volume.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tetvdb::cli {

/// The report as text: "version", "command", "status", "error" after a failure, the session's
/// sections, "warnings".
std::string reportText(const std::string& command, Status status, const std::string& error,
                       const Session& session);

/// Throws Error(Usage) where `path` is a file with something in it that is no report of this
/// program.
void requireReplaceable(const std::string& path);
/// Throws Error(Write) where a report could not be created, with advice about --json.
void requireWritableReport(const std::string& path);
/// Writes `text` to `path`, whole or not at all. Throws Error(Write).
void writeReport(const std::string& path, const std::string& text);

/// One element of "grids".
nlohmann::ordered_json toJson(const GridInfo& grid);
/// Grids as a list.
nlohmann::ordered_json toJson(const std::vector<GridInfo>& grids);

/// `text` without line breaks and other control characters.
std::string oneLine(const std::string& text);

} // namespace tetvdb::cli
