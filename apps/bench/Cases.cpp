// SPDX-License-Identifier: Apache-2.0
#include "Cases.h"

#include <algorithm>
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
      {"render", "pictures of 10^6 triangles and tets by the whole program", runRender, false},
      {"tets", "time against the number of tets", runTets, false},
      {"resolution", "time against the number of voxels along a side", runResolution, false},
      {"mesher", "tetrahedra from triangles, and how that grows", runMesher, false},
      {"models", "tetrahedra from the files of --mesh, by one thread and all", runModels, true},
      {"simplify", "fewer triangles, of --mesh or a sphere, against OpenMesh's decimater",
       runSimplify, true},
      {"centroid", "voxels of the files of --mesh by the centroid covering and by winding number",
       runCentroid, true},
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

int shrunk(int resolution, const Setup& setup) {
  return std::max(8, static_cast<int>(resolution / std::cbrt(static_cast<double>(setup.shrink))));
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
