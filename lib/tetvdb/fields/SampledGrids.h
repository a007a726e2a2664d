// SPDX-License-Identifier: Apache-2.0
//
// The grids of a sampling, wherever values are found: what is made of FieldGrids in the end.
// Internal.
#pragma once

#include "tetvdb/fields/FieldGrids.h"
#include "tetvdb/fields/SampleFields.h"

#include <memory>
#include <vector>

namespace tetvdb {

/// Of fields, as they are kept while leaves are made: of a leaf, and of a lower node.
struct FieldBytes {
  double leaf = 0, lowerNode = 0;
};
/// `pack`: null where values stay in memory.
FieldBytes fieldBytes(const std::vector<Field>& fields, const PackOptions* pack);

class SampledGrids {
public:
  /// `pack`, `packed`: null and unused, or where the grids go.
  SampledGrids(const TetMesh& mesh, const SnappedMesh& snapped, const GridTransform& transform,
               const std::vector<Field>& fields, const PackOptions* pack,
               std::vector<std::unique_ptr<PackedGrid>>& packed);

  FieldGrids& grids() { return *grids_; }

  /// Throws Error(Invalid) where no voxel has an owner, unless that is allowed.
  void requireAny(const SampleOptions& options) const;

  /// The grids with their metadata; warns of values that were left out.
  openvdb::GridPtrVec finish(const GridTransform& transform, Report& report);

private:
  const std::vector<Field>& fields_;
  std::unique_ptr<FieldGrids> grids_;
};

} // namespace tetvdb
