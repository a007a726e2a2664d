// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/FitVolume.h"

#include "tetvdb/volume/Grids.h"

#include <fmt/format.h>
#include <string>

namespace tetvdb {

std::array<std::array<double, 4>, 4> worldFromIndex(const GridTransform& transform) {
  const Vec3d &h = transform.voxelSize, &o = transform.origin;
  return {{{h[0], 0, 0, o[0]}, {0, h[1], 0, o[1]}, {0, 0, h[2], o[2]}, {0, 0, 0, 1}}};
}

void fitVolume(Volume& volume, const GridTransform& transform, const FitBox& fit, Report& report) {
  if (fit.voxels <= 0)
    return;
  const openvdb::CoordBBox cube(openvdb::Coord(0), openvdb::Coord(fit.voxels - 1));
  std::string cut;
  for (const auto& grid : volume.grids().all) {
    const openvdb::CoordBBox active = grid->evalActiveVoxelBoundingBox();
    if (active.empty() || cube.isInside(active))
      continue;
    grid->clip(cube);
    cut += (cut.empty() ? "'" : ", '") + grid->getName() + "'";
  }
  if (!cut.empty())
    report.warn("cut-band",
                fmt::format("{} reached beyond the {}^3 voxels and ends there; a larger "
                            "`padding` keeps the band whole",
                            cut, fit.voxels));
  std::string matrix;
  for (const auto& row : worldFromIndex(transform))
    for (const double number : row)
      matrix += fmt::format("{}{}", matrix.empty() ? "" : " ", number);
  volume.metadata["fit"] = std::to_string(fit.voxels);
  volume.metadata["padding"] = std::to_string(fit.padding);
  volume.metadata["world_from_index"] = matrix;
}

} // namespace tetvdb
