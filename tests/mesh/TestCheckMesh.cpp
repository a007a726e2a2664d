// SPDX-License-Identifier: Apache-2.0
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/surface/CompareMeshes.h"
#include "tetvdb/surface/SurfaceDefects.h"
#include "tetvdb/surface/TetSurface.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"
#include "tetvdb/voxelize/Voxelize.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <filesystem>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <tbb/global_control.h>

namespace tetvdb {
namespace {

TetMesh oneTet() {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tets = {0, 1, 2, 3};
  mesh.cellCount = 1;
  return mesh;
}

TriangleMesh itsFaces() {
  TriangleMesh mesh;
  mesh.points = oneTet().points;
  mesh.triangles = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  return mesh;
}

void expectInvalid(const std::function<void()>& work, const std::string& says) {
  try {
    work();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Invalid);
    EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
  }
}

TEST(CheckMesh, WhatReadersGiveIsInOrder) {
  checkMesh(oneTet());
  checkMesh(itsFaces());
  checkMesh(TetMesh());
  checkMesh(TriangleMesh());
  TetMesh named = oneTet();
  named.regions = {7};
  named.cellOfTet = {0};
  checkMesh(named);
}

TEST(CheckMesh, NamesTheFirstWrongTriangle) {
  TriangleMesh mesh = itsFaces();
  mesh.triangles[7] = 4;
  mesh.triangles[10] = 0xFFFFFFFF;
  expectInvalid([&] { checkMesh(mesh); }, "triangle 2 uses point 4, but there are 4");
  mesh = itsFaces();
  mesh.triangles.push_back(0);
  expectInvalid([&] { checkMesh(mesh); }, "13 indices");
  mesh = itsFaces();
  mesh.points[3][1] = std::numeric_limits<double>::quiet_NaN();
  expectInvalid([&] { checkMesh(mesh); }, "point 3");
  mesh.points[2][0] = -std::numeric_limits<double>::infinity();
  expectInvalid([&] { checkMesh(mesh); }, "point 2");
}

TEST(CheckMesh, TheFirstWhateverTheThreads) {
  TriangleMesh mesh = itsFaces();
  mesh.triangles.resize(3000000, 1);
  for (std::size_t i = 1234567; i < mesh.triangles.size(); i += 1000)
    mesh.triangles[i] = 9;
  for (const std::size_t threads : {1u, 2u, 7u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    expectInvalid([&] { checkMesh(mesh); }, "triangle 411522 ");
  }
}

TEST(CheckMesh, TetsAndTheirCells) {
  TetMesh mesh = oneTet();
  mesh.tets[3] = 4;
  expectInvalid([&] { checkMesh(mesh); }, "tet 0 uses point 4");
  mesh = oneTet();
  mesh.tets.pop_back();
  expectInvalid([&] { checkMesh(mesh); }, "3 indices");
  mesh = oneTet();
  mesh.cellOfTet = {0, 0};
  expectInvalid([&] { checkMesh(mesh); }, "2 tets");
  mesh = oneTet();
  mesh.regions = {1};
  mesh.cellOfTet = {1};
  expectInvalid([&] { checkMesh(mesh); }, "cell 1");
}

TEST(CheckMesh, QuadraticCells) {
  TetMesh mesh = oneTet();
  mesh.points.resize(10, {0.5, 0.5, 0.5});
  mesh.curved.nodes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  mesh.curved.cells = {{0, CurvedShape::Tet10}};
  mesh.curved.cellOfTet = {0};
  mesh.curved.corners = {{0, 1, 2, 3}};
  checkMesh(mesh);
  const auto spoiled = [&](const auto& spoil) {
    TetMesh other = mesh;
    spoil(other.curved);
    expectInvalid([&] { checkMesh(other); }, "shape functions");
  };
  spoiled([](CurvedCells& curved) { curved.nodes[9] = 10; });
  spoiled([](CurvedCells& curved) { curved.cells[0].first = 1; });
  spoiled([](CurvedCells& curved) { curved.cells[0].first = ~std::uint64_t(0); });
  spoiled([](CurvedCells& curved) { curved.cells[0].shape = CurvedShape::Hex20; });
  spoiled([](CurvedCells& curved) { curved.cellOfTet[0] = 1; });
  spoiled([](CurvedCells& curved) { curved.cellOfTet.clear(); });
  spoiled([](CurvedCells& curved) { curved.corners[0][2] = 99; });
  mesh.curved.cellOfTet[0] = CurvedCells::kLinear;
  mesh.curved.corners[0][2] = 99; // nobody asks for it
  checkMesh(mesh);
}

TEST(CheckMesh, EveryFunctionThatTakesAMeshAsks) {
  const TemporaryFolder folder;
  TriangleMesh faces = itsFaces();
  faces.triangles[0] = 1000000000;
  TetMesh tets = oneTet();
  tets.tets[0] = 1000000000;
  const std::string says = "uses point 1000000000";
  Report report;
  Progress progress;
  VoxelizeOptions options;
  options.voxelSize = {0.1, 0.1, 0.1};
  expectInvalid([&] { (void)voxelize(tets, options, report, progress); }, says);
  expectInvalid([&] { (void)voxelize(faces, SolidOptions(), options, report, progress); }, says);
  expectInvalid([&] { (void)cleanTriangles(faces, {}, progress); }, says);
  expectInvalid([&] { (void)tetrahedralize({itsFaces(), faces}, {}, report, progress); }, says);
  expectInvalid([&] { (void)surfaceDefects(faces, {}, progress); }, says);
  expectInvalid([&] { (void)compareMeshes(itsFaces(), faces, {}, progress); }, says);
  expectInvalid([&] { (void)tetSurface(tets, progress); }, says);
  ShapeOptions shapes;
  shapes.grids = {GridKind::Surface};
  Voxelization made = voxelize(oneTet(), options, report, progress);
  expectInvalid([&] { (void)addShapeGrids(tets, shapes, made, report, progress); }, says);
  expectInvalid([&] { (void)addShapeGrids(faces, SolidOptions(), shapes, made, report, progress); },
                says);
  for (const char* name : {"a.stl", "a.obj", "a.ply", "a.off", "a.3mf"})
    expectInvalid([&] { writeTriangles(folder / name, faces, progress); }, says);
  for (const char* name : {"a.msh", "a.mesh", "a.vtu"})
    expectInvalid([&] { writeTetMesh(folder / name, tets, progress); }, says);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

} // namespace
} // namespace tetvdb
