// SPDX-License-Identifier: Apache-2.0
//
// Columns that the device's code makes, on the host, against the CPU's rasteriser.
#include "Grids.h"
#include "Meshes.h"
#include "SoupCases.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/voxelize/NanoOccupancySource.h"
#include "tetvdb/voxelize/OccupancySource.h"
#include "tetvdb/voxelize/SolidFaces.h"

#include <gtest/gtest.h>
#include <tuple>
#include <vector>

namespace tetvdb {
namespace {

void expectSameNode(const BitNode* a, const BitNode* b) {
  ASSERT_EQ(a == nullptr, b == nullptr);
  if (a == nullptr)
    return;
  EXPECT_EQ(a->children, b->children);
  EXPECT_EQ(a->tiles, b->tiles);
  EXPECT_EQ(a->leaves, b->leaves);
}

// Both sources say the same of every stack; returns the number of mixed nodes.
std::size_t expectSame(BitSource& expected, BitSource& found) {
  std::size_t mixed = 0;
  for (std::size_t cube = 0; cube < expected.cubes().size(); ++cube) {
    if (expected.cubes()[cube].full)
      continue;
    // Stacks that may hold something may differ by those that hold nothing.
    std::vector<BitStack> stacks(kStacksPerCube), others(kStacksPerCube);
    for (const int stack : expected.begin(cube))
      expected.fill(stack, stacks[static_cast<std::size_t>(stack)]);
    for (const int stack : found.begin(cube))
      found.fill(stack, others[static_cast<std::size_t>(stack)]);
    for (std::size_t i = 0; i < stacks.size(); ++i) {
      EXPECT_EQ(stacks[i].states, others[i].states) << cube << ' ' << i;
      for (std::size_t z = 0; z < kStackNodes; ++z) {
        expectSameNode(stacks[i].nodes[z].get(), others[i].nodes[z].get());
        mixed += stacks[i].nodes[z] != nullptr ? 1 : 0;
      }
    }
  }
  return mixed;
}

std::size_t expectSame(const nano::MeshView& view, const SolidFaces& faces,
                       const GridTransform& transform) {
  Progress progress;
  OccupancySource expected(faces.snapped, faces.chain, faces.fill(), VoxelRule::Centre, progress);
  nano::HostTwin twin;
  std::size_t columns = 0;
  nano::Job job = jobFor(nano::GridType::Mask, nano::Method::Auto, transform);
  job.rule = faces.rule;
  job.oneColumn = true;
  NanoOccupancySource found(expected.cubes(), [&](std::int32_t x, std::int32_t y) {
    job.column[0] = x;
    job.column[1] = y;
    ++columns;
    return twin.run(view, job).bytes;
  });
  const std::size_t mixed = expectSame(expected, found);
  EXPECT_GT(columns, 0U);
  return mixed;
}

TEST(NanoOccupancySource, ColumnsOfTets) {
  Report report;
  StageTimer timer(report, "voxelize");
  Progress progress;
  for (const TetMesh& mesh :
       {meshes::ball(3, 2100, {10, 20, 30}), meshes::ball(4, 60, {-5, 4090, 8})})
    EXPECT_GT(expectSame(viewOf(mesh), solidFaces(mesh, {}, timer, progress), {}), 0U);
  // Cubes that are full, or empty beside a face: no node is mixed.
  const TetMesh block = meshes::scaled(meshes::kuhnGrid(2, 1, 3), 4096);
  EXPECT_EQ(expectSame(viewOf(block), solidFaces(block, {}, timer, progress), {}), 0U);
}

TEST(NanoOccupancySource, ColumnsOfTriangles) {
  Report report;
  StageTimer timer(report, "voxelize");
  Progress progress;
  const TriangleMesh mesh = meshes::sphere({4000, -70, 4100}, 240.3, 12);
  for (const InsideRule rule : {InsideRule::Winding, InsideRule::Parity}) {
    SolidOptions solid;
    solid.inside = rule;
    EXPECT_GT(expectSame(viewOf(mesh), solidFaces(mesh, solid, {}, timer, progress), {}), 0U);
  }
}

// A column beside the mesh has nothing.
TEST(NanoOccupancySource, ColumnWithoutVoxels) {
  const TetMesh mesh = meshes::ball(3, 20, {0, 0, 0});
  nano::HostTwin twin;
  nano::Job job = jobFor(nano::GridType::Mask, nano::Method::Auto, GridTransform{});
  job.oneColumn = true;
  for (const auto& [x, y, some] :
       {std::tuple{0, 0, true}, {-1, 0, true}, {7, 0, false}, {0, -9, false}}) {
    job.column[0] = x;
    job.column[1] = y;
    for (const nano::Method method : {nano::Method::Boundary, nano::Method::Tets}) {
      job.method = method;
      EXPECT_EQ(twin.run(viewOf(mesh), job).counts.leaves > 0, some) << x << ' ' << y;
    }
  }
}

} // namespace
} // namespace tetvdb
