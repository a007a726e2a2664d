// SPDX-License-Identifier: Apache-2.0
//
// The grids of a sampling, for values computed on any device: finishes FieldGrids.
// Internal.
#pragma once

#include "tetvdb/fields/FieldGrids.h"
#include "tetvdb/fields/SampleFields.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace tetvdb {

/// Memory per leaf and per lower node of fields while leaves are made.
struct FieldBytes {
  double leaf = 0, lowerNode = 0;
};
/// `pack`: null if values are kept in memory.
FieldBytes fieldBytes(const std::vector<Field>& fields, const PackOptions* pack);

/// Of voxels whose values are not what they would be.
struct SampledCounts {
  std::vector<std::size_t> leftOut; ///< of each field: values that are not finite
  std::size_t byTets = 0;           ///< interpolated in tets instead of cells

  void warn(const std::vector<Field>& fields, Report& report) const;
};

/// Adds to a grid's metadata where its values come from.
void describeValues(const Field& field, openvdb::GridBase& grid);

/// Throws Error(Invalid) for a mesh that no voxel's centre lies in.
[[noreturn]] void refuseNoVoxels();

class SampledGrids {
public:
  /// `pack`, `packed`: both null, or the destination of the grids.
  SampledGrids(const TetMesh& mesh, const SnappedMesh& snapped, const GridTransform& transform,
               const std::vector<Field>& fields, const PackOptions* pack,
               std::vector<std::unique_ptr<PackedGrid>>& packed);

  FieldGrids& grids() { return *grids_; }

  /// Throws Error(Invalid) if no voxel has an owner, unless this is permitted.
  void requireAny(const SampleOptions& options) const;

  /// Returns the grids with their metadata; adds to `counts`.
  openvdb::GridPtrVec finish(const GridTransform& transform, SampledCounts& counts);
  /// The same; warns.
  openvdb::GridPtrVec finish(const GridTransform& transform, Report& report);

private:
  const std::vector<Field>& fields_;
  std::unique_ptr<FieldGrids> grids_;
};

} // namespace tetvdb
