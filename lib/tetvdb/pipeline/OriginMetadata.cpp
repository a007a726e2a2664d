// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/OriginMetadata.h"

#include "tetvdb/core/Version.h"

#include <filesystem>
#include <memory>
#include <vector>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

std::string fileNames(const std::vector<std::string>& paths) {
  std::string names;
  for (const std::string& path : paths) {
    if (!names.empty())
      names += ", ";
    names += fs::path(path).filename().string();
  }
  return names;
}

} // namespace

std::map<std::string, std::string> originMetadata(const VoxelizeJob& job) {
  std::map<std::string, std::string> metadata = job.metadata;
  metadata["creator"] = std::string("TetVDB ") + version();
  metadata["source"] = fileNames(job.inputs);
  if (!job.units.empty())
    metadata["units"] = job.units;
  if (job.up == UpAxis::Y)
    metadata["up_axis"] = "y";
  return metadata;
}

void setHalf(const VoxelizeJob& job, const openvdb::GridPtrVec& grids) {
  if (!job.half)
    return;
  for (const auto& grid : grids)
    if (grid->isType<openvdb::FloatGrid>() || grid->isType<openvdb::Vec3SGrid>())
      grid->setSaveFloatAsHalf(true);
}

void setMaskType(const VoxelizeJob& job, openvdb::GridPtrVec& grids) {
  if (job.maskType != MaskType::Mask)
    return;
  for (openvdb::GridBase::Ptr& grid : grids) {
    if (!grid->isType<openvdb::BoolGrid>())
      continue;
    const auto& tree = static_cast<const openvdb::BoolGrid&>(*grid).constTree();
    const auto mask = openvdb::MaskGrid::create(
        std::make_shared<openvdb::MaskTree>(tree, false, true, openvdb::TopologyCopy()));
    mask->insertMeta(*grid);
    mask->setTransform(grid->transformPtr());
    grid = mask;
  }
}

} // namespace tetvdb
