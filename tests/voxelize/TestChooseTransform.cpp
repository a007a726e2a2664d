// SPDX-License-Identifier: Apache-2.0
#include "Meshes.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <rapidcheck/gtest.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

WorldBox boxOf(const Vec3d& min, const Vec3d& max) {
  WorldBox box;
  box.min = min;
  box.max = max;
  return box;
}

double longestOf(const WorldBox& box) {
  return std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]});
}

WorldBox randomBox(meshes::Random& random) {
  WorldBox box;
  const double far = std::pow(10, random.between(-3, 7));
  const double size = std::pow(10, random.between(-2, 3));
  for (std::size_t k = 0; k < 3; ++k) {
    box.min[k] = random.between(-far, far);
    box.max[k] = box.min[k] + size * random.unit();
    if (random.below(3) == 0) { // as files that hold floats
      box.min[k] = static_cast<float>(box.min[k]);
      box.max[k] = static_cast<float>(box.max[k]);
    }
    if (random.below(3) == 0) // of one length on all axes, but for rounding
      box.max[k] = box.min[k] + size;
  }
  return box;
}

// Whole numbers of 2^-20 voxels, found in long doubles.
std::int64_t units(double world, double origin, double size) {
  return std::llrint(
      static_cast<double>((static_cast<long double>(world) - static_cast<long double>(origin)) /
                          static_cast<long double>(size) * 1048576.0L));
}

// Voxel centres c with low <= c < high.
std::int64_t centresBetween(std::int64_t low, std::int64_t high) {
  const auto firstFrom = [](std::int64_t u) {
    return u >= 0 ? (u + 1048575) / 1048576 : -(-u / 1048576);
  };
  return firstFrom(high) - firstFrom(low);
}

TEST(ChooseTransform, NeverMoreVoxelsThanAskedFor) {
  meshes::Random random(1);
  int most = 0;
  for (int i = 0; i < 20000; ++i) {
    const WorldBox box = randomBox(random);
    VoxelizeOptions options;
    options.resolution = 1 + int(random.below(i % 2 == 0 ? 40 : 2000));
    const double longest = longestOf(box);
    const double largest =
        std::max({std::abs(box.min[0]), std::abs(box.max[0]), std::abs(box.min[1]),
                  std::abs(box.max[1]), std::abs(box.min[2]), std::abs(box.max[2])});
    if (!(longest > 1e-7 * largest && longest > 2e-5 * options.resolution))
      continue; // has no digits for voxels, or OpenVDB none that small
    const GridTransform transform = chooseTransform(box, options);
    const double h = transform.voxelSize[0];
    EXPECT_EQ(h, transform.voxelSize[1]);
    EXPECT_EQ(h, transform.voxelSize[2]);
    EXPECT_GE(h * options.resolution, longest * (1 - 1e-15));
    EXPECT_LE(h * options.resolution, longest * (1 + 8e-6)) << "wasteful";
    std::int64_t found = 0;
    for (std::size_t k = 0; k < 3; ++k)
      found = std::max(found, centresBetween(units(box.min[k], transform.origin[k], h),
                                             units(box.max[k], transform.origin[k], h)));
    ASSERT_LE(found, options.resolution) << "case " << i;
    most += found == options.resolution;
  }
  EXPECT_GT(most, 10000) << "resolutions are not reached";
}

TEST(ChooseTransform, SizesThatAreExactStay) {
  VoxelizeOptions options;
  options.resolution = 128;
  EXPECT_EQ(chooseTransform(boxOf({-5, -5, -5}, {5, 5, 5}), options).voxelSize[0], 10.0 / 128);
  EXPECT_EQ(chooseTransform(boxOf({0.5, 0, 0}, {1.5, 1, 1}), options).voxelSize[0], 1.0 / 128);
  options.resolution = 100;
  EXPECT_EQ(chooseTransform(boxOf({0, 0, 0}, {1, 1, 1}), options).voxelSize[0], 0.01);
}

// OpenVDB refuses smaller voxels: a mesh of half a millimetre in metres has fewer of those it has.
TEST(ChooseTransform, MeshTooSmallForItsResolution) {
  const WorldBox box = boxOf({0, 0, 0}, {5e-4, 4e-4, 3e-4});
  VoxelizeOptions options;
  const GridTransform transform = chooseTransform(box, options);
  EXPECT_EQ(transform.voxelSize, (Vec3d{1.45e-5, 1.45e-5, 1.45e-5}));
  Report report;
  reportTransform(transform, options, report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].code, "smallest-voxels");
  EXPECT_FALSE(report.partial);

  options.resolution = 34; // 1.47e-5
  Report none;
  reportTransform(chooseTransform(box, options), options, none);
  EXPECT_TRUE(none.warnings.empty());

  options.voxelSize = {1.4e-5, 1.4e-5, 1.4e-5};
  EXPECT_THROW(chooseTransform(box, options), Error);
  options.voxelSize = {};
  options.fit.voxels = 64;
  EXPECT_THROW(chooseTransform(box, options), Error);
}

