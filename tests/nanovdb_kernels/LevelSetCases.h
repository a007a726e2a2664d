// SPDX-License-Identifier: Apache-2.0
//
// Level sets that the device, its twin and the CPU must make the same grids of.
#pragma once

#include "BandCases.h"
#include "SoupCases.h"

namespace tetvdb {

/// All triangles, and what they enclose.
inline BandCase bandOf(const TriangleMesh& mesh, FillRule rule, const GridTransform& transform,
                       double halfWidth) {
  VoxelizeOptions options;
  options.voxelSize = transform.voxelSize;
  options.origin = transform.origin;
  options.grids = {GridKind::Mask};
  options.allowEmpty = true;
  SolidOptions solid;
  solid.inside = insideOf(rule);
  Report report;
  Progress progress;
  const Voxelization made = voxelize(mesh, solid, options, report, progress);
  BandCase band;
  band.mesh = snapPoints(mesh.points, transform, progress);
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i)
    band.faces.faces.push_back(
        {mesh.triangles[3 * i], mesh.triangles[3 * i + 1], mesh.triangles[3 * i + 2], 1});
  band.inside = openvdb::gridPtrCast<openvdb::BoolGrid>(made.volume.grids().all.front());
  band.transform = transform;
  band.halfWidth = halfWidth;
  return band;
}

} // namespace tetvdb
