// SPDX-License-Identifier: Apache-2.0
//
// Says what keeps a mesh from being a closed oriented manifold, by counting with plain maps.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/SelfIntersections.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb::meshes {

/// Empty for a mesh in which every edge has two faces with opposite directions, the faces around
/// every vertex hang together by its edges, no face has a corner twice and, if they are to be
/// `distinct`, no two vertices are equal as floats; else the first defect found.
inline std::string manifoldDefect(const TriangleMesh& mesh, bool distinct = true) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Edge, int> directed;
  std::vector<std::map<std::uint32_t, std::uint32_t>> links(mesh.points.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[i + k], b = mesh.triangles[i + (k + 1) % 3],
                          c = mesh.triangles[i + (k + 2) % 3];
      if (a == b)
        return "face " + std::to_string(i / 3) + " has a corner twice";
      if (++directed[{a, b}] > 1)
        return "edge " + std::to_string(a) + " - " + std::to_string(b) +
               " is run along twice in one direction";
      links[a][b] = c;
    }
  for (const auto& [edge, count] : directed)
    if (directed.count({edge.second, edge.first}) == 0)
      return "edge " + std::to_string(edge.first) + " - " + std::to_string(edge.second) +
             " is open";
  std::set<std::array<float, 3>> positions;
  for (std::size_t v = 0; v < links.size(); ++v) {
    if (links[v].empty())
      return "vertex " + std::to_string(v) + " has no faces";
    std::size_t steps = 1;
    for (std::uint32_t at = links[v].begin()->second; at != links[v].begin()->first;
         at = links[v].at(at))
      ++steps;
    if (steps != links[v].size())
      return "vertex " + std::to_string(v) + " has more than one fan";
    if (distinct &&
        !positions
             .insert({float(mesh.points[v][0]), float(mesh.points[v][1]), float(mesh.points[v][2])})
             .second)
      return "vertex " + std::to_string(v) + " equals another as floats";
  }
  return "";
}

/// Vertices - edges + faces.
inline long eulerCharacteristic(const TriangleMesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t a = mesh.triangles[i], b = mesh.triangles[i % 3 == 2 ? i - 2 : i + 1];
    edges.insert({std::min(a, b), std::max(a, b)});
  }
  return static_cast<long>(mesh.points.size()) - static_cast<long>(edges.size()) +
         static_cast<long>(mesh.triangleCount());
}

/// Pairs of faces that intersect, up to 1000.
inline std::size_t crossingsOf(const TriangleMesh& mesh) {
  Progress progress;
  return countIntersections(mesh.points, mesh.triangles, 1000, progress).pairs;
}

} // namespace tetvdb::meshes
