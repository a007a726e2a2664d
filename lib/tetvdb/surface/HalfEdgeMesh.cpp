// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/HalfEdgeMesh.h"

#include <algorithm>

namespace tetvdb {

bool addClosedManifold(HalfEdgeMesh& mesh, std::size_t vertices,
                       const std::vector<std::uint32_t>& corners) {
  mesh.reserve(vertices, corners.size() / 2, corners.size() / 3);
  for (std::size_t v = 0; v < vertices; ++v)
    mesh.add_vertex(HalfEdgeMesh::Point(0, 0, 0));
  const auto vertex = [&](std::size_t corner) {
    return HalfEdgeMesh::VertexHandle(static_cast<int>(corners[corner]));
  };
  for (std::size_t i = 0; i < corners.size(); i += 3)
    if (!mesh.add_face(vertex(i), vertex(i + 1), vertex(i + 2)).is_valid())
      return false;
  return std::none_of(mesh.edges_begin(), mesh.edges_end(),
                      [&](HalfEdgeMesh::EdgeHandle edge) { return mesh.is_boundary(edge); });
}

} // namespace tetvdb
