// SPDX-License-Identifier: Apache-2.0
//
// A GridPaint ready for use. Internal.
#pragma once

#include "tetvdb/visualize/GridSpace.h"
#include "tetvdb/visualize/GridValues.h"
#include "tetvdb/visualize/VolumeLook.h"

namespace tetvdb {

class VolumePaint {
public:
  explicit VolumePaint(const GridPaint& paint);
  /// The colour of the voxel around a point; of one that is not active, of the nearest of the
  /// voxels around it that are.
  Rgb at(const Vec3d& world) const;
  /// The colour of a value.
  Rgb of(double value) const { return paint_.colorOf(value); }

private:
  GridPaint paint_;
  std::unique_ptr<GridValues> values_;
  std::optional<GridSpace> space_;
};

} // namespace tetvdb