// Ends at k + 1/2 lattice units round apart: a box of exactly N voxels becomes a unit longer.
TEST(ChooseTransform, EndsThatRoundApart) {
  const double unit = 0x1p-20;
  VoxelizeOptions options;
  options.resolution = 3;
  const WorldBox box = boxOf({1 - 1.5 * unit, 0, 0}, {4 - 0.5 * unit, 1, 1});
  const GridTransform transform = chooseTransform(box, options);
  const double h = transform.voxelSize[0];
  EXPECT_LE(centresBetween(units(box.min[0], 0, h), units(box.max[0], 0, h)), 3);
  EXPECT_LE(h, 1 + 4 * unit);
}

std::int64_t widest(const Voxelization& made) {
  std::int64_t most = 0;
  for (const GridInfo& grid : describe(made.volume))
    for (std::size_t k = 0; k < 3; ++k)
      most = std::max<std::int64_t>(most, grid.boxMax[k] - grid.boxMin[k] + 1);
  return most;
}

TEST(ChooseTransform, VoxelsOfTrianglesAndTets) {
  meshes::Random random(2);
  int full = 0;
  for (int i = 0; i < 300; ++i) {
    const WorldBox box = randomBox(random);
    if (!(longestOf(box) > 1e-6 * std::abs(box.min[0]) &&
          longestOf(box) > 1e-6 * std::abs(box.min[1]) &&
          longestOf(box) > 1e-6 * std::abs(box.min[2])))
      continue;
    VoxelizeOptions options;
    options.resolution = 1 + int(random.below(40));
    options.allowEmpty = true;
    Report report;
    Progress progress;
    const auto place = [&](const Vec3d& p) {
      Vec3d q{};
      for (std::size_t k = 0; k < 3; ++k)
        q[k] = p[k] == 0 ? box.min[k] : box.max[k];
      return q;
    };
    const std::int64_t ofTriangles =
        widest(voxelize(meshes::moved(meshes::box(), place), {}, options, report, progress));
    const std::int64_t ofTets = widest(
        voxelize(meshes::mapped(meshes::kuhnGrid(1, 1, 1), place), options, report, progress));
    EXPECT_LE(ofTriangles, options.resolution);
    EXPECT_EQ(ofTriangles, ofTets);
    full += ofTriangles == options.resolution;
  }
  EXPECT_GT(full, 50);
}

// A shell has the voxels at both of its ends.
TEST(ChooseTransform, Shells) {
  SolidOptions solid;
  solid.shell = 2;
  const TriangleMesh sheet = meshes::moved(meshes::sheet(), [](const Vec3d& p) {
    return Vec3d{10 * p[0] - 5, 10 * p[1] - 5, p[2]};
  });
  for (const int resolution : {6, 12, 24, 25, 100}) {
    VoxelizeOptions options;
    options.resolution = resolution;
    Report report;
    Progress progress;
    const std::int64_t found = widest(voxelize(sheet, solid, options, report, progress));
    EXPECT_LE(found, resolution);
    EXPECT_GE(found, resolution - 1);
  }
}

// Where all walls are doubled the winding number above a missing lid is twice the share of the sky
// that the lid would take: above a half up to 0.4 beyond the box of the faces.
TEST(ChooseTransform, SolidsBeyondTheBox) {
  const TriangleMesh whole = meshes::box({0.1, 0.2, 0.3}, {1.1, 1.2, 1.3});
  TriangleMesh open = meshes::without(whole, [&](std::size_t f) {
    double low = 2;
    for (std::size_t k = 0; k < 3; ++k)
      low = std::min(low, whole.points[whole.triangles[3 * f + k]][2]);
    return low > 1.2;
  });
  const std::vector<std::uint32_t> once = open.triangles;
  open.triangles.insert(open.triangles.end(), once.begin(), once.end());
  VoxelizeOptions options;
  Report report;
  Progress progress;
  const double longest = longestOf(boxOf(open, SolidOptions()));
  int larger = 0;
  for (options.resolution = 5; options.resolution < 90; options.resolution += 7) {
    const Voxelization made = voxelize(open, {}, options, report, progress);
    EXPECT_LE(widest(made), options.resolution);
    EXPECT_GE(widest(made), options.resolution - 2);
    larger += made.transform.voxelSize[0] > longest / options.resolution * (1 + 1e-5);
  }
  EXPECT_EQ(report.stages.front().name, "voxelize");
  options.fit = {40, 3};
  const GridInfo grid = describe(voxelize(open, {}, options, report, progress).volume).front();
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_GE(grid.boxMin[k], 3);
    EXPECT_LE(grid.boxMax[k], 36);
  }
  EXPECT_GT(larger, 0);
}

