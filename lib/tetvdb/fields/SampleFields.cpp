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

// A packed leaf is a mask, its place, and a tail that is kept while few are.
constexpr double kPackedLeafBytes = 240;

double bytesOf(const TreeEstimate& tree, const std::vector<Field>& fields,
               const PackOptions* pack) {
  double leaf = 0;
  for (const Field& field : fields)
    leaf += pack != nullptr ? kPackedLeafBytes : static_cast<double>(leafBytes(field.kind));
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

// The grids of `fields`, in `packed` where `pack` is not null.
SnapCounts sample(const TetMesh& mesh, const GridTransform& transform,
                  const std::vector<Field>& fields, const SampleOptions& options,
                  const PackOptions* pack, std::vector<std::unique_ptr<PackedGrid>>& packed,
                  openvdb::GridPtrVec& made, Report& report, Progress& progress) {
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
  if (working + bytesOf(estimateByBox(snapped), fields, pack) > static_cast<double>(limit))
    requireMemory(working + bytesOf(estimateByVolume(snapped), fields, pack), limits);

  timer.part("sample");
  if (pack != nullptr) {
    const auto store = std::make_shared<TailStore>(pack->folder, pack->inMemory);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      packed.push_back(std::make_unique<PackedGrid>());
      packed.back()->store = store;
    }
  }
  FieldGrids grids(mesh, snapped, transform, fields, pack != nullptr && pack->half, packed);
  const OrientationCounts oriented = rasterizeNodes(snapped, true, grids, progress);
  if (!grids.any() && !options.allowEmpty)
    throw Error(Status::Invalid, "", "no voxel centre lies inside the mesh",
                "use smaller voxels, or --allow-empty to write an empty grid");

  timer.part("tree");
  made = grids.finish(transform);
  for (std::size_t i = 0; i < made.size(); ++i) {
    describeValues(fields[i], *made[i]);
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

} // namespace

SnapCounts sampleFields(const TetMesh& mesh, const GridTransform& transform,
                        const std::vector<Field>& fields, const SampleOptions& options,
                        Volume& volume, Report& report, Progress& progress) {
  std::vector<std::unique_ptr<PackedGrid>> none;
  openvdb::GridPtrVec made;
  const SnapCounts counts =
      sample(mesh, transform, fields, options, nullptr, none, made, report, progress);
  openvdb::GridPtrVec& all = volume.grids().all;
  all.insert(all.end(), made.begin(), made.end());
  return counts;
}

SnapCounts packFields(const TetMesh& mesh, const GridTransform& transform,
                      const std::vector<Field>& fields, const SampleOptions& options,
                      const PackOptions& pack, std::vector<std::unique_ptr<PackedGrid>>& packed,
                      Report& report, Progress& progress) {
  packed.clear();
  openvdb::GridPtrVec made;
  return sample(mesh, transform, fields, options, &pack, packed, made, report, progress);
}

} // namespace tetvdb
