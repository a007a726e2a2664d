// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <cstdint>
#include <vector>

namespace tetvdb {

struct HalfEdgeTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};

/// OpenMesh's half-edge mesh of triangles, with doubles.
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<HalfEdgeTraits>;

/// Adds as many vertices, all at 0, and these faces, whose corners are three indices each, in
/// order. Returns false if they are no closed manifold; then not all of them were added.
bool addClosedManifold(HalfEdgeMesh& mesh, std::size_t vertices,
                       const std::vector<std::uint32_t>& corners);

} // namespace tetvdb
