// SPDX-License-Identifier: Apache-2.0
#include "SampleMeshes.h"

#include "Meshes.h"
#include "TriangleMeshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace tetvdb::bench {

TetMesh blockMesh(double tets) {
  const int n = std::max(1, static_cast<int>(std::round(std::cbrt(tets / 6))));
  return meshes::jittered(meshes::kuhnGrid(n, n, n), 0.2, 1);
}

TetMesh ballMesh(double tets) {
  const int n = std::max(2, static_cast<int>(std::round(std::cbrt(tets / 6))));
  return meshes::ball(n, 1.0, {0.01, 0.02, 0.03});
}

TriangleMesh bumpySphere(double faces) {
  const int n = std::max(2, static_cast<int>(std::round(std::sqrt(faces / 8))));
  return meshes::moved(meshes::sphere({0, 0, 0}, 1, n), [](const Vec3d& p) {
    const double radius = 1 + 0.05 * std::sin(9 * p[0]) * std::sin(11 * p[1]) * std::sin(10 * p[2]);
    return Vec3d{radius * p[0] + 0.01, radius * p[1] + 0.02, radius * p[2] + 0.03};
  });
}

void numberCells(TetMesh& mesh) {
  std::vector<std::int32_t> ids(mesh.tetCount());
  std::iota(ids.begin(), ids.end(), 0);
  mesh.cellCount = mesh.tetCount();
  mesh.attributes.push_back({"tet_id", Attribute::On::Cells, 1, std::move(ids)});
}

} // namespace tetvdb::bench
