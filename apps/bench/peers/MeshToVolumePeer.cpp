// SPDX-License-Identifier: Apache-2.0
#include "MeshToVolumePeer.h"

#include <openvdb/tools/MeshToVolume.h>

namespace tetvdb::bench {
namespace {

/// What meshToVolume reads a mesh through.
class MeshAdapter {
public:
  MeshAdapter(const TriangleMesh& mesh, const GridTransform& transform)
      : mesh_(mesh), transform_(transform) {}
  std::size_t polygonCount() const { return mesh_.triangleCount(); }
  std::size_t pointCount() const { return mesh_.points.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t face, std::size_t corner, openvdb::Vec3d& point) const {
    const Vec3d& p = mesh_.points[mesh_.triangles[3 * face + corner]];
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      point[k] = (p[axis] - transform_.origin[axis]) / transform_.voxelSize[axis];
    }
  }

private:
  const TriangleMesh& mesh_;
  const GridTransform& transform_;
};

} // namespace

openvdb::FloatGrid::Ptr meshToVolume(const TriangleMesh& mesh, const GridTransform& transform) {
  const auto space = openvdb::math::Transform::createLinearTransform(transform.voxelSize[0]);
  return openvdb::tools::meshToVolume<openvdb::FloatGrid>(MeshAdapter(mesh, transform), *space, 3,
                                                          3);
}

} // namespace tetvdb::bench
