// SPDX-License-Identifier: Apache-2.0
#include "OpenMeshDecimater.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModHausdorffT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <sys/resource.h>

namespace tetvdb::bench {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

} // namespace

double userSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * double(usage.ru_utime.tv_usec);
}

std::size_t decimateByOpenMesh(const TriangleMesh& mesh, double tolerance, double* seconds) {
  const double start = userSeconds();
  Mesh made;
  made.request_vertex_status();
  made.request_edge_status();
  made.request_halfedge_status();
  made.request_face_status();
  made.request_face_normals();
  for (const Vec3d& p : mesh.points)
    made.add_vertex({p[0], p[1], p[2]});
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
    made.add_face(Mesh::VertexHandle(static_cast<int>(mesh.triangles[i])),
                  Mesh::VertexHandle(static_cast<int>(mesh.triangles[i + 1])),
                  Mesh::VertexHandle(static_cast<int>(mesh.triangles[i + 2])));
  made.update_face_normals();
  OpenMesh::Decimater::DecimaterT<Mesh> decimater(made);
  OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
  OpenMesh::Decimater::ModHausdorffT<Mesh>::Handle hausdorff;
  OpenMesh::Decimater::ModNormalFlippingT<Mesh>::Handle flipping;
  decimater.add(quadric);
  decimater.add(hausdorff);
  decimater.add(flipping);
  decimater.module(quadric).unset_max_err();
  decimater.module(hausdorff).set_tolerance(tolerance);
  decimater.initialize();
  const std::size_t removed = decimater.decimate();
  *seconds = userSeconds() - start;
  return mesh.triangleCount() - 2 * removed;
}

} // namespace tetvdb::bench
