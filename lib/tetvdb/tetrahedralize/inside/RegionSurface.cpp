// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/inside/RegionSurface.h"

#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/SortedTetFaces.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/inside/Regions.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

RegionSurface regionSurface(const TetMesh& mesh, Progress& progress) {
  RegionSurface surface;
  surface.mesh.points = mesh.points;
  std::vector<std::uint32_t> tets;
  std::vector<std::int32_t> regions;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    const std::int32_t region = mesh.regions.empty() ? 1 : mesh.regions[mesh.cell(t)];
    if (region == kOutsideRegion)
      continue;
    std::array<std::uint32_t, 4> corners{};
    std::copy_n(mesh.tets.begin() + static_cast<std::ptrdiff_t>(4 * t), 4, corners.begin());
    const auto at = [&](std::size_t i) -> const Vec3d& { return mesh.points[corners[i]]; };
    if (orientation(at(0), at(1), at(2), at(3)) < 0)
      std::swap(corners[2], corners[3]);
    surface.volume += dot(cross(minus(at(1), at(0)), minus(at(2), at(0))), minus(at(3), at(0))) / 6;
    tets.insert(tets.end(), corners.begin(), corners.end());
    regions.push_back(region);
  }
  progress.check();

  const auto faces = sortedTetFaces(
      tets.data(), regions.size(), [](const TetFace&) { return true; }, progress);
  std::vector<std::uint32_t> between;
  forEqualFaces(faces, [&](const TetFace* first, const TetFace* last) {
    const bool outer = last == first + 1;
    if (!outer && std::all_of(first, last, [&](const TetFace& face) {
          return regions[face.tet] == regions[first->tet];
        }))
      return;
    for (const std::uint8_t corner : kFaceCorners[first->opposite])
      (outer ? surface.mesh.triangles : between)
          .push_back(tets[4 * std::size_t(first->tet) + corner]);
  });
  surface.outerFaces = surface.mesh.triangleCount();
  surface.mesh.triangles.insert(surface.mesh.triangles.end(), between.begin(), between.end());
  surface.mesh.faceCount = surface.mesh.triangleCount();
  return surface;
}

} // namespace tetvdb
