// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/SampleFields.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/fields/SampledGrids.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TetNodes.h"
#include "tetvdb/voxelize/TreeBuilder.h"
#include "tetvdb/voxelize/TreeEstimate.h"

#include <memory>
#include <vector>

namespace tetvdb {
namespace {

double bytesOf(const TreeEstimate& tree, const FieldBytes& bytes) {
  return tree.leaves * bytes.leaf + tree.lowerNodes * bytes.lowerNode;
}

// The grids of `fields`, in `packed` if `pack` is not null.
SnapCounts sample(const TetMesh& mesh, const GridTransform& transform,
                  const std::vector<Field>& fields, const SampleOptions& options,
                  const PackOptions* pack, std::vector<std::unique_ptr<PackedGrid>>& packed,
                  openvdb::GridPtrVec& made, Report& report, Progress& progress) {
  progress.stage("fields");
  initializeOpenVDB();
  if (mesh.tetCount() >= 0xFFFFFFFFu)
    throw Error(Status::Limit, "", "the mesh has 2^32 tets or more", "split it in parts");
  checkMesh(mesh);
  StageTimer timer(report, "fields");
  timer.part("snap");
  const SnappedMesh snapped = snapMesh(mesh, transform, progress);

  timer.part("estimate");
  VoxelizeOptions limits;
  limits.maxMemory = options.maxMemory;
  const double working =
      24.0 * static_cast<double>(snapped.pointCount) + 16.0 * static_cast<double>(snapped.tetCount);
  const FieldBytes bytes = fieldBytes(fields, pack);
  const std::size_t limit = options.maxMemory != 0 ? options.maxMemory : availableBytes();
  if (working + bytesOf(estimateByBox(snapped), bytes) > static_cast<double>(limit))
    requireMemory(working + bytesOf(estimateByVolume(snapped), bytes), limits);

  timer.part("sample");
  SampledGrids grids(mesh, snapped, transform, fields, pack, packed);
  const OrientationCounts oriented = rasterizeNodes(snapped, true, grids.grids(), progress);
  grids.requireAny(options);

  timer.part("tree");
  made = grids.finish(transform, report);
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
