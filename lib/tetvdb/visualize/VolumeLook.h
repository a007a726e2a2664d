// SPDX-License-Identifier: Apache-2.0
//
// Grids as drawables: as voxels, as a smooth surface, as slices, as fog.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/visualize/CutPlane.h"
#include "tetvdb/visualize/Drawable.h"

#include <functional>
#include <memory>
#include <openvdb/openvdb.h>
#include <optional>

namespace tetvdb {

/// Colours by a grid's values.
struct GridPaint {
  openvdb::GridBase::ConstPtr grid;   ///< null: `plain` everywhere; vectors count by their length
  std::function<Rgb(double)> colorOf; ///< of a value; needed with a grid; thread-safe
  Rgb plain{0.8f, 0.8f, 0.8f};
};

struct VolumeLook {
  GridPaint paint;
  std::optional<CutPlane> cut;
};

/// Every active voxel as a box, found by traversing the tree, without a mesh or a dense copy; edges
/// are drawn where voxels are larger than pixels. Memory: that of an ActiveTree. The grid must stay
/// as it is. Error(Usage) for a type that is unknown, Error(Invalid) for a frustum.
std::unique_ptr<Drawable> drawVoxels(openvdb::GridBase::ConstPtr grid, const VolumeLook& look);

/// A smooth surface: of a level set where it is zero, between voxels; of fogs named "density" or
/// "coverage" where their values, smoothed over three voxels, are a half; of others the same of
/// their active states. Voxels smaller than a pixel are the surface themselves, and normals are
/// taken over pixels, so that pictures do not alias. Errors and memory as above.
std::unique_ptr<Drawable> drawSurface(openvdb::GridBase::ConstPtr grid, const VolumeLook& look);

/// The values of the paint's grid (the drawn one's where it has none) on the plane axis = position
/// (world units) where voxels are active: every voxel in its colour, without light. Index axes, so
/// transforms that rotate are Error(Invalid).
std::unique_ptr<Drawable> drawSlice(openvdb::GridBase::ConstPtr grid, int axis, double position,
                                    const VolumeLook& look);

struct FogLook {
  GridPaint paint;
  std::optional<CutPlane> cut;
  Vec3d toLight{0, 0, 1}; ///< of length 1
  float light = 0.8f;     ///< that reaches the fog's outside from there
  float ambient = 0.35f;  ///< from all directions
  /// Optical depth, at value 1, across the longest side of the active voxels' box.
  double depth = 12;
};

/// Fog of the grid's values (negative ones are nothing): light scattered once, shadows from a
/// coarse field of 64 cells along the longest side. Cost: that field once, in parallel; 2 MB.
std::unique_ptr<Medium> drawFog(openvdb::GridBase::ConstPtr grid, const FogLook& look,
                                Progress& progress);

} // namespace tetvdb
