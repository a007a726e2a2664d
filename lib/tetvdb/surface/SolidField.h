// SPDX-License-Identifier: Apache-2.0
//
// Whether winding numbers at sample points are those of a solid: whole numbers, none negative.
#pragma once

#include "tetvdb/surface/GroupWinding.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// How far a winding number is from the nearest of 0, 1, 2, ...; 1 at most.
float distanceFromSolid(float winding);

/// Winding numbers of a whole mesh, one a sample.
struct SolidField {
  std::vector<float> values;

  /// The mean of distanceFromSolid().
  double error() const;
  /// Near whole numbers and nowhere negative.
  bool isSolid() const;
  /// Of the first `count` samples the share that is inside.
  double shareInside(std::size_t count) const;
  /// Of the first `count` samples that are inside with confidence (near 1, 2, ...) the share that
  /// is outside in `other`.
  double shareLostIn(const SolidField& other, std::size_t count) const;
  /// Of the first `count` samples that are inside here or in `other` the share that is not in both.
  double differenceFrom(const SolidField& other, std::size_t count) const;
  /// Of all samples that are inside the share that is outside in `other`.
  double shareInsideLostIn(const SolidField& other) const;
};

/// The sum over all groups.
SolidField sumOf(const GroupWinding& groups, std::uint32_t groupCount);

/// Groups that surround nothing and stand within the solid that the others make: on both sides of
/// them is inside without them, nothing that is inside is lost without them, and the field gets
/// nearer to a solid's. These are taken off `field`. Returns 1 by group.
std::vector<std::uint8_t> innerGroups(const GroupWinding& groups, std::uint32_t groupCount,
                                      SolidField& field);

/// Turns sets of groups, one after the other and over again, where the field gets nearer to a
/// solid's by it, and by a good part of what they add to it. `field`: of all groups, in and out.
/// Returns which groups are turned, 1 by group.
std::vector<std::uint8_t> turnTowardsSolid(const GroupWinding& groups, std::uint32_t groupCount,
                                           const std::vector<std::vector<std::uint32_t>>& sets,
                                           SolidField& field, Progress& progress);

} // namespace tetvdb
