// SPDX-License-Identifier: Apache-2.0
//
// The values of a level set from squared distances. The same source, with the same bits, is used on
// the CPU and on a GPU.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/core/Multiversion.h"

#include <cmath>
#include <limits>

namespace tetvdb {

/// The permitted half-widths, voxels. With 1 or more, the voxels on either side of the surface are
/// always in the band, so that the level set is closed.
constexpr double kMinHalfWidth = 1, kMaxHalfWidth = 100;

struct NarrowBand {
  float radius;     ///< half-width, voxels: a voxel is active if it is closer to the surface
  float shell;      ///< distance of the surface from the faces, voxels
  float voxel;      ///< side of a voxel, world units
  float background; ///< absolute value of inactive voxels, world units

  NarrowBand() = default;
  NarrowBand(double halfWidth, double shellOf, double voxelSize)
      : radius(static_cast<float>(halfWidth)), shell(static_cast<float>(shellOf)),
        voxel(static_cast<float>(voxelSize)), background(backgroundOf(halfWidth, voxelSize)) {}

  /// Voxels from the surface, from the squared distance to the faces.
  TETVDB_HD TETVDB_INLINE float distance(float squared) const {
    return std::abs(std::sqrt(squared) - shell);
  }
  TETVDB_HD TETVDB_INLINE bool isActive(float distance) const { return distance < radius; }
  /// World units. Never 0, which would be neither inside nor outside.
  TETVDB_HD TETVDB_INLINE float absolute(float distance) const {
    const float least = std::numeric_limits<float>::min(), world = distance * voxel;
    const float value = world < least ? least : world;
    return distance < radius && value < background ? value : background;
  }

private:
  // The next larger float if single precision rounds the product down: OpenVDB's checks divide it
  // by the voxel size.
  static float backgroundOf(double halfWidth, double voxelSize) {
    const auto nearest = static_cast<float>(halfWidth * voxelSize);
    return static_cast<double>(nearest) / voxelSize < halfWidth
               ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
               : nearest;
  }
};

/// The fog of a level set's value: 0 outside, rising inside to 1 at the depth, negative, whose
/// inverse `weight` is. Never 0 inside.
TETVDB_HD TETVDB_INLINE float fogOf(float value, float weight) {
  const float least = std::numeric_limits<float>::min(), fog = value * weight;
  return value > 0 ? 0 : fog < least ? least : fog;
}

} // namespace tetvdb
