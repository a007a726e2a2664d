// SPDX-License-Identifier: Apache-2.0
#include "tetrahedralize/TetMeshes.h"
#include "tetvdb/tetrahedralize/inside/Regions.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

TEST(Regions, RulesByTheirTruthTables) {
  // Bits of inputs 0, 1, 2; what each rule says of them.
  for (std::uint16_t mask = 0; mask < 8; ++mask) {
    const bool a = (mask & 1) != 0, b = (mask & 2) != 0, c = (mask & 4) != 0;
    EXPECT_EQ(regionOf(mask, 3, Boolean::Materials), a ? 1 : b ? 2 : c ? 3 : kOutsideRegion);
    EXPECT_EQ(regionOf(mask, 3, Boolean::Union), a || b || c ? 1 : kOutsideRegion);
    EXPECT_EQ(regionOf(mask, 3, Boolean::Difference), a && !b && !c ? 1 : kOutsideRegion);
    EXPECT_EQ(regionOf(mask, 3, Boolean::Intersection), a && b && c ? 1 : kOutsideRegion);
  }
  for (const Boolean rule :
       {Boolean::Materials, Boolean::Union, Boolean::Difference, Boolean::Intersection}) {
    EXPECT_EQ(regionOf(1, 1, rule), 1);
    EXPECT_EQ(regionOf(0, 1, rule), kOutsideRegion);
  }
  EXPECT_EQ(regionOf(1u << 9, 10, Boolean::Materials), 10);
  EXPECT_EQ(regionOf((1u << 10) - 1, 10, Boolean::Intersection), 1);
}

// Tets of a mesh, of which every seventh is gone, with masks by number.
struct Marked {
  TetComplex complex = cubeMesh(3, 1024, 0.2, ballAt({0, 0, 0}, 0));
  std::vector<std::uint16_t> inside;
  Marked() {
    for (std::size_t t = 0; t < complex.tets.size(); ++t) {
      inside.push_back(static_cast<std::uint16_t>(t % 4));
      if (t % 7 == 0)
        complex.tets[t].corners[0] = TetComplex::kNone;
    }
  }
};

WorkingLattice someLattice() {
  Box box;
  box.add(Vec3d{1e5, 0.3, -7});
  box.add(Vec3d{1e5 + 0.25, 0.4, -6});
  return WorkingLattice(box);
}

TEST(Regions, KeepsTetsOfARegionInTheirOrder) {
  const Marked marked;
  const WorkingLattice lattice = someLattice();
  for (const Boolean rule :
       {Boolean::Materials, Boolean::Union, Boolean::Difference, Boolean::Intersection})
    for (const bool outside : {false, true}) {
      const TetMesh mesh = keptTets(marked.complex, marked.inside, 2, rule, outside, lattice);
      std::size_t next = 0;
      std::vector<char> used(mesh.points.size(), 0);
      for (std::size_t t = 0; t < marked.complex.tets.size(); ++t) {
        const std::int32_t region = regionOf(marked.inside[t], 2, rule);
        if (t % 7 == 0 || (region == kOutsideRegion && !outside))
          continue;
        ASSERT_LT(next, mesh.tetCount());
        EXPECT_EQ(mesh.regions[next], region);
        for (std::size_t k = 0; k < 4; ++k) {
          const std::uint32_t corner = mesh.tets[4 * next + k];
          ASSERT_LT(corner, mesh.points.size());
          used[corner] = 1;
          // Exactly where it was.
          EXPECT_EQ(lattice.toLattice(mesh.points[corner]),
                    marked.complex.at(marked.complex.tets[t].corners[k]));
        }
        ++next;
      }
      EXPECT_EQ(next, mesh.tetCount());
      EXPECT_EQ(mesh.cellCount, next);
      EXPECT_EQ(mesh.regions.size(), next);
      EXPECT_TRUE(mesh.cellOfTet.empty());
      EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0) << "points of no tet";
      EXPECT_GT(next, 0u);
    }
}

TEST(Regions, OfNothingNothingIsKept) {
  const Marked marked;
  const std::vector<std::uint16_t> none(marked.inside.size(), 0);
  const TetMesh mesh = keptTets(marked.complex, none, 2, Boolean::Union, false, someLattice());
  EXPECT_TRUE(mesh.tets.empty() && mesh.points.empty() && mesh.regions.empty());
}

} // namespace
} // namespace tetvdb
