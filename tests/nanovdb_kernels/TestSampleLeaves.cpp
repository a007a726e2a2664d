// SPDX-License-Identifier: Apache-2.0
#include "FieldCases.h"
#include "nanovdb_kernels/AnySoup.h"
#include "nanovdb_kernels/SampleLeaves.h"
#include "tetvdb/core/Error.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace {

using namespace tetvdb;
using meshes::kuhnGrid;

void expectSameSamples(const TetMesh& bare, const GridTransform& transform = {}, int shares = 1,
                       const FieldOptions& wanted = allFields()) {
  const TetMesh mesh = bare.attributes.empty() ? withArrays(bare, 5) : bare;
  const SampledFields twin = fieldsBy(
      mesh, transform, wanted,
      [&](const nano::MeshView& view, const nano::FieldJob& job, nano::LeafReceiver& receiver) {
        nano::HostTwin().sample(view, job, receiver, shares);
      });
  const SampledFields cpu = cpuFields(mesh, transform, wanted);
  EXPECT_EQ(twin.hash, cpu.hash);
  EXPECT_TRUE(twin.complete);
  ASSERT_EQ(twin.warnings.size(), cpu.warnings.size()); // also how many voxels are left out
  for (std::size_t i = 0; i < cpu.warnings.size(); ++i)
    EXPECT_EQ(twin.warnings[i].text, cpu.warnings[i].text);
}

TEST(SampleLeaves, LatticeWhereEveryCentreIsATie) {
  for (int cell : {1, 3, 8})
    expectSameSamples(meshes::scaled(kuhnGrid(3, 3, 3), cell));
}

TEST(SampleLeaves, NegativeCoordinatesAndAnisotropicVoxels) {
  expectSameSamples(
      meshes::scaled(meshes::jittered(kuhnGrid(3, 4, 5), 0.2, 3), 7.3, {-20.1, -5000.7, 3.3}),
      {{0.9, 1.1, 1.7}, {0.25, -3, 8}});
}

TEST(SampleLeaves, OverlapsFlipsAndFlatTets) {
  expectSameSamples(meshes::soup(300, 40, 9, 1, 5));
  expectSameSamples(meshes::rounded(meshes::soup(300, 20, 5, 2, 5), 0.5));
}

// Weights by 128-bit integers.
TEST(SampleLeaves, Slivers) {
  for (const double thin : {1e-3, 1e-5, 4e-6})
    expectSameSamples(
        meshes::mapped(meshes::jittered(kuhnGrid(4, 4, 400), 0.2, 3), [&](const Vec3d& p) {
          return Vec3d{p[0] * 11, p[1] * 9 + 3, p[2] * thin * 9 + 4 - thin};
        }));
}

TEST(SampleLeaves, TinyAndLargeTetsInOneMesh) {
  expectSameSamples(meshes::joined(meshes::soup(400, 100, 0.7, 7), meshes::soup(3, 100, 90, 8)));
}

// Tiles of leaves and nodes where a cell's value is all there is, and nothing where it is none.
TEST(SampleLeaves, TetsThatFillNodes) {
  // A tet that holds the node at the origin, and another.
  TetMesh mesh;
  mesh.points = {{-1, -1, -1}, {395, -1, -1}, {-1, 395, -1}, {-1, -1, 395}, {150, 150, 150}};
  mesh.tets = {0, 1, 2, 3, 1, 2, 3, 4};
  mesh.cellCount = 2;
  mesh.attributes.push_back(
      {"constant", Attribute::On::Points, 1, std::vector<float>(mesh.points.size(), 7)});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  mesh.attributes.push_back({"cells", Attribute::On::Cells, 1, std::vector<double>{3, 4}});
  mesh.attributes.push_back({"hollow", Attribute::On::Cells, 1, std::vector<double>{nan, 4}});
  FieldOptions wanted;
  wanted.all = true;
  expectSameSamples(mesh, {}, 1, wanted);
}

TEST(SampleLeaves, CellsOfSeveralTets) {
  expectSameSamples(withCellsOfSix(meshes::scaled(meshes::jittered(kuhnGrid(3, 3, 3), 0.2, 9), 6)));
}

TEST(SampleLeaves, SeveralBatchesOfWholeNodes) {
  const TetMesh ball = withArrays(meshes::ball(5, 64, {3, -70, 100}), 2);
  const SampledFields twin =
      fieldsBy(ball, {}, allFields(),
               [&](const nano::MeshView& view, const nano::FieldJob& job,
                   nano::LeafReceiver& receiver) { nano::HostTwin().sample(view, job, receiver); });
  EXPECT_GT(twin.batches, 3);
  EXPECT_EQ(twin.hash, cpuFields(ball, {}, allFields()).hash);
}

// Several devices share a job by columns of root tiles: this mesh lies in four.
TEST(SampleLeaves, SharesMakeTheSameGrids) {
  const TetMesh mesh = meshes::mapped(meshes::soup(60, 120, 25, 3, 2), [](const Vec3d& p) {
    return Vec3d{p[0] - 60, p[1] - 60, p[2] - 60};
  });
  for (int shares : {2, 3, 7})
    expectSameSamples(mesh, {}, shares);
}

TEST(SampleLeaves, NothingInside) {
  expectSameSamples(meshes::scaled(kuhnGrid(1, 1, 1), 0.1, {0.5, 0.5, 0.5}));
}

TEST(SampleLeaves, CountsFlipsAndDrops) {
  const TetMesh mesh = withArrays(meshes::soup(50, 10, 3, 11, 7), 1);
  FieldOptions wanted;
  wanted.requests = {{"", "kind", FieldPart::Whole, ""}};
  nano::Counts counts;
  fieldsBy(
      mesh, {}, wanted,
      [&](const nano::MeshView& view, const nano::FieldJob& job, nano::LeafReceiver& receiver) {
        counts = nano::HostTwin().sample(view, job, receiver);
      });
  Report report;
  Progress progress;
  Volume volume;
  const SnapCounts expected =
      sampleFields(mesh, {}, resolveFields(mesh, wanted, report), {}, volume, report, progress);
  EXPECT_EQ(counts.flipped, expected.flipped);
  EXPECT_EQ(counts.dropped, expected.dropped);
  EXPECT_GT(counts.flipped, 0u);
}

TEST(SampleLeaves, RefusesWhatRunRefuses) {
  TetMesh mesh = withArrays(kuhnGrid(1, 1, 1), 1);
  FieldOptions wanted;
  wanted.requests = {{"", "kind", FieldPart::Whole, ""}};
  Report report;
  const std::vector<Field> fields = resolveFields(mesh, wanted, report);
  mesh.tets[5] = 8;
  CollectedLeaves leaves;
  const nano::MeshView view{mesh.points[0].data(), mesh.points.size(), mesh.tets.data(),
                            mesh.tetCount(), nullptr};
  try {
    nano::HostTwin().sample(view, fieldJobFor(mesh, {}, fields), leaves);
    FAIL() << "a bad index";
  } catch (const Error& e) {
    EXPECT_EQ(e.status(), Status::Invalid);
  }
}

RC_GTEST_PROP(SampleLeavesProperties, Soups, ()) {
  expectSameSamples(meshes::anySoup());
}

} // namespace
