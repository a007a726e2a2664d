// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/VoxelizeMaterials.h"

#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <tbb/task_arena.h>
#include <vector>

namespace tetvdb {
namespace {

std::vector<std::string> namesOf(const std::vector<TriangleMesh>& meshes) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < meshes.size(); ++i)
    names.push_back("mesh " + std::to_string(i + 1));
  return names;
}

VoxelizeOptions allGrids(int resolution) {
  VoxelizeOptions options;
  options.resolution = resolution;
  options.grids = {GridKind::Mask, GridKind::Material, GridKind::Density};
  return options;
}

Voxelization run(const std::vector<TriangleMesh>& meshes, const VoxelizeOptions& options,
                 Report& report, const SolidOptions& solid = {}) {
  Progress progress;
  return voxelizeMaterials(meshes, namesOf(meshes), solid, options, report, progress);
}

Voxelization run(const std::vector<TriangleMesh>& meshes, const VoxelizeOptions& options) {
  Report report;
  Voxelization made = run(meshes, options, report);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_FALSE(report.partial);
  return made;
}

template <typename GridType>
const GridType& gridOf(const Voxelization& made, std::size_t i) {
  return *openvdb::gridConstPtrCast<GridType>(made.volume.grids().all[i]);
}

TriangleMesh turned(TriangleMesh mesh) {
  return meshes::moved(std::move(mesh), [](const Vec3d& p) {
    const double c = std::cos(0.37), s = std::sin(0.37);
    const Vec3d q{c * p[0] - s * p[1] + 0.01234, s * p[0] + c * p[1] - 0.04321, p[2] + 0.0031};
    return Vec3d{q[0], c * q[1] - s * q[2], s * q[1] + c * q[2]};
  });
}

// Every voxel around the meshes against the definition: the first mesh whose winding number there,
// by the solid angles of its faces, is above a half.
void expectFirstOwner(const std::vector<TriangleMesh>& meshes, int resolution) {
  const Voxelization made = run(meshes, allGrids(resolution));
  const auto mask = gridOf<openvdb::BoolGrid>(made, 0).getConstAccessor();
  const auto material = gridOf<openvdb::Int32Grid>(made, 1).getConstAccessor();
  const auto density = gridOf<openvdb::FloatGrid>(made, 2).getConstAccessor();
  const double h = made.transform.voxelSize[0];
  Vec3d low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  for (const TriangleMesh& mesh : meshes)
    for (const Vec3d& p : mesh.points)
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], p[k] / h - 4);
        high[k] = std::max(high[k], p[k] / h + 4);
      }
  std::vector<std::uint64_t> owned(meshes.size());
  std::uint64_t active = 0;
  int wrong = 0, undecided = 0;
  for (int x = int(low[0]); x <= int(high[0]); ++x)
    for (int y = int(low[1]); y <= int(high[1]); ++y)
      for (int z = int(low[2]); z <= int(high[2]); ++z) {
        const openvdb::Coord at(x, y, z);
        active += material.isValueOn(at);
        int owner = -1;
        bool decided = true;
        for (std::size_t i = 0; i < meshes.size() && owner < 0 && decided; ++i) {
          const double w = meshes::windingNumberAt(meshes[i], {x * h, y * h, z * h});
          decided = std::abs(w - 0.5) > kBoundaryWindingError;
          if (w > 0.5)
            owner = int(i + 1);
        }
        if (!decided) {
          ++undecided;
          continue;
        }
        if (owner > 0)
          ++owned[std::size_t(owner - 1)];
        const bool right = material.getValue(at) == owner &&
                           material.isValueOn(at) == (owner > 0) &&
                           mask.isValueOn(at) == (owner > 0) && mask.getValue(at) == (owner > 0) &&
                           density.isValueOn(at) == (owner > 0) &&
                           density.getValue(at) == (owner > 0 ? 1.0f : 0.0f);
        if (!right && ++wrong < 5)
          ADD_FAILURE() << "voxel " << x << ' ' << y << ' ' << z << " belongs to " << owner
                        << ", not to " << material.getValue(at);
      }
  EXPECT_EQ(wrong, 0);
  EXPECT_LT(undecided, 200);
  EXPECT_EQ(gridOf<openvdb::Int32Grid>(made, 1).activeVoxelCount(), active) << "voxels far away";
  for (std::size_t i = 0; i < meshes.size(); ++i)
    EXPECT_GT(owned[i], 100u) << "mesh " << i + 1;
}

TEST(VoxelizeMaterials, Overlapping) {
  expectFirstOwner({turned(meshes::sphere({0.9, 0.9, 0.9}, 0.6)), turned(meshes::box()),
                    turned(meshes::torus())},
                   30);
}

TEST(VoxelizeMaterials, Nested) {
  const TriangleMesh core = turned(meshes::sphere({0.5, 0.5, 0.5}, 0.2));
  const TriangleMesh hull = turned(meshes::box());
  expectFirstOwner({core, hull}, 30);
  // A hull with a cavity that the other fills.
  TriangleMesh hollow = hull;
  meshes::append(hollow, meshes::flipped(core));
  expectFirstOwner({hollow, core}, 30);
}

