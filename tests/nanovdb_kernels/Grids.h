// SPDX-License-Identifier: Apache-2.0
//
// Compares grids of the device, or of its twin on the host, with those of the CPU.
#pragma once

#include "nanovdb_kernels/DeviceVoxelizer.h"
#include "tetvdb/volume/NanoGrids.h"
#include "tetvdb/voxelize/ViewOfMesh.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <cstring>
#include <memory>
#include <string>
#include <utility>

namespace tetvdb {

inline nano::Job jobFor(nano::GridType type, nano::Method method, const GridTransform& transform) {
  nano::Job job;
  job.type = type;
  job.method = method;
  for (std::size_t k = 0; k < 3; ++k) {
    job.voxelSize[k] = transform.voxelSize[k];
    job.origin[k] = transform.origin[k];
  }
  job.name = type == nano::GridType::Fog     ? "density"
             : type == nano::GridType::Owner ? "tet_id"
                                             : "mask";
  return job;
}

inline std::string cpuHash(const TetMesh& mesh, GridKind kind, const GridTransform& transform) {
  VoxelizeOptions options;
  options.voxelSize = transform.voxelSize;
  options.origin = transform.origin;
  options.grids = {kind};
  options.allowEmpty = true;
  Report report;
  Progress progress;
  return hash(voxelize(mesh, options, report, progress).volume);
}

inline std::string hashOf(const nano::Result& result) {
  auto grids = std::make_shared<GridSet>();
  grids->all.push_back(gridOfNano(result.bytes));
  return hash(Volume(std::move(grids)));
}

inline bool sameBytes(const nano::Result& a, const nano::Result& b) {
  return a.counts.bufferBytes == b.counts.bufferBytes &&
         std::memcmp(a.bytes, b.bytes, a.counts.bufferBytes) == 0;
}

} // namespace tetvdb
