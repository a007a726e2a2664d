// SPDX-License-Identifier: Apache-2.0
//
// Tests whether winding numbers at sample points are those of a solid: whole, and none negative.
#pragma once

#include "tetvdb/surface/GroupWinding.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Distance of a winding number from the nearest of 0, 1, 2, ..., at most 1.
float distanceFromSolid(float winding);

/// Winding numbers of a whole mesh, one per sample.
struct SolidField {
  std::vector<float> values;

  /// The mean of distanceFromSolid().
  double error() const;
  /// Whether all are near whole numbers and none is negative.
  bool isSolid() const;
  /// The fraction of the first `count` samples that is inside.
  double shareInside(std::size_t count) const;
  /// Of the first `count` samples that are clearly inside (near 1, 2, ...), the fraction that is
  /// outside in `other`.
  double shareLostIn(const SolidField& other, std::size_t count) const;
  /// Of the first `count` samples that are inside here or in `other`, the fraction not inside both.
  double differenceFrom(const SolidField& other, std::size_t count) const;
  /// Of all samples that are inside, the fraction that is outside in `other`.
  double shareInsideLostIn(const SolidField& other) const;
};

/// The sum over all groups.
SolidField sumOf(const GroupWinding& groups, std::uint32_t groupCount);

/// Finds groups that enclose nothing and lie inside the solid of the other groups: without them,
/// both of their sides are inside, nothing that is inside is lost, and the field is closer to that
/// of a solid. Subtracts these groups from `field`. Returns 1 for each of them, by group.
std::vector<std::uint8_t> innerGroups(const GroupWinding& groups, std::uint32_t groupCount,
                                      SolidField& field);

/// Reverses sets of groups, in several passes, if this brings the field closer to that of a solid
/// by a significant share of their contribution. `field` is the sum over all groups, in and out.
/// Returns 1 for each reversed group, by group.
std::vector<std::uint8_t> turnTowardsSolid(const GroupWinding& groups, std::uint32_t groupCount,
                                           const std::vector<std::vector<std::uint32_t>>& sets,
                                           SolidField& field, Progress& progress);

} // namespace tetvdb
