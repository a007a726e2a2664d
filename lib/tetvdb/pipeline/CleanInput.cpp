// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/CleanInput.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tetvdb {

CleanCounts cleanInput(TriangleMesh& mesh, const std::string& name, const CleanOptions& options,
                       Report& report, Progress& progress) {
  const CleanCounts counts = cleanTriangles(mesh, options, progress);
  if (mesh.triangles.empty())
    throw Error(Status::Invalid, name,
                "every face of the mesh is degenerate: two of its corners coincide");
  const std::string where = name.empty() ? "" : name + ": ";
  if (counts.insideOut)
    report.warn("inside-out", where + "the mesh was inside out and was reversed");
  else if (counts.flippedFaces > 0)
    report.warn("flipped-faces",
                fmt::format("{}{} of {} faces were inverted and have been reversed", where,
                            counts.flippedFaces, mesh.triangleCount()));
  if (counts.doubtful) {
    report.warn("doubtful-orientation",
                fmt::format("{}the orientation of faces is ambiguous: unchanged, the mesh has a "
                            "volume of about {:.4g}, with consistent neighbours {:.4g}; check "
                            "the result, or use `keep_orientation`",
                            where, counts.fileVolume, counts.turnedVolume));
    report.partial = true;
  }
  if (counts.open.sheets > 0)
    report.warn("sheets",
                fmt::format("{}open components that bound no volume: {}{} of {}; nothing of them "
                            "is inside; a shell of all faces, by voxelize or repair, has them",
                            where, counts.open.exact ? "" : "about ", counts.open.sheets,
                            counts.open.count));
  return counts;
}

CleanOptions cleaningFor(const SolidOptions& solid, CleanOptions options) {
  options.closeHoles = solid.closesHoles();
  return options;
}

WorldBox boxOf(const std::vector<TriangleMesh>& meshes) {
  WorldBox all;
  for (const TriangleMesh& mesh : meshes) {
    const WorldBox box = boxOfUsed(mesh.points, mesh.triangles);
    for (std::size_t k = 0; k < 3; ++k) {
      all.min[k] = std::min(all.min[k], box.min[k]);
      all.max[k] = std::max(all.max[k], box.max[k]);
    }
    all.finite = all.finite && box.finite;
  }
  return all;
}

double diagonalOf(const WorldBox& box) {
  return std::hypot(box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]);
}

} // namespace tetvdb
