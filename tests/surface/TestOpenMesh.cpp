// SPDX-License-Identifier: Apache-2.0
//
// The surfaces that leave the library, as OpenMesh sees them: its half-edge structure refuses faces
// at an edge or a vertex that is not manifold.
#include "TriangleMeshes.h"
#include "tetvdb/surface/ExtractSurface.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <gtest/gtest.h>
#include <vector>

namespace tetvdb {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

TriangleMesh surfaceOf(const TriangleMesh& mesh, int resolution, double simplify) {
  Report report;
  Progress progress;
  VoxelizeOptions options;
  options.resolution = resolution;
  options.grids = {GridKind::Mask};
  const Voxelization made = voxelize(mesh, {}, options, report, progress);
  ExtractOptions extract;
  extract.simplify = simplify;
  return extractSurface(made.volume, extract, progress);
}

// Faces that OpenMesh refuses, and what is left open or isolated.
void expectClosedManifold(const TriangleMesh& mesh) {
  HalfEdgeMesh halfEdges;
  std::vector<HalfEdgeMesh::VertexHandle> vertices;
  for (const Vec3d& p : mesh.points)
    vertices.push_back(halfEdges.add_vertex(HalfEdgeMesh::Point(p[0], p[1], p[2])));
  std::size_t refused = 0, open = 0, badVertices = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
    refused += !halfEdges
                    .add_face(vertices[mesh.triangles[i]], vertices[mesh.triangles[i + 1]],
                              vertices[mesh.triangles[i + 2]])
                    .is_valid();
  for (const auto edge : halfEdges.edges())
    open += halfEdges.is_boundary(edge);
  for (const auto vertex : halfEdges.vertices())
    badVertices += !halfEdges.is_manifold(vertex) || halfEdges.is_isolated(vertex);
  EXPECT_GT(mesh.triangleCount(), 100u);
  EXPECT_EQ(refused, 0u);
  EXPECT_EQ(open, 0u);
  EXPECT_EQ(badVertices, 0u);
}

TEST(OpenMesh, RefusesWhatIsNotManifold) {
  HalfEdgeMesh halfEdges;
  std::vector<HalfEdgeMesh::VertexHandle> v;
  for (int i = 0; i < 5; ++i)
    v.push_back(halfEdges.add_vertex(HalfEdgeMesh::Point(double(i), double(i * i), 1.0)));
  EXPECT_TRUE(halfEdges.add_face(v[0], v[1], v[2]).is_valid());
  EXPECT_TRUE(halfEdges.add_face(v[1], v[0], v[3]).is_valid());
  EXPECT_FALSE(halfEdges.add_face(v[0], v[1], v[4]).is_valid());
}

TEST(OpenMesh, TakesExtractedSurfaces) {
  meshes::Random random(17);
  TriangleMesh crowd; // balls that touch and overlap anyhow
  for (int i = 0; i < 40; ++i)
    meshes::append(crowd, meshes::sphere({random.unit(), random.unit(), random.unit()},
                                         random.between(0.03, 0.2), 4));
  for (const double simplify : {0.0, 0.2}) {
    expectClosedManifold(surfaceOf(crowd, 40, simplify));
    expectClosedManifold(surfaceOf(meshes::torus(), 30, simplify));
    expectClosedManifold(surfaceOf(
        meshes::without(meshes::sphere(), [](std::size_t f) { return f % 9 == 0; }), 30, simplify));
  }
}

} // namespace
} // namespace tetvdb
