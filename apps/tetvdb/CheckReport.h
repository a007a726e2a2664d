// SPDX-License-Identifier: Apache-2.0
//
// The settings and the findings of checks, independent of the command line: the Python module's
// reports are the same.
#pragma once

#include "JobReport.h"
#include "tetvdb/pipeline/CheckPrintJob.h"
#include "tetvdb/pipeline/CheckVolumes.h"

#include <nlohmann/json.hpp>
#include <string>

namespace tetvdb::cli {

/// Leaves out of `job`, whose target is set, what `list` does not name: "islands,cups". Throws
/// Error(Usage) that names `option`.
void chooseChecks(const std::string& option, const std::string& list, CheckPrintJob& job);

/// "note", "warning" or "error".
std::string wordFor(Finding::Weight weight);

/// An element of "findings".
nlohmann::ordered_json toJson(const Finding& finding, TextOf textOf = plainText);

/// "print" and, where `withFindings`, "findings".
void addSections(const CheckPrintJob& job, const CheckPrintResult& result, TextOf textOf,
                 bool withFindings, nlohmann::ordered_json& sections);

} // namespace tetvdb::cli
