// SPDX-License-Identifier: Apache-2.0
#include "CentroidCovering.h"
#include "TriangleMeshes.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <set>

namespace tetvdb::bench {
namespace {

constexpr double kVoxel = 0.125;

VoxelizeOptions maskOptions() {
  VoxelizeOptions options;
  options.voxelSize = {kVoxel, kVoxel, kVoxel};
  options.grids = {GridKind::Mask};
  options.allowEmpty = true;
  return options;
}

using Voxels = std::set<openvdb::Coord>;

Voxels voxelsOf(const Voxelization& made) {
  Voxels voxels;
  const auto mask = openvdb::gridConstPtrCast<openvdb::BoolGrid>(made.volume.grids().all.front());
  for (auto value = mask->cbeginValueOn(); value; ++value) {
    openvdb::CoordBBox box;
    value.getBoundingBox(box);
    for (auto voxel = box.begin(); voxel != box.end(); ++voxel)
      voxels.insert(*voxel);
  }
  return voxels;
}

Voxels voxelsOf(const TriangleMesh& mesh, InsideRule rule) {
  Report report;
  Progress progress;
  SolidOptions solid;
  solid.inside = rule;
  return voxelsOf(voxelize(mesh, solid, maskOptions(), report, progress));
}

// Turned, so that no voxel centre lies on a face.
TriangleMesh generic(TriangleMesh mesh) {
  return meshes::moved(std::move(mesh), [](const Vec3d& p) {
    const double c = std::cos(0.37), s = std::sin(0.37);
    return Vec3d{c * p[0] - s * p[1] + 0.01234, s * p[0] + c * p[1] - 0.04321, p[2] + 0.0031};
  });
}

TEST(CentroidCovering, IsRightForClosedMeshes) {
  for (const TriangleMesh& mesh : {meshes::sphere(), meshes::torus(), meshes::box()})
    EXPECT_EQ(voxelsOf(centroidCovering(generic(mesh)), InsideRule::Parity),
              voxelsOf(generic(mesh), InsideRule::Winding));
}

// The covering itself: a voxel is inside where an odd number of the tets (face, centroid) hold it.
// The tets are voxelized one by one.
TEST(CentroidCovering, IsTheParityOfItsTets) {
  TriangleMesh open = generic(meshes::sphere());
  open.triangles.resize(open.triangles.size() / 3 / 5 * 4 * 3);
  const TriangleMesh covering = centroidCovering(open);
  Voxels odd;
  for (std::size_t face = 0; face < open.triangleCount(); ++face) {
    TetMesh tet;
    for (std::size_t corner = 0; corner < 3; ++corner)
      tet.points.push_back(open.points[open.triangles[3 * face + corner]]);
    tet.points.push_back(covering.points.back());
    tet.tets = {0, 1, 2, 3};
    tet.cellCount = 1;
    Report report;
    Progress progress;
    for (const openvdb::Coord& voxel : voxelsOf(voxelize(tet, maskOptions(), report, progress)))
      if (!odd.insert(voxel).second)
        odd.erase(voxel);
  }
  EXPECT_EQ(voxelsOf(covering, InsideRule::Parity), odd);
  EXPECT_GT(odd.size(), 500u);
}

} // namespace
} // namespace tetvdb::bench
