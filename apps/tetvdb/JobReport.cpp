// SPDX-License-Identifier: Apache-2.0
#include "JobReport.h"

#include "tetvdb/core/Version.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/pipeline/FitVolume.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

Json stagesOf(const Report& report) {
  Json stages = Json::array();
  for (const Stage& stage : report.stages) {
    Json parts = Json::array();
    for (const StagePart& part : stage.parts)
      parts.push_back({{"name", part.name}, {"seconds", part.seconds}});
    stages.push_back({{"name", stage.name},
                      {"seconds", stage.seconds},
                      {"peak_bytes", stage.peakBytes},
                      {"parts", std::move(parts)}});
  }
  return stages;
}

Json warningsOf(const Report& report) {
  Json warnings = Json::array();
  for (const Warning& warning : report.warnings)
    warnings.push_back({{"code", warning.code}, {"text", warning.text}});
  return warnings;
}

const char* nameOf(InsideRule rule) {
  constexpr const char* kNames[] = {"winding", "nonzero", "parity", "flood"};
  return kNames[static_cast<std::size_t>(rule)];
}

Json inputsOf(const VoxelizeResult& result) {
  Json list = Json::array();
  for (const InputInfo& input : result.inputs) {
    Json entry = {{"path", input.path},
                  {"format", formatName(input.format)},
                  {"kind", result.holdsTriangles ? "triangles" : "tets"},
                  {"vertices", input.vertices}};
    if (result.holdsTriangles) {
      entry["triangles"] = input.triangles;
      entry["units"] = input.units.empty() ? Json() : Json(input.units);
    } else {
      entry["tets"] = input.tets;
      entry["cells"] = Json(input.cells);
      entry["defects"] = {{"inverted", input.statistics.inverted}, {"flat", input.statistics.flat}};
    }
    list.push_back(std::move(entry));
  }
  return list;
}

Json tetsOf(const VoxelizeResult& result) {
  return {{"tets", result.tets},
          {"flipped", result.counts.flipped},
          {"dropped", result.counts.dropped},
          {"boundary_faces", result.counts.boundaryFaces},
          {"volume", result.volume},
          // The envelope mesher's cleaning; tets are not cleaned.
          {"epsilon_asked", nullptr},
          {"epsilon_used", nullptr},
          {"epsilon_reached", nullptr},
          {"quality", nullptr},
          {"not_inserted", nullptr}};
}

Json trianglesOf(const VoxelizeJob& job, const VoxelizeResult& result, TextOf textOf) {
  Json mesh = {{"triangles", result.triangles},
               {"open_edges", result.openEdges},
               {"closed", result.openEdges == 0},
               {"method", methodText(job, result)},
               {"mesher", result.mesher ? Json({{"method", tetvdb::nameOf(result.mesher->method)},
                                                {"why", textOf(result.mesher->why)}})
                                        : Json()},
               {"inside", nameOf(job.solid.inside)},
               {"cleaned", toJson(result.cleaned)}};
  if (!result.made)
    return mesh;
  mesh.update(toJson(*result.made));
  mesh["flipped"] = result.counts.flipped;
  mesh["dropped"] = result.counts.dropped;
  return mesh;
}

// The volume that a coverage holds, cubic units.
double filledVolume(const GridInfo& grid, double voxels) {
  const Vec3d& h = grid.transform.voxelSize;
  return voxels * h[0] * h[1] * h[2];
}

Json gridsOf(const VoxelizeResult& result) {
  Json list = toJson(result.grids);
  for (std::size_t i = 0; i < result.grids.size(); ++i)
    if (result.grids[i].name == "coverage") {
      list[i]["filled"] = filledVolume(result.grids[i], result.shapes.coverage.filled);
      list[i]["overlap"] = filledVolume(result.grids[i], result.shapes.coverage.overlap);
    } else if (result.grids[i].name == "surface" || result.grids[i].name == "fog") {
      const TrimCounts& trim = result.shapes.trim;
      list[i]["trim"] = {
          {"met", trim.met}, {"removed", trim.removed}, {"cut", trim.cut}, {"pieces", trim.pieces}};
    }
  return list;
}

Json outputsOf(const VoxelizeResult& result) {
  Json list = Json::array();
  for (const OutputInfo& output : result.outputs)
    list.push_back({{"path", output.path}, {"bytes", output.bytes}});
  return list;
}

void addDevices(const VoxelizeJob& job, const VoxelizeResult& result, TextOf textOf,
                Json& sections) {
  sections["device"] = result.device.name;
  Json& mesh = sections["mesh"];
  if (!result.device.why.empty())
    mesh["device_why"] = textOf(result.device.why);
  const auto add = [&](const std::string& key, const DeviceUsed& used) {
    mesh[key + "_device"] = used.name;
    if (!used.why.empty())
      mesh[key + "_device_why"] = textOf(used.why);
  };
  if (!job.fields.empty())
    add("fields", result.fieldsDevice);
  if (!madeBy(job.grids, {GridMaker::Distance}).empty())
    add("surface", result.shapes.device);
  if (!madeBy(job.grids, {GridMaker::Share}).empty())
    add("coverage", result.shapes.coverageDevice);
}

