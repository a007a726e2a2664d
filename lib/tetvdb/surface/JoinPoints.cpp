// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/JoinPoints.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/DuplicateFaces.h"
#include "tetvdb/surface/EdgeTable.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace tetvdb {

std::size_t dropEqualFaces(TriangleMesh& mesh, bool allButOne) {
  std::vector<char> drops(mesh.triangleCount(), 0);
  {
    const EdgeTable edges(mesh);
    const DuplicateGroups groups = findDuplicates(edges);
    for (std::size_t i = 0; i < groups.count(); ++i) {
      std::array<std::vector<std::uint32_t>, 2> sides;
      for (std::uint32_t k = groups.first[i]; k < groups.first[i + 1]; ++k) {
        const std::uint32_t face = groups.faces[k];
        const std::uint32_t* c = &mesh.triangles[3 * std::size_t(face)];
        const auto min = static_cast<std::size_t>(std::min_element(c, c + 3) - c);
        const bool inverse = c[(min + 1) % 3] > c[(min + 2) % 3];
        sides[inverse ? 1 : 0].push_back(face);
        drops[face] = 1;
      }
      const std::size_t more = sides[1].size() > sides[0].size() ? 1 : 0;
      std::size_t left = sides[more].size() - sides[1 - more].size();
      if (allButOne)
        left = std::min<std::size_t>(left, 1);
      for (std::size_t k = 0; k < left; ++k)
        drops[sides[more][k]] = 0;
    }
  }
  return dropFaces(mesh, drops);
}

void joinPoints(TriangleMesh& mesh, const std::vector<std::uint32_t>& becomes) {
  std::vector<char> drops(mesh.triangleCount(), 0);
  for (std::size_t face = 0; face < drops.size(); ++face) {
    std::uint32_t* c = &mesh.triangles[3 * face];
    for (std::size_t k = 0; k < 3; ++k)
      c[k] = becomes[c[k]];
    drops[face] = c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
  }
  dropFaces(mesh, drops);
  dropEqualFaces(mesh, false);
  dropUnusedPoints(mesh);
}

ContractedEdges contractShortEdges(TriangleMesh& mesh, const std::vector<std::uint32_t>& corners,
                                   double limit) {
  const std::vector<Vec3d>& points = mesh.points;
  ContractedEdges contracted;
  std::vector<std::uint32_t> becomes(points.size());
  std::iota(becomes.begin(), becomes.end(), 0u);
  std::vector<char> isDone(points.size(), 0);
  for (std::size_t face = 0; face < corners.size(); face += 3) {
    std::uint32_t to = 0, from = 0;
    double min = limit;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corners[face + k], b = corners[face + (k + 1) % 3];
      if (const double edge = length(minus(points[b], points[a])); edge < min) {
        min = edge;
        to = std::min(a, b);
        from = std::max(a, b);
      }
    }
    if (to == from || isDone[to] != 0 || isDone[from] != 0)
      continue;
    isDone[to] = isDone[from] = 1;
    becomes[from] = to;
    ++contracted.edges;
    contracted.longest = std::max(contracted.longest, min);
  }
  if (contracted.edges > 0)
    joinPoints(mesh, becomes);
  return contracted;
}

} // namespace tetvdb
