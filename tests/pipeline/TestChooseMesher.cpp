// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

constexpr Vec3d kCoarse{0.02, 0.03, 0.05}, kFine{0.001, 0.001, 0.001}; // of a diagonal of 1

VoxelizeJob job() {
  VoxelizeJob made;
  made.output = "out.vdb";
  return made;
}

Mesher road(const VoxelizeJob& wanted, const Vec3d& voxel) {
  checkMesher(wanted);
  const MesherChoice choice = chooseMesher(wanted, 1, voxel);
  EXPECT_FALSE(choice.why.empty());
  EXPECT_EQ(choice.epsilon > 0, choice.road == Mesher::Envelope);
  return choice.road;
}

TEST(ChooseMesher, ByTheSizeOfVoxels) {
  EXPECT_EQ(road(job(), kCoarse), Mesher::Envelope);
  EXPECT_EQ(road(job(), kFine), Mesher::Winding);
  EXPECT_EQ(road(job(), {0.002, 0.002, 0.002}), Mesher::Envelope);
  EXPECT_EQ(road(job(), {0.00199, 0.002, 0.002}), Mesher::Winding);
}

TEST(ChooseMesher, TetsNeedTheEnvelope) {
  VoxelizeJob wanted = job();
  for (const GridKind kind : {GridKind::TetId, GridKind::Material}) {
    wanted.voxelize.grids = {GridKind::Density, kind};
    EXPECT_TRUE(needsTets(wanted));
    EXPECT_EQ(road(wanted, kFine), Mesher::Envelope);
  }
  wanted = job();
  wanted.meshOutput = "out.vtu";
  EXPECT_TRUE(needsTets(wanted));
  EXPECT_EQ(road(wanted, kFine), Mesher::Envelope);
  wanted.meshOutput = "out.stl";
  EXPECT_FALSE(needsTets(wanted));
  EXPECT_EQ(road(wanted, kFine), Mesher::Winding);
}

TEST(ChooseMesher, EpsilonInAllItsUnits) {
  using Unit = RelativeLength::Unit;
  VoxelizeJob wanted = job();
  EXPECT_DOUBLE_EQ(chooseMesher(wanted, 10, kCoarse).epsilon, 0.01); // half the shortest side
  wanted.epsilon = {0.25, Unit::Voxel};
  EXPECT_DOUBLE_EQ(chooseMesher(wanted, 10, kCoarse).epsilon, 0.005);
  wanted.epsilon = {0.25, Unit::Diagonal};
  EXPECT_DOUBLE_EQ(chooseMesher(wanted, 10, kCoarse).epsilon, 2.5);
  wanted.epsilon = {0.25, Unit::World};
  EXPECT_DOUBLE_EQ(chooseMesher(wanted, 10, kCoarse).epsilon, 0.25);
  EXPECT_EQ(road(wanted, kFine), Mesher::Envelope);
  EXPECT_FALSE(needsTets(wanted)); // the winding number may take over
}

TEST(ChooseMesher, WhatTheJobSays) {
  VoxelizeJob wanted = job();
  for (const Mesher mesher : {Mesher::Envelope, Mesher::Winding, Mesher::Centroid}) {
    wanted.mesher = mesher;
    EXPECT_EQ(road(wanted, kCoarse), mesher);
    EXPECT_EQ(road(wanted, kFine), mesher);
  }
}

TEST(ChooseMesher, ShellsAndOtherRulesAreDirect) {
  VoxelizeJob wanted = job();
  wanted.solid.shell = 0.1;
  EXPECT_EQ(road(wanted, kCoarse), Mesher::Winding);
  wanted = job();
  wanted.solid.inside = InsideRule::Flood;
  EXPECT_EQ(road(wanted, kCoarse), Mesher::Winding);
}

TEST(ChooseMesher, RefusesContradictions) {
  const auto refused = [](const VoxelizeJob& wanted) {
    try {
      checkMesher(wanted);
    } catch (const Error& error) {
      return error.status() == Status::Usage;
    }
    return false;
  };
  VoxelizeJob wanted = job();
  wanted.mesher = Mesher::Winding;
  EXPECT_FALSE(refused(wanted));
  wanted.epsilon.value = 1;
  EXPECT_TRUE(refused(wanted));
  wanted = job();
  wanted.mesher = Mesher::Centroid;
  wanted.meshOutput = "out.msh";
  EXPECT_TRUE(refused(wanted));
  wanted = job();
  wanted.solid.shell = 1;
  EXPECT_FALSE(refused(wanted));
  wanted.mesher = Mesher::Envelope;
  EXPECT_TRUE(refused(wanted));
  wanted.mesher = Mesher::Auto;
  wanted.voxelize.grids = {GridKind::TetId};
  EXPECT_TRUE(refused(wanted));
  wanted.output.clear(); // no volume: its grids do not count
  wanted.meshOutput = "out.stl";
  EXPECT_FALSE(refused(wanted));
}

} // namespace
} // namespace tetvdb
