// SPDX-License-Identifier: Apache-2.0
//
// Level sets that the device, its twin and the CPU must make the same grids of.
#pragma once

#include "BandCases.h"
#include "SoupCases.h"
#include "tetvdb/fields/FogVolume.h"

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

/// hash() of the CPU's fog.
inline std::string fogHash(const BandCase& band) {
  Progress progress;
  const openvdb::FloatGrid::Ptr grid =
      levelSet(band.mesh, band.faces, *band.inside, band.transform, band.halfWidth, band.shell,
               rasterizeBand, progress);
  makeFog(*grid, fogDepth(*grid));
  auto grids = std::make_shared<GridSet>();
  grids->all.push_back(grid);
  return hash(Volume(std::move(grids)));
}

/// The job for the fog of the level set of `job`.
inline nano::LevelSetJob fogJobOf(nano::LevelSetJob job) {
  job.fog = true;
  job.name = "fog";
  return job;
}

} // namespace tetvdb
