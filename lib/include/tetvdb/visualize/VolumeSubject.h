// SPDX-License-Identifier: Apache-2.0
//
// Volumes as subjects of pictures.
#pragma once

#include "tetvdb/visualize/Subject.h"
#include "tetvdb/volume/Volume.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace tetvdb {

enum class VolumeStyle : std::uint8_t {
  /// Surface for level sets; for others voxels where there are at most 128 along the longest side
  /// of their box, else surface.
  Auto,
  Voxels,
  Surface,
  Fog,
  Slice
};

/// A plane across a volume: axis = position.
struct SlicePlane {
  int axis = 2;
  double at = 0.5;
  bool inUnits = false; ///< `at` is a coordinate; false: a share of the box, 0 to 1
};

struct VolumeShow {
  VolumeStyle style = VolumeStyle::Auto;
  /// The grid whose shape is drawn; empty: the first of surface, density, coverage, mask, else the
  /// file's first.
  std::string grid;
  /// The grid that gives the colours; empty: none, but for arrays (grids of other names than those
  /// above) and slices, which have the colours of their own values where these differ. Of a grid
  /// "material" of whole numbers every number is a category with a colour of its own.
  std::string color;
  bool plainColor = false; ///< `plain`, whatever the grid
  SlicePlane slice;        ///< of style Slice
  Rgb plain{0.60F, 0.62F, 0.65F};
};

/// Throws Error(Usage) for a grid that the volume does not have, naming those that it has, and
/// Error(Invalid) where the grid holds no active voxels. The volume is kept.
std::unique_ptr<Subject> subjectOf(Volume volume, const VolumeShow& show);

} // namespace tetvdb
