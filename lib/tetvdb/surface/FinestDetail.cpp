// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FinestDetail.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/surface/TriangleScene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kSamples = 2000;
constexpr std::size_t kThinnest = kSamples / 50;
constexpr double kPerThickness = 3;  ///< voxels
constexpr double kCoarsest = 256;    ///< voxels along the longest side
constexpr double kFacesPerVoxel = 3; ///< of marching cubes, over the surface's area
constexpr double kOffSurface = 1e-6; ///< of the box's diagonal: where a ray begins

double twiceArea(const TriangleMesh& mesh, std::size_t face) {
  const std::uint32_t* v = &mesh.triangles[3 * face];
  return length(cross(minus(mesh.points[v[1]], mesh.points[v[0]]),
                      minus(mesh.points[v[2]], mesh.points[v[0]])));
}

} // namespace

double finestThickness(const TriangleMesh& mesh, Progress& progress) {
  const TriangleScene scene(mesh);
  const Box box = boxOf(mesh.points, mesh.triangles);
  const double diagonal = length(minus(box.high, box.low));
  const double step = areaOf(mesh) / static_cast<double>(kSamples);
  std::vector<double> thickness;
  std::vector<TriangleScene::Hit> hits;
  double passed = 0, next = step / 2;
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face) {
    passed += twiceArea(mesh, face) / 2;
    for (; next < passed && thickness.size() < kSamples; next += step) {
      progress.check();
      // The R2 sequence (Roberts 2018), reflected into the triangle.
      const auto i = static_cast<double>(thickness.size() + 1);
      double u = std::fmod(i * 0.7548776662466927, 1.0), v = std::fmod(i * 0.5698402909980532, 1.0);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const std::uint32_t* c = &mesh.triangles[3 * face];
      const Vec3d &a = mesh.points[c[0]], ab = minus(mesh.points[c[1]], a),
                  ac = minus(mesh.points[c[2]], a);
      const Vec3d inward = times(scene.normal(static_cast<std::uint32_t>(face)), -1);
      const Vec3d from =
          plus(plus(a, plus(times(ab, u), times(ac, v))), times(inward, kOffSurface * diagonal));
      scene.crossings(from, inward, diagonal, hits);
      thickness.push_back(std::numeric_limits<double>::infinity());
      for (const TriangleScene::Hit& hit : hits)
        if (hit.leaving && hit.triangle != face) {
          thickness.back() = hit.t + kOffSurface * diagonal;
          break;
        }
    }
  }
  if (thickness.size() <= kThinnest)
    return std::numeric_limits<double>::infinity();
  std::nth_element(thickness.begin(), thickness.begin() + kThinnest, thickness.end());
  return thickness[kThinnest];
}

double voxelForDetail(const TriangleMesh& mesh, std::size_t maxFaces, Progress& progress) {
  const Box box = boxOf(mesh.points, mesh.triangles);
  const Vec3d size = minus(box.high, box.low);
  const double longest = std::max({size[0], size[1], size[2]});
  if (!(longest > 0))
    throw Error(Status::Invalid, "", "the mesh has no extent");
  const double smallest = std::sqrt(kFacesPerVoxel * areaOf(mesh) /
                                    static_cast<double>(std::max<std::size_t>(maxFaces, 1)));
  return std::min(longest / kCoarsest,
                  std::max(finestThickness(mesh, progress) / kPerThickness, smallest));
}

} // namespace tetvdb
