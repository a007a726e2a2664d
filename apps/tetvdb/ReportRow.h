// SPDX-License-Identifier: Apache-2.0
//
// One model of `tetvdb report`: its result as a row of the page.
#pragma once

#include "tetvdb/core/Progress.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tetvdb::cli {

struct ReportSettings {
  int resolution = 128; ///< voxels along a model's longest side
  double maxTime = 120; ///< seconds a model
  std::string mesher = "auto";
  std::string maxMemory; ///< as --max-memory takes it; empty: its default
};

/// A model and its name.
struct ReportModel {
  std::string path, name;
};

/// Voxelizes the model in a child process with a picture, and looks for its defects. Errors and
/// crashes of a model become its row. Throws when cancelled, and Error(Write) if no temporary
/// folder can be made.
nlohmann::ordered_json reportRow(const ReportModel& model, const ReportSettings& settings,
                                 const Progress& progress);

/// The whole page, which needs no other file: `rows` and their summary.
std::string reportPage(const std::vector<nlohmann::ordered_json>& rows,
                       const ReportSettings& settings);

} // namespace tetvdb::cli
