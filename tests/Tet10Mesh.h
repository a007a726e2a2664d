// SPDX-License-Identifier: Apache-2.0
//
// Ten-node tets made of four-node ones.
#pragma once

#include "tetvdb/mesh/CellMesh.h"
#include "tetvdb/mesh/TetMesh.h"

#include <algorithm>
#include <map>
#include <utility>

namespace tetvdb::meshes {

/// A node in the middle of every edge, then place(p) for every point.
template <typename Place>
CellMesh tet10(const TetMesh& linear, const Place& place) {
  CellMesh mesh;
  mesh.points = linear.points;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> mids;
  const auto mid = [&](std::uint32_t a, std::uint32_t b) {
    const auto key = std::minmax(a, b);
    const auto [at, fresh] = mids.try_emplace(key, static_cast<std::uint32_t>(mesh.points.size()));
    if (fresh) {
      Vec3d p{};
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = (linear.points[a][k] + linear.points[b][k]) / 2;
      mesh.points.push_back(p);
    }
    return at->second;
  };
  for (std::size_t t = 0; t < linear.tetCount(); ++t) {
    const std::uint32_t* v = linear.tets.data() + 4 * t;
    mesh.nodes.insert(mesh.nodes.end(), v, v + 4);
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 2), std::pair(0, 3),
                               std::pair(1, 3), std::pair(2, 3)})
      mesh.nodes.push_back(mid(v[a], v[b]));
  }
  for (Vec3d& p : mesh.points)
    p = place(p);
  mesh.runs.push_back({CellType::Tetra, 10, linear.tetCount(), "tetra10", true});
  return mesh;
}

} // namespace tetvdb::meshes
