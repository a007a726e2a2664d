// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CompactMesh.h"

#include <cstdint>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {

std::size_t dropFaces(TriangleMesh& mesh, const std::vector<char>& drops) {
  std::vector<std::uint32_t>& corners = mesh.triangles;
  const std::size_t faces = mesh.triangleCount();
  std::size_t kept = 0;
  for (std::size_t face = 0; face < faces; ++face) {
    if (drops[face] != 0)
      continue;
    for (std::size_t k = 0; k < 3; ++k)
      corners[3 * kept + k] = corners[3 * face + k];
    ++kept;
  }
  corners.resize(3 * kept);
  mesh.faceCount = kept;
  return faces - kept;
}

std::size_t dropUnusedPoints(TriangleMesh& mesh) {
  constexpr std::uint32_t kUsed = 1;
  std::vector<std::uint32_t> number(mesh.points.size(), 0);
  for (const std::uint32_t v : mesh.triangles)
    number[v] = kUsed;
  std::uint32_t kept = 0;
  for (std::size_t point = 0; point < number.size(); ++point) {
    if (number[point] != kUsed)
      continue;
    mesh.points[kept] = mesh.points[point];
    number[point] = kept++;
  }
  const std::size_t dropped = mesh.points.size() - kept;
  if (dropped == 0)
    return 0;
  mesh.points.resize(kept);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), 1 << 16),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i)
                        mesh.triangles[i] = number[mesh.triangles[i]];
                    });
  return dropped;
}

} // namespace tetvdb
