// SPDX-License-Identifier: Apache-2.0
#include "Cases.h"

#include <cmath>
#include <fmt/format.h>

namespace tetvdb::bench {

const std::vector<Case>& allCases() {
  static const std::vector<Case> cases = {
      {"occupancy", "mask and density against the paper's loop and an accessor", runOccupancy,
       false},
      {"owners", "tet_id against the paper's loop and VTK", runOwners, false},
      {"fields", "arrays of 10^6 tets into a file against VTK", runFields, false},
      {"large", "the whole program on a ball of 10^5 tets at 4096^3", runLarge, false},
      {"paths", "boundary path against tet path over sizes of tets", runPaths, false},
      {"write", "writing 1 M leaves against openvdb::io::File", runWrite, false},
      {"read", "reading 10^7 tets against a plain read of the bytes", runRead, false},
      {"triangles", "a mask of closed and open triangles against OpenVDB's meshToVolume",
       runTriangles, false},
      {"readtri", "reading 200 MB of STL, OBJ, OFF and PLY", runReadTriangles, false},
      {"levelset", "a level set against OpenVDB's meshToVolume, with errors", runLevelSet, false},
      {"coverage", "the exact share of every voxel", runCoverage, false},
      {"rules", "conservative masks against the mask by centres", runRules, false},
      {"render", "a picture of 10^6 triangles by the whole program", runRender, false},
      {"huge", "the whole program at 16384^3 (10 GB of memory)", runHuge, true},
      {"write5m", "writing 5 M leaves (11 GB of memory)", runWrite5M, true}};
  return cases;
}

std::string countName(double count) {
  const double power = std::log10(count);
  const double whole = std::round(power);
  if (std::abs(power - whole) < 0.05)
    return fmt::format("10^{:.0f}", whole);
  return fmt::format("{:.2g}", count);
}

double timeOurs(const TetMesh& mesh, const VoxelizeOptions& options, OursResult* last) {
  Report report;
  Progress progress;
  const Voxelization result = voxelize(mesh, options, report, progress);
  if (last != nullptr) {
    const GridInfo info = describe(result.volume).front();
    *last = {info.activeVoxels, info.bytes, result.path, report.stages.back().parts};
  }
  return report.stages.back().seconds;
}

double floorBytes(const TetMesh& mesh, double outputBytes) {
  return static_cast<double>(mesh.tets.size() * sizeof(std::uint32_t)) +
         static_cast<double>(mesh.points.size() * sizeof(Vec3d)) + outputBytes;
}

} // namespace tetvdb::bench
