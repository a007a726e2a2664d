// SPDX-License-Identifier: Apache-2.0
//
// FaceRaster.h and TetRaster.h voxel by voxel against Ownership.h: steep planes, long edges, places
// far out in index space.
#include "Meshes.h"
#include "tetvdb/geometry/Ownership.h"
#include "tetvdb/voxelize/FaceRaster.h"
#include "tetvdb/voxelize/TetRaster.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>

namespace {

using namespace tetvdb;

constexpr auto kUnits = static_cast<double>(kUnitsPerVoxel);

// Whether the perturbed column (x + e, y + e^2) is inside the triangle seen along z.
bool columnInside(const LatticePoint* p, std::int64_t x, std::int64_t y) {
  const LatticePoint c{static_cast<double>(x) * kUnits, static_cast<double>(y) * kUnits, 0};
  const Int128 area = triangleNormal(p[0], p[1], p[2]).z;
  if (area == 0)
    return false;
  for (int k = 0; k < 3; ++k) {
    const LatticePoint &a = p[k], &b = p[(k + 1) % 3];
    const ExactVector ab = difference(b, a), ac = difference(c, a);
    const Int128 w = ab.x * ac.y - ab.y * ac.x;
    const int side = w != 0 ? signOf(w) : tieSign<Int128>(-ab.y, ab.x, 0);
    if (side != signOf(area))
      return false;
  }
  return true;
}

void expectCrossings(const LatticePoint* p, const SlabOrigin& slab) {
  const FaceRaster face(p[0], p[1], p[2], 1);
  auto crossings = std::make_unique<SlabCrossings>();
  crossings->clear();
  if (face.crosses != 0)
    face.rasterize(slab.x, slab.y, slab.z, *crossings);
  ASSERT_TRUE(crossings->extra.empty());
  const bool leaving = triangleNormal(p[0], p[1], p[2]).z > 0;
  const SlabBits& bits = leaving ? crossings->leaving : crossings->entering;
  for (int x = 0; x < kLeafSize; ++x)
    for (int y = 0; y < kNodeSize; ++y) {
      const bool inside = columnInside(p, slab.x + x, slab.y + y);
      const auto above = [&](int z) {
        const int side =
            perturbedSide(p[0], p[1], p[2],
                          voxelCentre({static_cast<int>(slab.x) + x, static_cast<int>(slab.y) + y,
                                       static_cast<int>(slab.z) + z}));
        return (side > 0) == leaving;
      };
      for (int z = 0; z < kNodeSize; ++z) {
        const bool bit = (bits.rows[x * kNodeSize + y][z >> 6] >> (z & 63) & 1) != 0;
        ASSERT_EQ(bit, inside && above(z) && !above(z - 1)) << x << ' ' << y << ' ' << z;
      }
    }
}

void expectOwned(const LatticePoint* p, const SlabOrigin& slab) {
  SnappedMesh mesh;
  for (int i = 0; i < 4; ++i)
    mesh.points.push_back(p[i]);
  mesh.points.push_back({0, 0, 0});
  mesh.pointCount = 4;
  const std::uint32_t corners[4] = {0, 1, 2, 3}, tet = 0;
  mesh.tets = corners;
  mesh.tetCount = 1;
  auto bits = std::make_unique<SlabBits>();
  std::memset(bits.get(), 0, sizeof *bits);
  OrientationCounts counts;
  rasterizeTets(mesh, &tet, 1, slab, *bits, counts);
  std::vector<std::uint32_t> owners(std::size_t(kSlabRows) * kNodeSize, 7);
  auto ownedBits = std::make_unique<SlabBits>();
  std::memset(ownedBits.get(), 0, sizeof *ownedBits);
  rasterizeOwners(mesh, &tet, 1, slab, *ownedBits, owners.data(), counts);
  ASSERT_EQ(std::memcmp(bits.get(), ownedBits.get(), sizeof *bits), 0);
  for (int x = 0; x < kLeafSize; ++x)
    for (int y = 0; y < kNodeSize; ++y)
      for (int z = 0; z < kNodeSize; ++z) {
        const int row = x * kNodeSize + y;
        const bool bit = (bits->rows[row][z >> 6] >> (z & 63) & 1) != 0;
        ASSERT_EQ(bit, ownsVoxel({p[0], p[1], p[2], p[3]},
                                 {static_cast<int>(slab.x) + x, static_cast<int>(slab.y) + y,
                                  static_cast<int>(slab.z) + z}))
            << x << ' ' << y << ' ' << z;
        ASSERT_EQ(owners[static_cast<std::size_t>(row * kNodeSize + z)], bit ? 0u : 7u);
      }
}

// Corners around a slab: `spread` voxels out, on the lattice of 2^-20, 1/2 or whole voxels, some of
// them nearly above each other so that planes are steep.
class Corners {
public:
  explicit Corners(std::uint64_t seed) : random_(seed) {}

