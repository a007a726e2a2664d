// SPDX-License-Identifier: Apache-2.0
//
// The library example of the README, on a mesh of one tet. With an argument a mesh is read.
#include <cstdio>
#include <tetvdb/tetvdb.h>
#include <tetvdb/volume/Grids.h>

int main(int count, char** arguments) {
  if (count > 1) {
    tetvdb::Report report;
    tetvdb::Progress progress;
    return tetvdb::readCells(arguments[1], {}, report, progress).cellCount() > 0 ? 0 : 1;
  }
  tetvdb::TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tets = {0, 1, 2, 3};
  mesh.cellCount = 1;

  tetvdb::VoxelizeOptions options;
  options.voxelSize = {0.01, 0.01, 0.01};
  tetvdb::Report report;
  tetvdb::Progress progress;
  const tetvdb::Voxelization result = tetvdb::voxelize(mesh, options, report, progress);
  for (const auto& grid : result.volume.grids().all)
    std::printf("%s: %llu voxels\n", grid->getName().c_str(),
                static_cast<unsigned long long>(grid->activeVoxelCount()));

  tetvdb::VoxelizeJob job;
  job.inputs = {"there-is-no-such-file.msh"};
  job.output = "out.vdb";
  try {
    tetvdb::run(job, report, progress);
  } catch (const tetvdb::Error& error) {
    std::printf("%s\n", error.what());
    return error.status() == tetvdb::Status::Invalid ? 0 : 1;
  }
  return 1;
}
