// SPDX-License-Identifier: Apache-2.0
#include "DefectReport.h"

#include "tetvdb/io/Formats.h"

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

Json windingJson(const SurfaceDefects& defects) {
  const auto& shares = defects.windingShares;
  return {{"inside_out", shares[0]},
          {"outside", shares[1]},
          {"inside", shares[2]},
          {"inside_more_than_once", shares[3]}};
}

} // namespace

Json toJson(const SurfaceDefects& defects, bool intersections) {
  return {
      {"duplicate_vertices", defects.duplicateVertices},
      {"unreferenced_vertices", defects.unreferencedVertices},
      {"degenerate_faces", defects.degenerateFaces},
      {"sliver_faces", defects.sliverFaces},
      {"duplicate_faces", defects.duplicateFaces},
      {"boundary_edges", defects.boundaryEdges},
      {"nonmanifold_edges", defects.nonManifoldEdges},
      {"misoriented_edges", defects.misorientedEdges},
      {"nonmanifold_vertices", defects.nonManifoldVertices},
      {"holes", defects.holes},
      {"components", defects.components},
      {"orientable", defects.orientable},
      {"watertight", defects.watertight},
      {"genus", defects.genus ? Json(*defects.genus) : Json()},
      {"self_intersections", intersections ? Json(defects.selfIntersections) : Json()},
      {"self_intersections_complete", intersections && defects.selfIntersectionsComplete},
  };
}

Json sectionOf(const InputInfo& info, const TriangleMesh& mesh, const SurfaceDefects& defects,
               bool intersections, TextOf textOf) {
  return {{"path", info.path},
          {"format", formatName(info.format)},
          {"kind", "triangles"},
          {"vertices", defects.vertices},
          {"triangles", defects.triangles},
          {"defects", toJson(defects, intersections)},
          {"box", {{"min", defects.boxMin}, {"max", defects.boxMax}}},
          {"area", defects.area},
          {"volume", defects.volume},
          {"winding", windingJson(defects)},
          {"units", mesh.units},
          {"likely_units", defects.likelyUnit},
          {"verdict", textOf(verdict(defects))}};
}

} // namespace tetvdb::cli