Json inputsOf(const TetrahedralizeResult& result) {
  Json list = Json::array();
  for (std::size_t i = 0; i < result.inputs.size(); ++i) {
    const InputInfo& input = result.inputs[i];
    list.push_back({{"path", input.path},
                    {"format", formatName(input.format)},
                    {"kind", "triangles"},
                    {"vertices", input.vertices},
                    {"triangles", input.triangles},
                    {"units", input.units.empty() ? Json() : Json(input.units)},
                    {"triangles_cleaned", result.cleanedFaces[i]},
                    {"repaired_faces", result.repairedFaces[i]},
                    {"cleaned", toJson(result.cleaned[i])}});
  }
  return list;
}

Json regionsOf(const TetrahedralizeResult& result) {
  Json list = Json::array();
  for (const auto& [number, tets] : result.mesh.tetsOfRegion)
    list.push_back({{"number", number}, {"name", regionName(result, number)}, {"tets", tets}});
  return list;
}

} // namespace

void addFrames(const std::vector<FrameResult>& results, Json& sections) {
  Json frames = Json::array(), outputs = Json::array();
  for (std::size_t i = 0; i < results.size(); ++i) {
    const FrameResult& frame = results[i];
    frames.push_back({{"frame", i + 1},
                      {"input", frame.frame.inputs},
                      {"time", frame.frame.time ? Json(*frame.frame.time) : Json()},
                      {"output", frame.output.path},
                      {"skipped", frame.skipped},
                      {"grids", toJson(frame.grids)}});
    outputs.push_back({{"path", frame.output.path}, {"bytes", frame.output.bytes}});
  }
  sections["frames"] = std::move(frames);
  sections["output"] = std::move(outputs);
  for (const FrameResult& frame : results)
    if (!frame.grids.empty()) {
      sections["grids"] = toJson(frame.grids);
      break;
    }
}

void addSections(const SequenceResult& result, Json& sections) {
  sections["transform"] = worldFromIndex(result.transform);
  addFrames(result.frames, sections);
  sections["frames_at_once"] = result.atOnce;
}

int threadsOf(int asked) {
  return asked > 0 ? asked : tbb::this_task_arena::max_concurrency();
}

std::string regionName(const TetrahedralizeResult& result, std::int32_t number) {
  const auto name = result.regionNames.find(number);
  return name == result.regionNames.end() ? "outside" : name->second;
}

Json toJson(const GridInfo& grid) {
  return {{"name", grid.name},
          {"type", grid.type},
          {"class", grid.gridClass},
          {"active_voxels", grid.activeVoxels},
          {"active_tiles", grid.activeTiles},
          {"leaves", grid.leaves},
          {"bytes", grid.bytes},
          {"volume", grid.volume},
          {"box", {{"min", grid.boxMin}, {"max", grid.boxMax}}},
          {"min", grid.activeVoxels == 0 ? Json() : Json(grid.minValue)},
          {"max", grid.activeVoxels == 0 ? Json() : Json(grid.maxValue)},
          {"voxel_size", grid.transform.voxelSize},
          {"origin", grid.transform.origin}};
}

Json toJson(const std::vector<GridInfo>& grids) {
  Json list = Json::array();
  for (const GridInfo& grid : grids)
    list.push_back(toJson(grid));
  return list;
}

Json toJson(const CleanCounts& cleaned) {
  return {{"weld_distance", cleaned.weldDistance},
          {"welded_points", cleaned.weldedPoints},
          {"unreferenced_points", cleaned.unreferencedPoints},
          {"degenerate_faces", cleaned.degenerateFaces},
          {"duplicate_faces", cleaned.duplicateFaces},
          {"inner_faces", cleaned.innerFaces},
          {"flipped_faces", cleaned.flippedFaces},
          {"flipped_parts", cleaned.flippedParts},
          {"closed_holes", cleaned.closedHoles},
          {"closing_faces", cleaned.closingFaces},
          {"inside_out", cleaned.insideOut},
          {"doubtful_orientation", cleaned.doubtful}};
}

Json worstTets(const Tetrahedralization& made) {
  constexpr std::size_t kMostListed = 20;
  Json worst = Json::array();
  for (std::size_t k = 0; k < std::min(kMostListed, made.badTets.size()); ++k)
    worst.push_back({{"energy", made.badTets[k].energy}, {"centre", made.badTets[k].centre}});
  return worst;
}