TEST(ChooseTransform, FitsACubeOfVoxels) {
  meshes::Random random(5);
  for (int i = 0; i < 300; ++i) {
    const WorldBox box = randomBox(random);
    const double longest = longestOf(box);
    if (!(longest > 1e-6 * std::abs(box.min[0]) && longest > 1e-6 * std::abs(box.min[1]) &&
          longest > 1e-6 * std::abs(box.min[2])))
      continue;
    VoxelizeOptions options;
    options.allowEmpty = true;
    options.fit.voxels = 1 + int(random.below(40));
    options.fit.padding = int(random.below(std::size_t(options.fit.voxels + 1) / 2));
    Report report;
    Progress progress;
    const TriangleMesh mesh = meshes::moved(meshes::box(), [&](const Vec3d& p) {
      Vec3d q{};
      for (std::size_t k = 0; k < 3; ++k)
        q[k] = p[k] == 0 ? box.min[k] : box.max[k];
      return q;
    });
    const Voxelization made = voxelize(mesh, {}, options, report, progress);
    EXPECT_TRUE(report.warnings.empty());
    const GridInfo grid = describe(made.volume).front();
    const int inner = options.fit.voxels - 2 * options.fit.padding;
    for (std::size_t k = 0; k < 3; ++k) {
      // The middles agree, in voxels.
      EXPECT_NEAR(((box.min[k] + box.max[k]) / 2 - made.transform.origin[k]) /
                      made.transform.voxelSize[k],
                  (options.fit.voxels - 1) / 2.0, 1e-3);
      if (grid.activeVoxels == 0)
        continue; // thinner than a voxel
      EXPECT_GE(grid.boxMin[k], options.fit.padding);
      EXPECT_LE(grid.boxMax[k], options.fit.voxels - 1 - options.fit.padding);
      if (box.max[k] - box.min[k] == longest) {
        EXPECT_EQ(grid.boxMax[k] - grid.boxMin[k] + 1, inner);
      }
    }
    options.rule = VoxelRule::Any;
    const GridInfo met = describe(voxelize(mesh, {}, options, report, progress).volume).front();
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GE(met.boxMin[k], options.fit.padding);
      EXPECT_LE(met.boxMax[k], options.fit.voxels - 1 - options.fit.padding);
    }
  }
}

TEST(ChooseTransform, Refuses) {
  const auto statusOf = [](const WorldBox& box, const VoxelizeOptions& options) {
    try {
      chooseTransform(box, options);
    } catch (const Error& error) {
      return error.status();
    }
    return Status::Ok;
  };
  const WorldBox box = boxOf({0, 0, 0}, {1, 1, 1});
  VoxelizeOptions options;
  options.resolution = 0;
  EXPECT_EQ(statusOf(box, options), Status::Usage);
  options = {};
  options.fit = {8, 4};
  EXPECT_EQ(statusOf(box, options), Status::Usage);
  options.fit = {8, -1};
  EXPECT_EQ(statusOf(box, options), Status::Usage);
  options.fit = {8, 3};
  EXPECT_EQ(statusOf(box, options), Status::Ok);
  EXPECT_EQ(statusOf(boxOf({1, 1, 1}, {1, 1, 1}), options), Status::Invalid);
}

} // namespace
// Few coordinates, so that points that are not in use share sides of the box with others.
RC_GTEST_PROP(ChooseTransformProperties, BoxesOfPoints, ()) {
  meshes::Random random(*rc::gen::arbitrary<std::uint32_t>());
  std::vector<Vec3d> points(1 + random.below(40));
  const std::size_t values = 1 + random.below(9);
  for (Vec3d& p : points)
    for (double& c : p)
      c = static_cast<double>(random.below(values)) - 4;
  if (random.below(8) == 0)
    points[random.below(points.size())][random.below(3)] =
        random.below(2) == 0 ? std::numeric_limits<double>::quiet_NaN()
                             : std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> indices(random.below(60));
  const std::size_t used = 1 + random.below(points.size());
  for (std::uint32_t& i : indices)
    i = static_cast<std::uint32_t>(random.below(used));
  const auto boxOf = [&](const std::vector<Vec3d>& some) {
    WorldBox box;
    for (const Vec3d& p : some)
      for (std::size_t k = 0; k < 3; ++k) {
        box.min[k] = std::min(box.min[k], p[k]);
        box.max[k] = std::max(box.max[k], p[k]);
        box.finite = box.finite && std::isfinite(p[k]);
      }
    return box;
  };
  std::vector<Vec3d> named;
  for (const std::uint32_t i : indices)
    named.push_back(points[i]);
  const PointBoxes boxes = boxesOf(points, indices);
  for (const auto& [found, expected] :
       {std::pair(boxes.all, boxOf(points)), {boxes.used, boxOf(named)}}) {
    RC_ASSERT(found.finite == expected.finite);
    if (found.finite) {
      RC_ASSERT(found.min == expected.min);
      RC_ASSERT(found.max == expected.max);
    }
  }
}

} // namespace tetvdb
