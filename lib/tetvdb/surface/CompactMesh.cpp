// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CompactMesh.h"

#include "tetvdb/core/ForEachIndex.h"

#include <algorithm>
#include <atomic>
#include <cstdint>

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
  std::vector<std::atomic<bool>> used(mesh.points.size());
  forEachIndex(mesh.triangles.size(), [&](std::size_t i) {
    std::atomic<bool>& own = used[mesh.triangles[i]];
    if (!own.load(std::memory_order_relaxed))
      own.store(true, std::memory_order_relaxed);
  });
  const std::size_t dropped =
      countWhere(used.size(), [&](std::size_t point) { return !used[point]; });
  if (dropped == 0)
    return 0;
  std::vector<std::uint32_t> number(used.size());
  std::uint32_t kept = 0;
  for (std::size_t point = 0; point < used.size(); ++point)
    if (used[point]) {
      mesh.points[kept] = mesh.points[point];
      number[point] = kept++;
    }
  mesh.points.resize(kept);
  forEachIndex(mesh.triangles.size(),
               [&](std::size_t i) { mesh.triangles[i] = number[mesh.triangles[i]]; });
  return dropped;
}

CopiedFaces copyFaces(const TriangleMesh& mesh, const std::vector<std::uint32_t>& faces) {
  CopiedFaces copied;
  std::vector<std::uint32_t>& corners = copied.mesh.triangles;
  for (const std::uint32_t face : faces)
    corners.insert(corners.end(), &mesh.triangles[3 * std::size_t(face)],
                   &mesh.triangles[3 * std::size_t(face)] + 3);
  std::vector<std::uint32_t>& points = copied.points;
  points = corners;
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  for (const std::uint32_t point : points)
    copied.mesh.points.push_back(mesh.points[point]);
  for (std::uint32_t& corner : corners)
    corner = static_cast<std::uint32_t>(std::lower_bound(points.begin(), points.end(), corner) -
                                        points.begin());
  copied.mesh.faceCount = copied.mesh.triangleCount();
  return copied;
}

} // namespace tetvdb
