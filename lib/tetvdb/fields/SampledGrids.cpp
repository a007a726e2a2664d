// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/SampledGrids.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/voxelize/TreeBuilder.h"

#include <fmt/format.h>

namespace tetvdb {
namespace {

// A packed leaf consists of a mask, its position, and a buffered tail.
constexpr double kPackedLeafBytes = 240;

} // namespace

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

void refuseNoVoxels() {
  throw Error(Status::Invalid, "", "no voxel centre lies inside the mesh",
              "use smaller voxels, or `allow_empty` to write an empty grid");
}

FieldBytes fieldBytes(const std::vector<Field>& fields, const PackOptions* pack) {
  FieldBytes bytes;
  for (const Field& field : fields) {
    bytes.leaf += pack != nullptr ? kPackedLeafBytes : static_cast<double>(leafBytes(field.kind));
    bytes.lowerNode += static_cast<double>(kLowerNodeBytes);
  }
  return bytes;
}

SampledGrids::SampledGrids(const TetMesh& mesh, const SnappedMesh& snapped,
                           const GridTransform& transform, const std::vector<Field>& fields,
                           const PackOptions* pack,
                           std::vector<std::unique_ptr<PackedGrid>>& packed)
    : fields_(fields) {
  if (pack != nullptr) {
    const auto store = std::make_shared<TailStore>(pack->folder, pack->inMemory);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      packed.push_back(std::make_unique<PackedGrid>());
      packed.back()->store = store;
    }
  }
  grids_ = std::make_unique<FieldGrids>(mesh, snapped, transform, fields,
                                        pack != nullptr && pack->half, packed);
}

void SampledGrids::requireAny(const SampleOptions& options) const {
  if (!grids_->any() && !options.allowEmpty)
    refuseNoVoxels();
}

void SampledCounts::warn(const std::vector<Field>& fields, Report& report) const {
  for (std::size_t i = 0; i < leftOut.size(); ++i)
    if (leftOut[i] > 0)
      report.warn("voxels-left-out",
                  fmt::format("{} voxels of '{}' have no finite value and are left out", leftOut[i],
                              fields[i].name));
  if (byTets > 0)
    report.warn("values-by-tets",
                fmt::format("{} voxels lie in hexahedra, wedges or pyramids that are "
                            "inverted or twisted; their values are interpolated in tetrahedra",
                            byTets));
}

openvdb::GridPtrVec SampledGrids::finish(const GridTransform& transform, SampledCounts& counts) {
  openvdb::GridPtrVec made = grids_->finish(transform);
  counts.leftOut.resize(made.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    describeValues(fields_[i], *made[i]);
    counts.leftOut[i] += grids_->leftOut(i);
  }
  counts.byTets += grids_->byTets();
  return made;
}

openvdb::GridPtrVec SampledGrids::finish(const GridTransform& transform, Report& report) {
  SampledCounts counts;
  openvdb::GridPtrVec made = finish(transform, counts);
  counts.warn(fields_, report);
  return made;
}

} // namespace tetvdb
