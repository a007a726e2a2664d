// SPDX-License-Identifier: Apache-2.0
//
// The machine-readable report, --json, as a file.
#pragma once

#include "JobReport.h"

#include <string>

namespace tetvdb::cli {

/// Throws Error(Usage) where `path` is a file with something in it that is no report of this
/// program.
void requireReplaceable(const std::string& path);
/// Throws Error(Write) where a report could not be created, with advice about --json.
void requireWritableReport(const std::string& path);
/// Writes `text` to `path`, whole or not at all. Throws Error(Write).
void writeReport(const std::string& path, const std::string& text);

/// `text` without line breaks and other control characters.
std::string oneLine(const std::string& text);

} // namespace tetvdb::cli
