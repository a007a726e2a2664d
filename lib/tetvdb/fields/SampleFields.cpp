// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/SampleFields.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/fields/FieldGrids.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TetNodes.h"
#include "tetvdb/voxelize/TreeBuilder.h"
#include "tetvdb/voxelize/TreeEstimate.h"

#include <algorithm>
#include <fmt/format.h>

namespace tetvdb {
namespace {

double bytesOf(const TreeEstimate& tree, const std::vector<Field>& fields) {
  double leaf = 0;
  for (const Field& field : fields)
    leaf += static_cast<double>(leafBytes(field.kind));
  return tree.leaves * leaf + tree.lowerNodes * static_cast<double>(kLowerNodeBytes) *
                                  static_cast<double>(fields.size());
}

void describeValues(const Field& field, openvdb::GridBase& grid) {
  grid.insertMeta("source_array", openvdb::StringMetadata(field.array));
  grid.insertMeta("source_on",
                  openvdb::StringMetadata(field.on == Attribute::On::Points ? "points" : "cells"));
  if (!field.original.empty()) {
    grid.insertMeta("original_min", openvdb::DoubleMetadata(field.original.low));
    grid.insertMeta("original_max", openvdb::DoubleMetadata(field.original.high));
  }
  if (field.scale != 1 || field.offset != 0) {
    grid.insertMeta("scale", openvdb::DoubleMetadata(field.scale));
    grid.insertMeta("offset", openvdb::DoubleMetadata(field.offset));
  }
  if (!field.clamp.empty()) {
    grid.insertMeta("clamp_min", openvdb::DoubleMetadata(field.clamp.low));
    grid.insertMeta("clamp_max", openvdb::DoubleMetadata(field.clamp.high));
  }
}

} // namespace

SnapCounts sampleFields(const TetMesh& mesh, const GridTransform& transform,
                        const std::vector<Field>& fields, const SampleOptions& options,
                        Volume& volume, Report& report, Progress& progress) {
  progress.stage("fields");
  initializeOpenVDB();
  if (mesh.tetCount() >= 0xFFFFFFFFu)
    throw Error(Status::Limit, "", "the mesh has 2^32 tets or more", "split it in parts");
  StageTimer timer(report, "fields");
  timer.part("snap");
  const SnappedMesh snapped = snapMesh(mesh, transform, progress);

  timer.part("estimate");
  VoxelizeOptions limits;
  limits.maxMemory = options.maxMemory;
  const double working =
      24.0 * static_cast<double>(snapped.pointCount) + 16.0 * static_cast<double>(snapped.tetCount);
  const std::size_t limit = options.maxMemory != 0 ? options.maxMemory : availableBytes();
  if (working + bytesOf(estimateByBox(snapped), fields) > static_cast<double>(limit))
    requireMemory(working + bytesOf(estimateByVolume(snapped), fields), limits);

  timer.part("sample");
  FieldGrids grids(mesh, snapped, fields);
  const OrientationCounts oriented = rasterizeNodes(snapped, true, grids, progress);
  if (!grids.any() && !options.allowEmpty)
    throw Error(Status::Invalid, "", "no voxel centre lies inside the mesh",
                "use smaller voxels, or --allow-empty to write an empty grid");

  timer.part("tree");
  const openvdb::GridPtrVec made = grids.finish(transform);
  for (std::size_t i = 0; i < made.size(); ++i) {
    describeValues(fields[i], *made[i]);
    volume.grids().all.push_back(made[i]);
    if (grids.leftOut(i) > 0)
      report.warn("voxels-left-out",
                  fmt::format("{} voxels of '{}' have no finite value and are left out",
                              grids.leftOut(i), fields[i].name));
  }
  SnapCounts counts;
  counts.flipped = oriented.flipped;
  counts.dropped = oriented.dropped;
  return counts;
}

} // namespace tetvdb
