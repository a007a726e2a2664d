// SPDX-License-Identifier: Apache-2.0
//
// Jobs and their results as sections of the machine-readable report, independent of the command
// line: the Python module's reports are the same.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/PrepareMesh.h"
#include "tetvdb/pipeline/RenderJob.h"
#include "tetvdb/pipeline/RepairJob.h"
#include "tetvdb/pipeline/SequenceJob.h"
#include "tetvdb/pipeline/SliceJob.h"
#include "tetvdb/pipeline/TetrahedralizeJob.h"
#include "tetvdb/pipeline/VoxelizeJob.h"
#include "tetvdb/volume/Volume.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb::cli {

/// One element of "grids".
nlohmann::ordered_json toJson(const GridInfo& grid);
/// Grids as a list.
nlohmann::ordered_json toJson(const std::vector<GridInfo>& grids);
/// The changes that cleaning made.
nlohmann::ordered_json toJson(const CleanCounts& cleaned);
/// One element of "input": a file and what it is; of a mesh that was read, `info`, its format and
/// number of vertices. Null: no more is known.
nlohmann::ordered_json inputSection(const std::string& path, SolidSource source,
                                    const InputInfo* info);
/// "mesh" of the envelope mesher's tets.
nlohmann::ordered_json toJson(const MeshSummary& mesh);

/// The content of a preview, as section "preview"; nothing if there is none.
void reportPreview(const std::optional<PreviewInfo>& preview, const std::string& path,
                   nlohmann::ordered_json& sections);

/// Section "prepared": what a folder of prepareMesh() holds.
nlohmann::ordered_json preparedSection(const PreparedMesh& mesh, const std::string& folder);

/// The method by which triangles were made a solid, in words.
std::string methodText(const VoxelizeJob& job, const VoxelizeResult& result);

/// A region's name as written; "outside" for what is outside.
std::string regionName(const TetrahedralizeResult& result, std::int32_t number);

/// Converts a text of the library to a text for users, with the program's names of settings.
using TextOf = std::string (*)(std::string_view);
/// As the library has it, settings in backquotes.
inline std::string plainText(std::string_view text) {
  return std::string(text);
}

/// The report's sections of a job that is done, in order; "stages" is null.
nlohmann::ordered_json sectionsOf(const VoxelizeJob& job, const VoxelizeResult& result,
                                  TextOf textOf = plainText);
nlohmann::ordered_json sectionsOf(const TetrahedralizeJob& job, const TetrahedralizeResult& result);
nlohmann::ordered_json sectionsOf(const RepairJob& job, const RepairResult& result,
                                  TextOf textOf = plainText);
nlohmann::ordered_json sectionsOf(const RenderJob& job, const RenderResult& result);
nlohmann::ordered_json sectionsOf(const SliceJob& job, const SliceResult& result);
/// "frames", "output" and, of the first frame that was made, "grids" of a sequence.
void addFrames(const std::vector<FrameResult>& results, nlohmann::ordered_json& sections);
/// The same, with "transform" and "frames_at_once".
void addSections(const SequenceResult& result, nlohmann::ordered_json& sections);

/// The number of threads that a job uses if it asks for that many; 0: as many as the arena has.
int threadsOf(int asked);

/// The whole report as text: "version", "command", "status", "error" unless it is empty, the
/// sections with "stages" filled in where there is a place for it, "warnings".
std::string reportText(const std::string& command, Status status, const std::string& error,
                       const Report& report, const nlohmann::ordered_json& sections);

} // namespace tetvdb::cli
