// SPDX-License-Identifier: Apache-2.0
//
// What `tetvdb voxelize` makes of spoiled meshes, compared with the solids of clean ones; many in
// one process.
//
//   cleaning_judge RESOLUTION < MESHES
//
// MESHES: one after the other, int64: what it is (0: a clean mesh, 1: a spoiled one, 2: a spoiled
// one, not to be cleaned), numbers of points and triangles, then points (three doubles each) and
// triangles (three int32 each). A clean mesh is voxelized as it stands, with RESOLUTION voxels
// along its box, which begin off round numbers; spoiled ones, cleaned, with the same transform.
// Each gets a line:
//
//   STATUS CLEAN_VOXELS VOXELS COMMON_VOXELS CLEAN_SECONDS VOXELIZE_SECONDS OPEN_EDGES WARNINGS
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/CleanInput.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <openvdb/openvdb.h>
#include <string>

namespace {

using namespace tetvdb;

double seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

template <typename T>
bool take(T* records, std::size_t count) {
  return std::fread(records, sizeof(T), count, stdin) == count;
}

openvdb::BoolGrid::Ptr maskOf(const Voxelization& made) {
  return openvdb::gridPtrCast<openvdb::BoolGrid>(made.volume.grids().all.front());
}

struct Judge {
  VoxelizeOptions options;
  openvdb::BoolGrid::Ptr clean;

  void takeClean(const TriangleMesh& mesh) {
    options.voxelSize = options.origin = {0, 0, 0};
    options.voxelSize = chooseTransform(mesh, options).voxelSize;
    // No face of a model lies on voxel centres, where rounding would tell.
    for (std::size_t axis = 0; axis < 3; ++axis)
      options.origin[axis] = options.voxelSize[axis] * (0.317 + 0.1 * static_cast<double>(axis));
    Report report;
    Progress progress;
    const Voxelization made = voxelize(mesh, {}, options, report, progress);
    clean = maskOf(made);
    const auto voxels = static_cast<unsigned long long>(clean->activeVoxelCount());
    std::printf("0 %llu %llu %llu 0 0 %zu -\n", voxels, voxels, voxels, made.counts.openEdges);
  }

  void takeSpoiled(TriangleMesh& mesh, bool cleanIt) const {
    Report report;
    Progress progress;
    int status = 0;
    openvdb::Index64 voxels = 0, common = 0;
    const double start = seconds();
    double cleaned = start;
    std::size_t openEdges = 0;
    try {
      if (cleanIt)
        cleanInput(mesh, "", {}, report, progress);
      cleaned = seconds();
      const Voxelization made = voxelize(mesh, {}, options, report, progress);
      const openvdb::BoolGrid::Ptr mask = maskOf(made);
      voxels = mask->activeVoxelCount();
      mask->tree().topologyIntersection(clean->tree());
      common = mask->activeVoxelCount();
      openEdges = made.counts.openEdges;
      status = report.partial ? 1 : 0;
    } catch (const Error& error) {
      status = static_cast<int>(error.status());
    }
    std::string warnings;
    for (const Warning& warning : report.warnings)
      warnings += (warnings.empty() ? "" : ",") + warning.code;
    std::printf("%d %llu %llu %llu %.6f %.6f %zu %s\n", status,
                static_cast<unsigned long long>(clean->activeVoxelCount()),
                static_cast<unsigned long long>(voxels), static_cast<unsigned long long>(common),
                cleaned - start, seconds() - cleaned, openEdges,
                warnings.empty() ? "-" : warnings.c_str());
  }
};

} // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: cleaning_judge RESOLUTION < MESHES\n");
    return 2;
  }
  Judge judge;
  judge.options.grids = {GridKind::Mask};
  judge.options.resolution = std::atoi(arguments[1]);
  std::int64_t header[3];
  while (take(header, 3)) {
    TriangleMesh mesh;
    mesh.points.resize(static_cast<std::size_t>(header[1]));
    mesh.triangles.resize(3 * static_cast<std::size_t>(header[2]));
    mesh.faceCount = mesh.triangleCount();
    if (!take(mesh.points.data(), mesh.points.size()) ||
        !take(mesh.triangles.data(), mesh.triangles.size())) {
      std::fprintf(stderr, "cleaning_judge: the input ends early\n");
      return 2;
    }
    if (header[0] == 0)
      judge.takeClean(mesh);
    else
      judge.takeSpoiled(mesh, header[0] == 1);
    std::fflush(stdout);
  }
  return 0;
}
