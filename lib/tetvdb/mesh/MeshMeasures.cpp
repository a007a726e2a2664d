// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/MeshMeasures.h"

#include "tetvdb/geometry/VectorMath.h"

#include <cstddef>

namespace tetvdb {

Box boxOf(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& used) {
  Box box;
  for (const std::uint32_t point : used)
    box.add(points[point]);
  return box;
}

double areaOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const Vec3d& a = mesh.points[mesh.triangles[i]];
    sum += length(cross(minus(mesh.points[mesh.triangles[i + 1]], a),
                        minus(mesh.points[mesh.triangles[i + 2]], a)));
  }
  return sum / 2;
}

double volumeOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const Vec3d& origin = mesh.points[mesh.triangles[0]];
    sum += dot(minus(mesh.points[mesh.triangles[i]], origin),
               cross(minus(mesh.points[mesh.triangles[i + 1]], origin),
                     minus(mesh.points[mesh.triangles[i + 2]], origin)));
  }
  return sum / 6;
}

} // namespace tetvdb