  void make(LatticePoint* p, int count, const SlabOrigin& slab) {
    const double spread = pick({3, 20, 150, 3000, 400000});
    const double grain = pick({1, kUnits / 2, kUnits});
    const double flatten = pick({1, 1, 1e-3, 2e-6, 0});
    const std::size_t axis = random_.below(3);
    for (int i = 0; i < count; ++i) {
      double c[3] = {static_cast<double>(slab.x) + 4, static_cast<double>(slab.y) + 60,
                     static_cast<double>(slab.z) + 60};
      for (std::size_t k = 0; k < 3; ++k) {
        const double move = random_.between(-spread, spread) * (k == axis && i > 0 ? flatten : 1);
        c[k] = std::round((c[k] + move) * kUnits / grain) * grain;
      }
      p[i] = {c[0], c[1], c[2]};
    }
  }

  SlabOrigin slab() {
    const double far = pick({0, 1e4, 2e9});
    const auto at = [&](double size) {
      return static_cast<std::int64_t>(random_.between(-far, far) / size) *
             static_cast<std::int64_t>(size);
    };
    return {at(kLeafSize), at(kNodeSize), at(kNodeSize)};
  }

private:
  double pick(std::initializer_list<double> values) {
    return *(values.begin() + static_cast<std::ptrdiff_t>(random_.below(values.size())));
  }
  meshes::Random random_;
};

TEST(FaceRaster, CrossingsAreWhereTheRuleSays) {
  Corners corners(17);
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    const SlabOrigin slab = corners.slab();
    LatticePoint p[3];
    corners.make(p, 3, slab);
    expectCrossings(p, slab);
    if (HasFatalFailure())
      return;
  }
}

TEST(FaceRaster, RangeHoldsEveryCrossing) {
  Corners corners(5);
  for (int i = 0; i < 2000; ++i) {
    const SlabOrigin slab = corners.slab();
    LatticePoint p[3];
    corners.make(p, 3, slab);
    const FaceRaster face(p[0], p[1], p[2], 1);
    if (face.crosses == 0)
      continue;
    SlabCrossings crossings;
    crossings.clear();
    face.rasterize(slab.x, slab.y, slab.z, crossings);
    std::int64_t low = 0, high = -1;
    const bool any =
        face.range(slab.x, slab.x + kLeafSize - 1, slab.y, slab.y + kNodeSize - 1, low, high);
    for (const SlabBits* bits : {&crossings.entering, &crossings.leaving})
      for (const auto& row : bits->rows)
        for (int z = 0; z < kNodeSize; ++z)
          if ((row[z >> 6] >> (z & 63) & 1) != 0) {
            ASSERT_TRUE(any && slab.z + z >= low && slab.z + z <= high);
          }
  }
}

TEST(SlabCrossings, WhatDoesNotFitABitIsKeptApart) {
  SlabCrossings slab;
  slab.clear();
  slab.add(3, 70, 1);
  slab.add(3, 70, 2);
  slab.add(3, 70, -3);
  ASSERT_EQ(slab.extra.size(), 2u);
  EXPECT_EQ(slab.extra[0].weight, 2);
  EXPECT_EQ(slab.extra[1].weight, -2);
  EXPECT_EQ(slab.entering.rows[3][1], 1u << 6);
  EXPECT_EQ(slab.leaving.rows[3][1], 1u << 6);
}

TEST(TetRaster, VoxelsAreThoseThatTheTetOwns) {
  Corners corners(23);
  for (int i = 0; i < 250; ++i) {
    SCOPED_TRACE(i);
    const SlabOrigin slab = corners.slab();
    LatticePoint p[4];
    corners.make(p, 4, slab);
    expectOwned(p, slab);
    if (HasFatalFailure())
      return;
  }
}

TEST(TetRaster, BoxesAreInsideOrOutsideForSure) {
  Corners corners(3);
  int inside = 0;
  for (int i = 0; i < 3000; ++i) {
    const SlabOrigin slab = corners.slab();
    LatticePoint p[4];
    corners.make(p, 4, slab);
    SnappedMesh mesh;
    for (const LatticePoint& q : p)
      mesh.points.push_back(q);
    const std::uint32_t tet[4] = {0, 1, 2, 3};
    mesh.tets = tet;
    mesh.tetCount = 1;
    const TetBox box{{slab.x, slab.y, slab.z}, {slab.x + 7, slab.y + 127, slab.z + 127}};
    const Cover cover = classifyBox(mesh, 0, box);
    inside += cover == Cover::Inside;
    if (cover == Cover::Partial)
      continue;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3i v{static_cast<int>(slab.x) + (corner & 1 ? 7 : 0),
                    static_cast<int>(slab.y) + (corner & 2 ? 127 : 0),
                    static_cast<int>(slab.z) + (corner & 4 ? 127 : 0)};
      ASSERT_EQ(ownsVoxel({p[0], p[1], p[2], p[3]}, v), cover == Cover::Inside);
    }
  }
  EXPECT_GT(inside, 20);
}

TEST(Ownership, OrientationDoesNotMatter) {
  Corners corners(9);
  for (int i = 0; i < 500; ++i) {
    LatticePoint p[4];
    corners.make(p, 4, {0, 0, 0});
    for (int z = 40; z < 80; z += 3) {
      const Vec3i v{4, 60, z};
      ASSERT_EQ(ownsVoxel({p[0], p[1], p[2], p[3]}, v), ownsVoxel({p[1], p[0], p[2], p[3]}, v));
      ASSERT_EQ(ownsVoxel({p[0], p[1], p[2], p[3]}, v), ownsVoxel({p[3], p[1], p[0], p[2]}, v));
    }
  }
}

} // namespace
