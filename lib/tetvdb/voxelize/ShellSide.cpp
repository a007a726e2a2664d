// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/ShellSide.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/TriangleScene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

void addTo(Vec3d& sum, const Vec3d& v, double factor = 1) {
  for (std::size_t k = 0; k < 3; ++k)
    sum[k] += factor * v[k];
}

Vec3d unit(Vec3d v) {
  const double size = std::sqrt(dot(v, v));
  if (size > 0)
    for (double& c : v)
      c /= size;
  return v;
}

// Where on a triangle the point next to p lies: 0 to 2 a corner, 3 to 5 the edge from corner 0 to 2
// to the next one, 6 the face (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
int nearestFeature(const Vec3d& p, const std::array<Vec3d, 3>& t) {
  const Vec3d ab = minus(t[1], t[0]), ac = minus(t[2], t[0]);
  const Vec3d ap = minus(p, t[0]), bp = minus(p, t[1]), cp = minus(p, t[2]);
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0)
    return 0;
  if (d3 >= 0 && d4 <= d3)
    return 1;
  if (d6 >= 0 && d5 <= d6)
    return 2;
  if (d1 * d4 - d3 * d2 <= 0 && d1 >= 0 && d3 <= 0)
    return 3;
  if (d3 * d6 - d5 * d4 <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return 4;
  if (d5 * d2 - d1 * d6 <= 0 && d2 >= 0 && d6 <= 0)
    return 5;
  return 6;
}

class Sides {
public:
  Sides(const TriangleMesh& mesh, const SnappedMesh& snapped, const Vec3d& voxelSize)
      : mesh_(placed(mesh, snapped, voxelSize)), scene_(mesh_), faces_(mesh_.triangleCount()),
        corners_(mesh_.points.size()) {
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const std::array<Vec3d, 3> t = corners(f);
      faces_[f] = unit(cross(minus(t[1], t[0]), minus(t[2], t[0])));
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d u = unit(minus(t[(k + 1) % 3], t[k])), v = unit(minus(t[(k + 2) % 3], t[k]));
        const double angle = std::acos(std::clamp(dot(u, v), -1.0, 1.0));
        addTo(corners_[mesh_.triangles[3 * f + k]], faces_[f], angle);
        addTo(edges_[edge(f, k)], faces_[f]);
      }
    }
  }

  bool isInFront(const Vec3d& p, double within) const {
    TriangleScene::Closest closest = scene_.closest(p, within);
    if (closest.triangle >= faces_.size())
      closest = scene_.closest(p);
    const std::size_t face = closest.triangle;
    const std::array<Vec3d, 3> t = corners(face);
    const int feature = nearestFeature(p, t);
    const auto k = static_cast<std::size_t>(feature % 3);
    const Vec3d n = feature < 3   ? corners_[mesh_.triangles[3 * face + k]]
                    : feature < 6 ? edges_.at(edge(face, k))
                                  : faces_[face];
    // From a corner of what is nearest, to which n is normal.
    const double along = dot(n, minus(p, feature == 6 ? t[0] : t[k]));
    if (along != 0)
      return along > 0;
    for (const double c : n)
      if (c != 0)
        return c > 0;
    return true;
  }

private:
  // World units from voxel (0, 0, 0), as the rasteriser sees the points.
  static TriangleMesh placed(const TriangleMesh& mesh, const SnappedMesh& snapped,
                             const Vec3d& voxelSize) {
    TriangleMesh made;
    made.triangles = mesh.triangles;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      const LatticePoint& p = snapped.points[i];
      made.points.push_back({p.x * kVoxelsPerUnit * voxelSize[0],
                             p.y * kVoxelsPerUnit * voxelSize[1],
                             p.z * kVoxelsPerUnit * voxelSize[2]});
    }
    return made;
  }

  std::array<Vec3d, 3> corners(std::size_t face) const {
    return {mesh_.points[mesh_.triangles[3 * face]], mesh_.points[mesh_.triangles[3 * face + 1]],
            mesh_.points[mesh_.triangles[3 * face + 2]]};
  }

  std::pair<std::uint32_t, std::uint32_t> edge(std::size_t face, std::size_t k) const {
    const std::uint32_t a = mesh_.triangles[3 * face + k];
    const std::uint32_t b = mesh_.triangles[3 * face + (k + 1) % 3];
    return std::minmax(a, b);
  }

  TriangleMesh mesh_;
  TriangleScene scene_;
  std::vector<Vec3d> faces_, corners_; // normals
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3d> edges_;
};

} // namespace

void keepSide(openvdb::BoolTree& shell, const TriangleMesh& mesh, const SnappedMesh& snapped,
              const Vec3d& voxelSize, double farthest, bool inFront, Progress& progress) {
  const Sides sides(mesh, snapped, voxelSize);
  const double within = farthest * (1 + 1e-6);
  shell.voxelizeActiveTiles();
  std::vector<openvdb::BoolTree::LeafNodeType*> leaves;
  shell.getNodes(leaves);
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
    progress.check();
    for (auto voxel = leaves[i]->beginValueOn(); voxel; ++voxel) {
      const openvdb::Coord at = voxel.getCoord();
      const Vec3d p{at.x() * voxelSize[0], at.y() * voxelSize[1], at.z() * voxelSize[2]};
      if (sides.isInFront(p, within) != inFront)
        voxel.setValueOff();
    }
  });
}

} // namespace tetvdb
