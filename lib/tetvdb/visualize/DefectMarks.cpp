// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/DefectMarks.h"

#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/WeldPoints.h"

namespace tetvdb {
namespace {

constexpr Rgb kRed = {0.85F, 0.01F, 0.01F}, kYellow = {1, 0.72F, 0};

void markEdges(const TriangleMesh& mesh, DefectMarks& marks, Progress& progress) {
  const std::vector<std::uint32_t> corners = weldedCorners(mesh, progress);
  const EdgeTable edges(corners, mesh.points.size());
  progress.check();
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const std::size_t faces = edges.sides(edge).size();
    if (faces == 2)
      continue;
    ++(faces == 1 ? marks.openEdges : marks.nonManifoldEdges);
    marks.lines.push_back({mesh.points[edges.lowPoint(edge)], mesh.points[edges.highPoint(edge)],
                           faces == 1 ? kRed : kYellow});
  }
}

// Faces keep their order and their first corner when they are cleaned; some are gone, some turned.
void markFlipped(const TriangleMesh& mesh, DefectMarks& marks, Progress& progress) {
  TriangleMesh clean = mesh;
  CleanOptions options;
  options.weldDistance = 0; // points stay where they are
  cleanTriangles(clean, options, progress);
  marks.flipped.assign(mesh.triangleCount(), 0);
  const auto corner = [](const TriangleMesh& m, std::size_t face, std::size_t k) -> const Vec3d& {
    return m.points[m.triangles[3 * face + k]];
  };
  std::size_t kept = 0;
  for (std::size_t face = 0; face < mesh.triangleCount() && kept < clean.triangleCount(); ++face) {
    const Vec3d &a = corner(mesh, face, 0), &b = corner(mesh, face, 1), &c = corner(mesh, face, 2);
    if (corner(clean, kept, 0) != a)
      continue;
    const Vec3d &second = corner(clean, kept, 1), &third = corner(clean, kept, 2);
    if (second == b && third == c) {
      ++kept;
    } else if (second == c && third == b) {
      ++kept;
      marks.flipped[face] = 1;
      ++marks.flippedFaces;
    }
  }
}

} // namespace

DefectMarks markDefects(const TriangleMesh& mesh, Progress& progress) {
  DefectMarks marks;
  markEdges(mesh, marks, progress);
  markFlipped(mesh, marks, progress);
  return marks;
}

} // namespace tetvdb
