// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tetvdb {

/// A length as given by users: in the input's units, or relative to a length that is known only
/// after reading the input.
struct RelativeLength {
  enum class Unit : std::uint8_t {
    World,    ///< the input's own
    Diagonal, ///< of the box of all inputs, cleaned
    Voxel     ///< a voxel's shortest side
  };
  double value = 0; ///< 0: not given
  Unit unit = Unit::World;

  double inWorld(double diagonal, double voxel) const {
    return value * (unit == Unit::Diagonal ? diagonal : unit == Unit::Voxel ? voxel : 1.0);
  }
};

} // namespace tetvdb
