// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SurfaceDefects.h"

#include <cmath>
#include <fmt/format.h>
#include <string>
#include <vector>

namespace tetvdb {
namespace {

// Minimum volume over area^1.5 of an open surface that is not a sheet, as in
// cleanTriangles().
constexpr double kMinVolume = 0.02;

std::string count(std::size_t n, const char* one, const char* several) {
  return fmt::format("{} {}", n, n == 1 ? one : several);
}

std::string crossings(const SurfaceDefects& defects) {
  return fmt::format("{}{}", defects.selfIntersectionsComplete ? "" : "more than ",
                     count(defects.selfIntersections, "pair of faces", "pairs of faces"));
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts)
    text += (text.empty() ? "" : ", ") + part;
  return text;
}

// Without sample points (`windingSamples` 0) only the volume decides.
bool isSheet(const SurfaceDefects& defects) {
  return defects.windingShares[0] + defects.windingShares[2] + defects.windingShares[3] == 0 &&
         std::abs(defects.volume) <= kMinVolume * std::pow(defects.area, 1.5);
}

bool isDoubled(const SurfaceDefects& defects) {
  return 2 * defects.duplicateFaces >= defects.triangles - defects.degenerateFaces;
}

std::string verdictOnClosed(const SurfaceDefects& defects) {
  std::vector<std::string> but;
  if (isDoubled(defects))
    but.push_back("every face is duplicated");
  else if (defects.volume < 0)
    but.push_back("inside out");
  if (defects.selfIntersections > 0)
    but.push_back("self-intersecting (" + crossings(defects) + ")");
  if (!isDoubled(defects) && defects.nonManifoldEdges > 0)
    but.push_back("not manifold (" + count(defects.nonManifoldEdges, "edge", "edges") +
                  " of three faces or more)");
  if (but.empty())
    return "watertight";
  const bool turned = !isDoubled(defects) && defects.volume < 0;
  return "watertight, but " + joined(but) + "; " +
         (turned                          ? "it is reversed when it is voxelized"
          : isDoubled(defects)            ? "one of each is kept"
          : defects.selfIntersections > 0 ? "the solid is the union of what it surrounds"
                                          : "the solid is unambiguous");
}

void addEdgesAndCrossings(const SurfaceDefects& defects, std::vector<std::string>& issues) {
  if (defects.misorientedEdges > 0)
    issues.push_back(count(defects.misorientedEdges, "edge", "edges") + " between opposite faces");
  if (defects.nonManifoldEdges > 0)
    issues.push_back(count(defects.nonManifoldEdges, "edge", "edges") + " of three faces or more");
  if (defects.selfIntersections > 0)
    issues.push_back(crossings(defects) + " that cross");
}

std::string verdictOnOpen(const SurfaceDefects& defects) {
  const std::string open =
      count(defects.boundaryEdges, "open edge", "open edges") +
      (defects.holes == 0 ? std::string() : " in " + count(defects.holes, "hole", "holes"));
  const std::size_t faces = defects.triangles - defects.degenerateFaces;
  if (faces > 1 && defects.boundaryEdges >= 3 * faces)
    return "loose triangles: no two share an edge; if they nearly do, weld them";
  if (!defects.orientable)
    return "open and not orientable, without inside (" + open + "); give it thickness with `shell`";
  if (isSheet(defects))
    return "a sheet without inside (" + open + "); give it thickness with `shell`";
  std::vector<std::string> issues{open};
  if (defects.volume < -kMinVolume * std::pow(defects.area, 1.5))
    issues.emplace_back("inside out");
  addEdgesAndCrossings(defects, issues);
  return "not watertight: " + joined(issues) + "; the solid is closed by winding number";
}

// No boundary edges, but the directions of the faces at some edges do not balance.
std::string verdictOnUnbalanced(const SurfaceDefects& defects) {
  std::vector<std::string> issues;
  addEdgesAndCrossings(defects, issues);
  const char* advice = !defects.orientable ? "it is not orientable and has no inside"
                       : defects.nonManifoldEdges > 0
                           ? "faces are reversed and the solid is found by winding number"
                           : "faces are reversed when it is voxelized";
  return fmt::format("closed, but {}: {}; {}",
                     defects.misorientedEdges > 0 ? "with flipped faces" : "not manifold",
                     joined(issues), advice);
}

} // namespace

std::string verdict(const SurfaceDefects& defects) {
  if (defects.triangles == 0)
    return "empty: no triangles";
  if (defects.degenerateFaces == defects.triangles)
    return "nothing to voxelize: no face has an area";
  if (defects.watertight)
    return verdictOnClosed(defects);
  return defects.boundaryEdges > 0 ? verdictOnOpen(defects) : verdictOnUnbalanced(defects);
}

} // namespace tetvdb
