// SPDX-License-Identifier: Apache-2.0
#include "InfoTriangles.h"

#include "JsonReport.h"
#include "NumberText.h"
#include "OptionNames.h"
#include "tetvdb/pipeline/ReadInput.h"

#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string defectsText(const SurfaceDefects& defects, bool intersections) {
  std::string text =
      fmt::format("  vertices    {} ({} distinct, {} without faces)\n", defects.vertices,
                  defects.weldedVertices, defects.unreferencedVertices);
  text += fmt::format("  triangles   {} ({} without area, {} slivers, {} duplicates)\n",
                      defects.triangles, defects.degenerateFaces, defects.sliverFaces,
                      defects.duplicateFaces);
  text += fmt::format("  edges       {} open in {} {}, {} of three faces or more, {} between "
                      "opposite faces\n",
                      defects.boundaryEdges, defects.holes, defects.holes == 1 ? "hole" : "holes",
                      defects.nonManifoldEdges, defects.misorientedEdges);
  text += fmt::format("  components  {}", defects.components);
  if (defects.genus)
    text += fmt::format(", genus {}", *defects.genus);
  if (defects.nonManifoldVertices > 0)
    text += fmt::format(", touching themselves in {} vertices", defects.nonManifoldVertices);
  text += "\n";
  if (intersections)
    text += fmt::format(
        "  crossings   {}{} {} of faces\n", defects.selfIntersectionsComplete ? "" : "more than ",
        defects.selfIntersections, defects.selfIntersections == 1 ? "pair" : "pairs");
  return text;
}

std::string measuresText(const SurfaceDefects& defects, const std::string& units) {
  std::string text =
      fmt::format("  box         {} to {}\n  area        {:.7g}\n  volume      {:.7g}\n",
                  pointText(defects.boxMin, extentOf(defects.boxMin, defects.boxMax)),
                  pointText(defects.boxMax, extentOf(defects.boxMin, defects.boxMax)), defects.area,
                  defects.volume);
  const auto& shares = defects.windingShares;
  text += fmt::format("  winding     {:.1f} % of the box inside, {:.1f} % more than once, {:.1f} % "
                      "inside out\n",
                      100 * (shares[2] + shares[3]), 100 * shares[3], 100 * shares[0]);
  if (!units.empty())
    text += fmt::format("  units       {}\n", oneLine(units));
  else if (!defects.likelyUnit.empty())
    text += fmt::format("  units       {}, to judge by the size\n", defects.likelyUnit);
  return text + fmt::format("  verdict     {}\n", withOptionNames(verdict(defects)));
}

} // namespace

void describeTriangles(const std::string& path, const DefectOptions& options,
                       nlohmann::ordered_json& section, Session& session) {
  session.progress.stage("read");
  InputInfo info;
  const TriangleMesh mesh = readSoup(path, &info, session.report, session.progress);
  session.progress.stage("look");
  const SurfaceDefects defects = surfaceDefects(mesh, options, session.progress);
  const bool intersections = options.maxIntersections > 0;
  section = sectionOf(info, mesh, defects, intersections, withOptionNames);
  session.text += fmt::format("{}: {}\n", oneLine(path), formatName(info.format)) +
                  defectsText(defects, intersections) + measuresText(defects, mesh.units);
}

} // namespace tetvdb::cli
