// SPDX-License-Identifier: Apache-2.0
#include "MeshOracles.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/print/Cavity.h"
#include "tetvdb/print/Infill.h"
#include "tetvdb/print/Shells.h"
#include "tetvdb/surface/LocalRepair.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace tetvdb {
namespace {

constexpr InfillKind kAll[] = {InfillKind::Gyroid, InfillKind::SchwarzP, InfillKind::Diamond,
                               InfillKind::Bcc, InfillKind::Octet};

// Values of the surfaces by their equations, and gradients by differences.
double equation(InfillKind kind, const Vec3d& p, double cell) {
  const double x = 2 * kPi * p[0] / cell, y = 2 * kPi * p[1] / cell, z = 2 * kPi * p[2] / cell;
  if (kind == InfillKind::Gyroid)
    return std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) + std::sin(z) * std::cos(x);
  if (kind == InfillKind::SchwarzP)
    return std::cos(x) + std::cos(y) + std::cos(z);
  return std::cos(z) * std::sin(x + y) + std::sin(z) * std::cos(x - y);
}

double sheetDistance(InfillKind kind, const Vec3d& p, double cell) {
  constexpr double kStep = 1e-6;
  double square = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3d low = p, high = p;
    low[k] -= kStep;
    high[k] += kStep;
    const double slope = (equation(kind, high, cell) - equation(kind, low, cell)) / (2 * kStep);
    square += slope * slope;
  }
  return std::abs(equation(kind, p, cell)) / std::sqrt(square);
}

// The nearest of all struts of 27 cells around.
double strutDistance(InfillKind kind, const Vec3d& p, double cell) {
  double nearest = 1e9;
  const auto add = [&](const Vec3d& a, const Vec3d& b) {
    nearest = std::min(nearest, oracles::toSegment(p, a, b));
  };
  Vec3d base;
  for (std::size_t k = 0; k < 3; ++k)
    base[k] = std::floor(p[k] / cell) * cell;
  for (int n = 0; n < 27; ++n) {
    const Vec3d o{base[0] + cell * (n % 3 - 1), base[1] + cell * (n / 3 % 3 - 1),
                  base[2] + cell * (n / 9 - 1)};
    const auto at = [&](double x, double y, double z) {
      return Vec3d{o[0] + x * cell, o[1] + y * cell, o[2] + z * cell};
    };
    if (kind == InfillKind::Bcc) {
      for (int c = 0; c < 8; ++c)
        add(at(0.5, 0.5, 0.5), at(c & 1, c >> 1 & 1, c >> 2));
      continue;
    }
    const Vec3d sides[6] = {at(0.5, 0.5, 0), at(0.5, 0.5, 1), at(0.5, 0, 0.5),
                            at(0.5, 1, 0.5), at(0, 0.5, 0.5), at(1, 0.5, 0.5)};
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < i; ++j)
        if (i / 2 != j / 2) // not across the cell
          add(sides[i], sides[j]);
    add(at(0, 0, 0), at(1, 1, 0));
    add(at(1, 0, 0), at(0, 1, 0));
    add(at(0, 0, 0), at(1, 0, 1));
    add(at(1, 0, 0), at(0, 0, 1));
    add(at(0, 0, 0), at(0, 1, 1));
    add(at(0, 1, 0), at(0, 0, 1));
  }
  return nearest;
}

TEST(Infill, DistancesAreThoseOfTheEquations) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> within(-20, 20);
  for (const InfillKind kind : kAll) {
    const Infill infill(kind, 3.7);
    for (int i = 0; i < 2000; ++i) {
      const Vec3d p{within(random), within(random), within(random)};
      const bool isSheet = kind != InfillKind::Bcc && kind != InfillKind::Octet;
      const double expected = isSheet ? sheetDistance(kind, p, 3.7) : strutDistance(kind, p, 3.7);
      EXPECT_NEAR(infill.distanceAt(p), expected, 1e-5 * (1 + expected * expected)) << nameOf(kind);
    }
  }
}

TEST(Infill, DensityIsTheShareOfRandomPlaces) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> within(0, 5);
  for (const InfillKind kind : kAll) {
    const Infill infill(kind, 5);
    for (const double density : {0.05, 0.2, 0.5}) {
      const double half = infill.thicknessFor(density) / 2;
      int inside = 0;
      constexpr int kPlaces = 100000;
      for (int i = 0; i < kPlaces; ++i)
        inside += infill.distanceAt({within(random), within(random), within(random)}) < half;
      EXPECT_NEAR(double(inside) / kPlaces, density, 0.006) << nameOf(kind);
      EXPECT_NEAR(infill.densityOf(2 * half), density, 1e-4) << nameOf(kind);
    }
  }
}

// A gyroid's sheet of thickness t: its area in a cell is 3.0915 of a side's (Schoen 1970).
TEST(Infill, AThinGyroidHasItsAreaTimesItsThickness) {
  const Infill infill(InfillKind::Gyroid, 10);
  EXPECT_NEAR(infill.densityOf(0.5), 3.0915 * 0.5 / 10, 0.003);
}

TEST(Infill, FillsItsShareOfACavity) {
  const TriangleMesh box = meshes::box({0, 0, 0}, {24, 24, 24});
  Report report;
  Progress progress;
  CavityOptions options;
  options.wall = 2;
  options.voxel = 0.2;
  const double empty = -meshes::signedVolume(makeCavity(box, options, report, progress).surface);
  for (const InfillKind kind : {InfillKind::Gyroid, InfillKind::Octet}) {
    const Infill infill(kind, 5);
    options.infill = &infill;
    const double thickness = infill.thicknessFor(0.3);
    options.thickness = [&](const openvdb::Coord&) { return thickness; };
    Cavity cavity = makeCavity(box, options, report, progress);
    EXPECT_GE(cavity.wall, 2);
    EXPECT_TRUE(oracles::isClosedManifold(cavity.surface));
    // Four cells along each side of 20: whole ones.
    EXPECT_NEAR(1 + meshes::signedVolume(cavity.surface) / empty, 0.3, 0.01) << nameOf(kind);
    EXPECT_GE(oracles::distanceBetween(cavity.surface, box, 29), 2);
    EXPECT_EQ(dropIslands(cavity.surface).cavities, 0u);
    EXPECT_EQ(whatIsBroken(meshes::joined({box, cavity.surface}), progress), "");
  }
}

TEST(Infill, NamesAreRead) {
  for (const InfillKind kind : kAll) {
    InfillKind read = InfillKind::Gyroid;
    EXPECT_TRUE(readInfill(nameOf(kind), read));
    EXPECT_EQ(read, kind);
  }
  InfillKind read = InfillKind::Bcc;
  EXPECT_FALSE(readInfill("honeycomb", read));
  EXPECT_EQ(read, InfillKind::Bcc);
}

} // namespace
} // namespace tetvdb
