// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FeatureEdges.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/EdgeTable.h"

#include <cmath>

namespace tetvdb {
namespace {

Vec3d normalOf(const TriangleMesh& mesh, std::uint32_t face) {
  const std::uint32_t* v = &mesh.triangles[3 * std::size_t(face)];
  return cross(minus(mesh.points[v[1]], mesh.points[v[0]]),
               minus(mesh.points[v[2]], mesh.points[v[0]]));
}

} // namespace

std::vector<VertexPair> featureEdges(const TriangleMesh& mesh, double degrees) {
  const double min = std::cos(degrees * 3.14159265358979323846 / 180);
  const EdgeTable edges(mesh);
  std::vector<VertexPair> found;
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const EdgeTable::Sides sides = edges.sides(edge);
    const VertexPair ends{edges.lowPoint(edge), edges.highPoint(edge)};
    bool isSharp = sides.size() != 2;
    if (!isSharp) {
      const Vec3d a = normalOf(mesh, EdgeTable::faceOf(sides[0]));
      const Vec3d b = normalOf(mesh, EdgeTable::faceOf(sides[1]));
      isSharp = dot(a, b) < min * length(a) * length(b);
    }
    if (isSharp)
      found.push_back(ends);
  }
  return found;
}

} // namespace tetvdb
