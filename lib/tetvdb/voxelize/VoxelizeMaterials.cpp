// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/VoxelizeMaterials.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/voxelize/KeepResolution.h"
#include "tetvdb/voxelize/MaskRaster.h"
#include "tetvdb/voxelize/TreeBuilder.h"
#include "tetvdb/voxelize/TreeEstimate.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace tetvdb {
namespace {

using Masks = std::vector<openvdb::BoolGrid::ConstPtr>;

void check(const std::vector<TriangleMesh>& meshes, const std::vector<std::string>& names,
           const VoxelizeOptions& options) {
  if (meshes.empty() || names.size() != meshes.size())
    throw Error(Status::Usage, "voxelizeMaterials()", "needs meshes, and a name for each");
  checkGridKinds(options.grids, {GridMaker::Occupancy, GridMaker::Owner});
  if (contains(options.grids, GridKind::TetId))
    throw Error(Status::Usage, "`grid`", "tet_id needs tetrahedra, the input is triangles",
                "ask for material, density or mask");
  if (contains(options.grids, GridKind::Material) && options.rule != VoxelRule::Centre)
    throw Error(Status::Usage, "`rule`", "is for density and mask; material knows of no rule",
                "make it without");
}

GridTransform transformOf(const std::vector<TriangleMesh>& meshes, const SolidOptions& solid,
                          const VoxelizeOptions& options) {
  WorldBox box;
  for (const TriangleMesh& mesh : meshes)
    if (!mesh.triangles.empty())
      box.add(boxOf(mesh, solid));
  return chooseTransform(box, options, solid);
}

void requireTreeMemory(const Masks& masks, const VoxelizeOptions& options) {
  double leaves = 0;
  for (const auto& mask : masks)
    leaves += static_cast<double>(mask->constTree().leafCount());
  requireMemory(TreeEstimate{leaves, leaves / 128 + 64}.bytes(options.grids), options);
}

Voxelization materialsOnce(const std::vector<TriangleMesh>& meshes,
                           const std::vector<std::string>& names, const SolidOptions& solid,
                           const VoxelizeOptions& options, Report& report, Progress& progress) {
  StageTimer timer(report, "voxelize");
  Voxelization result;
  result.path = OccupancyPath::Boundary;
  result.transform = transformOf(meshes, solid, options);
  reportTransform(result.transform, options, report);

  VoxelizeOptions each = options;
  each.voxelSize = result.transform.voxelSize;
  each.origin = result.transform.origin;
  each.grids = {GridKind::Mask};
  each.allowEmpty = true;
  Masks masks;
  bool empty = true;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    timer.part(names[i]);
    Report own;
    Voxelization made = voxelize(meshes[i], solid, each, own, progress);
    masks.push_back(openvdb::gridPtrCast<openvdb::BoolGrid>(made.volume.grids().all.front()));
    noteMaterial(names[i], masks.back()->empty(), own, report);
    empty = empty && masks.back()->empty();
    result.counts.boundaryFaces += made.counts.boundaryFaces;
    result.counts.openEdges += made.counts.openEdges;
    result.estimatedBytes = std::max(result.estimatedBytes, made.estimatedBytes);
  }
  requireMaterials(empty, options);

  timer.part("tree");
  requireTreeMemory(masks, options);
  auto grids = std::make_shared<GridSet>();
  grids->all = materialGrids(options.grids, masks, result.transform, progress);
  result.volume = Volume(std::move(grids));
  return result;
}

} // namespace

openvdb::GridPtrVec materialGrids(const std::vector<GridKind>& kinds, const Masks& masks,
                                  const GridTransform& transform, Progress& progress) {
  TetMesh numbered; // the owner i represents a cell of region i + 1
  for (std::size_t i = 0; i < masks.size(); ++i)
    numbered.regions.push_back(static_cast<std::int32_t>(i + 1));
  TreeBuilder builder(kinds, numbered);
  rasterizeMasks(masks, builder, progress);
  return builder.finish(transform);
}

void noteMaterial(const std::string& name, bool empty, const Report& own, Report& report) {
  for (const Warning& warning : own.warnings)
    if (warning.code != "nearly-empty" || !empty)
      report.warn(warning.code, name + ": " + warning.text);
  if (!empty)
    return;
  report.warn("no-voxels", name + ": no voxel centre lies inside: it has no voxels");
  report.partial = true;
}

void requireMaterials(bool empty, const VoxelizeOptions& options) {
  if (empty && !options.allowEmpty)
    throw Error(Status::Invalid, "", "no voxel centre lies inside any of the meshes",
                "use smaller voxels, give sheets a thickness with `shell=T`, or use `allow_empty` "
                "to write empty grids");
}

Voxelization voxelizeMaterials(const std::vector<TriangleMesh>& meshes,
                               const std::vector<std::string>& names, const SolidOptions& solid,
                               const VoxelizeOptions& options, Report& report, Progress& progress) {
  progress.stage("voxelize");
  check(meshes, names, options);
  initializeOpenVDB();
  return keepResolution(options, report, [&](const VoxelizeOptions& used, Report& told) {
    return materialsOnce(meshes, names, solid, used, told, progress);
  });
}

} // namespace tetvdb
