// SPDX-License-Identifier: Apache-2.0
//
// Meshes and boxes as nanovdb_kernels takes them. Internal.
#pragma once

#include "nanovdb_kernels/DeviceVoxelizer.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/VoxelBox.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// Refers to the mesh's arrays. The value of a tet is its cell, if that may have several.
inline nano::MeshView viewOf(const TetMesh& mesh) {
  nano::MeshView view;
  view.points = mesh.points.empty() ? nullptr : mesh.points[0].data();
  view.pointCount = mesh.points.size();
  view.tets = mesh.tets.data();
  view.tetCount = mesh.tetCount();
  static_assert(sizeof(std::uint32_t) == sizeof(std::int32_t));
  if (!mesh.cellOfTet.empty())
    view.values = reinterpret_cast<const std::int32_t*>(mesh.cellOfTet.data());
  return view;
}

/// Refers to the mesh's arrays; without holes.
inline nano::MeshView viewOf(const TriangleMesh& mesh) {
  nano::MeshView view;
  view.points = mesh.points.empty() ? nullptr : mesh.points[0].data();
  view.pointCount = mesh.points.size();
  view.triangles = mesh.triangles.data();
  view.triangleCount = mesh.triangleCount();
  return view;
}

inline nano::VoxelRange rangeOf(const VoxelBox& box) {
  nano::VoxelRange range{};
  for (std::size_t k = 0; k < 3; ++k) {
    range.min[k] = box.low[k];
    range.size[k] = static_cast<std::uint32_t>(box.size(k));
  }
  return range;
}

} // namespace tetvdb