Json toJson(const MeshSummary& mesh) {
  const Tetrahedralization& made = mesh.made;
  const TwoSidedCheck& check = made.check;
  return {{"tets", mesh.tets},
          {"vertices", mesh.vertices},
          {"boundary_faces", made.boundaryFaces},
          {"volume", mesh.statistics.volume},
          {"epsilon_asked", made.epsilonAsked},
          {"epsilon_used", made.epsilonUsed},
          {"epsilon_reached", check.outToIn},
          {"edge_length", made.edgeLength},
          {"quality",
           {{"worst_energy", made.worstEnergy},
            {"mean_energy", made.meanEnergy},
            {"box_over_volume", mesh.boxOverVolume()},
            {"bad_tets", made.badTets.size()},
            {"worst_tets", worstTets(made)}}},
          {"passes", made.passes},
          {"simplified_faces", made.simplifiedFaces},
          {"inserted_faces", made.insertedFaces},
          {"not_inserted", made.notInserted},
          {"check",
           {{"out_to_in", check.outToIn},
            {"in_to_out", check.inToOut},
            {"owed_points", check.owedPoints},
            {"lost_points", check.lostPoints},
            {"volume", check.volume},
            {"winding_volume", check.windingVolume}}}};
}

nlohmann::ordered_json inputSection(const std::string& path, SolidSource source,
                                    const InputInfo* info) {
  nlohmann::ordered_json section = {{"path", path}, {"kind", nameOf(source)}};
  if (info != nullptr && source != SolidSource::Volume) {
    section["format"] = formatName(info->format);
    section["vertices"] = info->vertices;
  }
  return section;
}

void reportPreview(const std::optional<PreviewInfo>& preview, const std::string& path,
                   nlohmann::ordered_json& sections) {
  if (!preview)
    return;
  sections["preview"] = {{"path", path},
                         {"panels", preview->panels},
                         {"width", preview->width},
                         {"height", preview->height}};
}

Json preparedSection(const PreparedMesh& mesh, const std::string& folder) {
  return {{"path", folder},
          {"tets", mesh.input.tets},
          {"points", mesh.input.vertices},
          {"boundary_faces", mesh.counts.boundaryFaces},
          {"parts", mesh.buckets},
          {"most_tets", mesh.mostTets},
          {"stored_tets", mesh.storedTets},
          {"arrays", mesh.arrays},
          {"voxel_size", mesh.transform.voxelSize},
          {"origin", mesh.transform.origin},
          {"bytes", mesh.bytes}};
}

std::string methodText(const VoxelizeJob& job, const VoxelizeResult& result) {
  if (job.solid.shell > 0)
    return "shell";
  if (result.mesher && result.mesher->method != Mesher::Winding)
    return tetvdb::nameOf(result.mesher->method);
  if (job.solid.inside == InsideRule::Flood)
    return "flood";
  return result.openEdges == 0 ? "signed crossings" : "winding number";
}

Json sectionsOf(const VoxelizeJob& job, const VoxelizeResult& result, TextOf textOf) {
  Json sections = {
      {"device", "cpu"},
      {"threads", threadsOf(job.threads)},
      {"input", inputsOf(result)},
      {"mesh", result.holdsTriangles ? trianglesOf(job, result, textOf) : tetsOf(result)},
      {"stages", nullptr},
      {"transform", job.makesVolume() ? Json(worldFromIndex(result.transform)) : Json()},
      {"fit", nullptr},
      {"grids", gridsOf(result)},
      {"output", outputsOf(result)}};
  if (job.voxelize.fit.voxels > 0)
    sections["fit"] = {{"voxels", job.voxelize.fit.voxels}, {"padding", job.voxelize.fit.padding}};
  addDevices(job, result, textOf, sections);
  reportPreview(result.preview, job.preview, sections);
  return sections;
}

Json sectionsOf(const TetrahedralizeJob& job, const TetrahedralizeResult& result) {
  Json sections = {{"device", "cpu"},           {"threads", threadsOf(job.threads)},
                   {"input", inputsOf(result)}, {"mesh", toJson(result.mesh)},
                   {"stages", nullptr},         {"output", Json::array()}};
  Json& mesh = sections["mesh"];
  mesh["boolean"] =
      job.mesher.boolean == Boolean::Materials ? Json() : Json(result.regionNames.at(1));
  mesh["regions"] = regionsOf(result);
  if (!result.output.path.empty())
    sections["output"].push_back({{"path", result.output.path}, {"bytes", result.output.bytes}});
  reportPreview(result.preview, job.preview, sections);
  return sections;
}

std::string reportText(const std::string& command, Status status, const std::string& error,
                       const Report& report, const Json& sections) {
  Json all = {{"version", version()}, {"command", command}, {"status", static_cast<int>(status)}};
  if (!error.empty())
    all["error"] = error;
  for (const auto& [key, value] : sections.items())
    all[key] = value;
  if (all.contains("stages"))
    all["stages"] = stagesOf(report);
  all["warnings"] = warningsOf(report);
  // Paths and names may hold any bytes; what is no UTF-8 is replaced.
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace tetvdb::cli