TEST(VoxelizeMaterials, Open) {
  meshes::Random random(3);
  const auto open = [&](const Vec3d& centre) {
    return turned(meshes::without(meshes::sphere(centre, 1, 8),
                                  [&](std::size_t) { return random.unit() < 0.2; }));
  };
  expectFirstOwner({open({0, 0, 0}), open({0.7, 0.3, 0.1})}, 24);
}

// Boxes on the lattice of voxel centres: of two opposite faces through centres one has them.
TEST(VoxelizeMaterials, TouchingThroughVoxelCentres) {
  struct Cuboid {
    int low[3], high[3];
  };
  const std::vector<Cuboid> cuboids = {{{0, 0, 0}, {9, 10, 11}},
                                       {{9, 0, 0}, {20, 10, 11}},
                                       {{0, 10, 0}, {20, 17, 11}},
                                       {{-5, -5, -5}, {3, 3, 3}}};
  std::vector<TriangleMesh> meshes;
  for (const Cuboid& c : cuboids)
    meshes.push_back(meshes::box({double(c.low[0]), double(c.low[1]), double(c.low[2])},
                                 {double(c.high[0]), double(c.high[1]), double(c.high[2])}));
  VoxelizeOptions options = allGrids(0);
  options.voxelSize = {1, 1, 1};
  const Voxelization made = run(meshes, options);
  const auto material = gridOf<openvdb::Int32Grid>(made, 1).getConstAccessor();
  for (int x = -8; x < 24; ++x)
    for (int y = -8; y < 24; ++y)
      for (int z = -8; z < 24; ++z) {
        int owner = -1;
        for (std::size_t i = 0; i < cuboids.size() && owner < 0; ++i) {
          const Cuboid& c = cuboids[i];
          if (x >= c.low[0] && x < c.high[0] && y >= c.low[1] && y < c.high[1] && z >= c.low[2] &&
              z < c.high[2])
            owner = int(i + 1);
        }
        ASSERT_EQ(material.getValue(openvdb::Coord(x, y, z)), owner) << x << ' ' << y << ' ' << z;
      }
}

TEST(VoxelizeMaterials, IndependentOfFacesAndThreads) {
  const std::vector<TriangleMesh> meshes = {turned(meshes::sphere({0.9, 0.9, 0.9}, 0.6, 20)),
                                            turned(meshes::box())};
  const std::string expected = hash(run(meshes, allGrids(150)).volume);
  EXPECT_EQ(hash(run({meshes::shuffledFaces(meshes[0], 3), meshes[1]}, allGrids(150)).volume),
            expected);
  EXPECT_NE(hash(run({meshes[1], meshes[0]}, allGrids(150)).volume), expected);
  for (const int threads : {1, 3}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { EXPECT_EQ(hash(run(meshes, allGrids(150)).volume), expected); });
  }
}

// One mesh alone is what voxelize() makes of it, tiles included.
TEST(VoxelizeMaterials, OneMesh) {
  VoxelizeOptions options = allGrids(200);
  options.grids = {GridKind::Mask, GridKind::Density};
  Report report;
  Progress progress;
  const TriangleMesh mesh = turned(meshes::torus());
  EXPECT_EQ(hash(run({mesh}, options).volume),
            hash(voxelize(mesh, {}, options, report, progress).volume));
}

TEST(VoxelizeMaterials, SaysWhichMeshHasNoVoxel) {
  Report report;
  const Voxelization made = run({meshes::box(), meshes::sheet()}, allGrids(20), report);
  EXPECT_EQ(gridOf<openvdb::Int32Grid>(made, 1).activeVoxelCount(), 8000u);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].code, "no-voxels");
  EXPECT_EQ(report.warnings[0].text.rfind("mesh 2: ", 0), 0u) << report.warnings[0].text;
  EXPECT_TRUE(report.partial);
  SolidOptions shell;
  shell.shell = 0.2;
  Report told;
  EXPECT_GT(gridOf<openvdb::Int32Grid>(
                run({meshes::box(), meshes::sheet(4, 2)}, allGrids(20), told, shell), 1)
                .activeVoxelCount(),
            0u);
  EXPECT_FALSE(told.partial);
}

TEST(VoxelizeMaterials, Refuses) {
  const auto statusOf = [](const std::vector<TriangleMesh>& meshes,
                           const VoxelizeOptions& options) {
    Report report;
    try {
      run(meshes, options, report);
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  };
  EXPECT_EQ(statusOf({}, allGrids(10)), Status::Usage);
  EXPECT_EQ(statusOf({meshes::sheet(), meshes::sheet(4, 1)}, allGrids(10)), Status::Invalid);
  VoxelizeOptions options = allGrids(10);
  options.grids = {GridKind::TetId};
  EXPECT_EQ(statusOf({meshes::box()}, options), Status::Usage);
  options = allGrids(10);
  options.rule = VoxelRule::Any;
  EXPECT_EQ(statusOf({meshes::box()}, options), Status::Usage);
  options = allGrids(10);
  options.maxMemory = 1000;
  EXPECT_EQ(statusOf({meshes::box()}, options), Status::Limit);
}

} // namespace
} // namespace tetvdb
