// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/ChooseMesher.h"

#include <gtest/gtest.h>

namespace tetvdb {
namespace {

constexpr Vec3d kCoarse{0.02, 0.03, 0.05}, kFine{0.001, 0.001, 0.001}; // of a diagonal of 1

VoxelizeJob job() {
  VoxelizeJob made;
  made.output = "out.vdb";
  return made;
}

Mesher methodOf(const VoxelizeJob& wanted, const Vec3d& voxel) {
  checkMesher(wanted);
  const MesherChoice choice = chooseMesher(wanted, 1, voxel);
  EXPECT_FALSE(choice.why.empty());
  EXPECT_EQ(choice.epsilon > 0, choice.method == Mesher::Envelope);
  return choice.method;
}

TEST(ChooseMesher, WindingNumberWhateverTheSizeOfVoxels) {
  EXPECT_EQ(methodOf(job(), kCoarse), Mesher::Winding);
  EXPECT_EQ(methodOf(job(), kFine), Mesher::Winding);
  EXPECT_EQ(methodOf(job(), {1, 1, 1}), Mesher::Winding);
}

TEST(ChooseMesher, TetsNeedTheEnvelope) {
  VoxelizeJob wanted = job();
  wanted.grids = {GridKind::Density, GridKind::TetId};
  EXPECT_TRUE(needsTets(wanted));
  EXPECT_EQ(methodOf(wanted, kFine), Mesher::Envelope);
  wanted = job();
  wanted.meshOutput = "out.vtu";
  EXPECT_TRUE(needsTets(wanted));
  EXPECT_EQ(methodOf(wanted, kFine), Mesher::Envelope);
  wanted.meshOutput = "out.stl";
  EXPECT_FALSE(needsTets(wanted));
  EXPECT_EQ(methodOf(wanted, kFine), Mesher::Winding);
}

TEST(ChooseMesher, MaterialsNeedNoTets) {
  VoxelizeJob wanted = job();
  wanted.grids = {GridKind::Material};
  EXPECT_FALSE(needsTets(wanted));
  EXPECT_EQ(methodOf(wanted, kCoarse), Mesher::Winding);
  wanted.solid.shell = 0.1;
  EXPECT_EQ(methodOf(wanted, kCoarse), Mesher::Winding);
  wanted = job();
  wanted.grids = {GridKind::Material};
  wanted.mesher = Mesher::Envelope;
  EXPECT_EQ(methodOf(wanted, kCoarse), Mesher::Envelope);
}

TEST(ChooseMesher, EpsilonInAllItsUnits) {
  using Unit = RelativeLength::Unit;
  VoxelizeJob wanted = job();
  wanted.mesher = Mesher::Envelope;
  EXPECT_DOUBLE_EQ(chooseMesher(wanted, 10, kCoarse).epsilon, 0.01); // half the shortest side
  wanted.epsilon = {0.25, Unit::Voxel};
  EXPECT_DOUBLE_EQ(chooseMesher(wanted, 10, kCoarse).epsilon, 0.005);
  wanted.epsilon = {0.25, Unit::Diagonal};
  EXPECT_DOUBLE_EQ(chooseMesher(wanted, 10, kCoarse).epsilon, 2.5);
  wanted.epsilon = {0.25, Unit::World};
  EXPECT_DOUBLE_EQ(chooseMesher(wanted, 10, kCoarse).epsilon, 0.25);
  wanted.mesher = Mesher::Auto;
  EXPECT_EQ(methodOf(wanted, kFine), Mesher::Envelope);
  EXPECT_FALSE(needsTets(wanted)); // the winding number may be used
}

TEST(ChooseMesher, WhatTheJobSays) {
  VoxelizeJob wanted = job();
  for (const Mesher mesher : {Mesher::Envelope, Mesher::Winding}) {
    wanted.mesher = mesher;
    EXPECT_EQ(methodOf(wanted, kCoarse), mesher);
    EXPECT_EQ(methodOf(wanted, kFine), mesher);
  }
}

TEST(ChooseMesher, ShellsAndOtherRulesAreDirect) {
  VoxelizeJob wanted = job();
  wanted.solid.shell = 0.1;
  EXPECT_EQ(methodOf(wanted, kCoarse), Mesher::Winding);
  wanted = job();
  wanted.solid.inside = InsideRule::Flood;
  EXPECT_EQ(methodOf(wanted, kCoarse), Mesher::Winding);
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
  wanted.mesher = Mesher::Winding;
  wanted.meshOutput = "out.msh";
  EXPECT_TRUE(refused(wanted));
  wanted = job();
  wanted.solid.shell = 1;
  EXPECT_FALSE(refused(wanted));
  wanted.mesher = Mesher::Envelope;
  EXPECT_TRUE(refused(wanted));
  wanted.mesher = Mesher::Auto;
  wanted.grids = {GridKind::TetId};
  EXPECT_TRUE(refused(wanted));
  wanted.output.clear(); // no volume: its grids do not count
  wanted.meshOutput = "out.stl";
  EXPECT_FALSE(refused(wanted));
}

} // namespace
} // namespace tetvdb
