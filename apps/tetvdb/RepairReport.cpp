// SPDX-License-Identifier: Apache-2.0
#include "DefectReport.h"
#include "JobReport.h"
#include "tetvdb/io/Formats.h"

#include <utility>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

Json localOf(const LocalRepair& local) {
  Json holes = Json::array();
  for (const FilledHole& hole : local.holes)
    holes.push_back({{"edges", hole.edges}, {"faces", hole.faces}, {"points", hole.points}});
  return {{"succeeded", local.succeeded},
          {"double_faces", local.doubleFaces},
          {"joined_points", local.stitched.joinedPoints},
          {"split_faces", local.stitched.splitFaces},
          {"flipped_collinear_faces", local.stitched.flippedFaces},
          {"sheets", local.sheets.parts},
          {"sheet_faces", local.sheets.faces},
          {"holes", holes},
          {"cut_faces", local.crossings.cutFaces},
          {"removed_faces", local.crossings.removedFaces},
          {"separated_points", local.separatedPoints},
          {"rounded_to_floats", local.roundsToFloats},
          {"aligned_points", local.alignedPoints},
          {"largest_move", local.largestMove},
          {"solid_lost", local.solids.lost},
          {"solid_gained", local.solids.gained}};
}

Json changesOf(const RepairResult& result) {
  const bool measured = result.distance.has_value();
  return {{"kept", result.changes->kept},
          {"added", result.changes->added},
          {"removed", result.changes->removed},
          {"distance_from_input", measured ? result.distance->aToB.largest : 0.0},
          {"distance_to_input", measured ? result.distance->bToA.largest : 0.0}};
}

Json finishedOf(const FinishResult& finished) {
  Json smoothed;
  if (finished.smoothed)
    smoothed = {{"moved", finished.smoothed->moved},
                {"held", finished.smoothed->held},
                {"backed_off", finished.smoothed->backed},
                {"largest_move", finished.smoothed->largest}};
  return {{"smoothed", smoothed},
          {"triangles_before", finished.simplified ? Json(finished.facesBefore) : Json()},
          {"distance", finished.distance}};
}

Json roundedOf(const FloatRounding& rounded) {
  return {{"points", rounded.roundedPoints},       {"crossing_faces", rounded.crossingFaces},
          {"flipped_edges", rounded.flippedEdges}, {"contracted_edges", rounded.contractedEdges},
          {"moved_points", rounded.movedPoints},   {"largest_move", rounded.largestMove},
          {"complete", rounded.complete},          {"crossings", rounded.crossings}};
}

Json repairOf(const RepairResult& result, TextOf textOf) {
  if (!result.objects.empty()) {
    Json objects = Json::array();
    for (const RepairResult& object : result.objects)
      objects.push_back(repairOf(object, textOf));
    return {{"source", nameOf(result.source)},
            {"remeshed", result.remeshed},
            {"objects", objects},
            {"changes", result.changes ? changesOf(result) : Json()},
            {"triangles", result.triangles},
            {"vertices", result.vertices},
            {"units", result.units.empty() ? Json() : Json(result.units)},
            {"volume_before", result.volumeBefore},
            {"volume", result.volumeAfter}};
  }
  const bool isMesh = result.source != SolidSource::Volume;
  const bool hasGrid = isMesh && result.remeshed;
  return {{"name", result.name.empty() ? Json() : Json(result.name)},
          {"source", nameOf(result.source)},
          {"remeshed", result.remeshed},
          {"why", result.why.empty() ? Json() : Json(textOf(result.why))},
          {"local", result.local ? localOf(*result.local) : Json()},
          {"changes", result.changes ? changesOf(result) : Json()},
          {"cleaned", isMesh ? toJson(result.cleaned) : Json()},
          {"verdict", isMesh ? Json(textOf(verdict(*result.before))) : Json()},
          {"defects", isMesh ? toJson(*result.before, true) : Json()},
          {"voxel_size", hasGrid ? Json(result.transform.voxelSize) : Json()},
          {"triangles_before", isMesh ? Json(result.before->triangles) : Json()},
          {"triangles_extracted", result.remeshed ? Json(result.extracted) : Json()},
          {"finished", result.finished ? finishedOf(*result.finished) : Json()},
          {"rounded", result.rounded ? roundedOf(*result.rounded) : Json()},
          {"triangles", result.triangles},
          {"vertices", result.vertices},
          {"units", result.units.empty() ? Json() : Json(result.units)},
          {"volume_before", isMesh ? Json(result.volumeBefore) : Json()},
          {"volume", result.volumeAfter}};
}

} // namespace

Json sectionsOf(const RepairJob& job, const RepairResult& result, TextOf textOf) {
  Json inputs = Json::array(
      {inputSection(job.input, result.source, job.more.empty() ? &result.input : nullptr)});
  for (const std::string& path : job.more)
    inputs.push_back({{"path", path}});
  Json sections = {{"device", "cpu"},
                   {"threads", threadsOf(job.threads)},
                   {"input", std::move(inputs)},
                   {"repair", repairOf(result, textOf)},
                   {"stages", nullptr},
                   {"output", Json::array()}};
  if (!result.output.path.empty())
    sections["output"].push_back({{"path", result.output.path}, {"bytes", result.output.bytes}});
  reportPreview(result.preview, job.preview, sections);
  return sections;
}

} // namespace tetvdb::cli
