// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

namespace tetvdb {

/// Where the model goes; by default the middle of its box to the middle of the display, its lowest
/// point onto the plate.
struct PlaceOptions {
  bool keep = false; ///< coordinates are those of the plate, in millimetres, from its corner
  std::optional<std::array<double, 2>> centre; ///< of the box, millimetres on the plate
  double scale = 1;                            ///< millimetres in a unit of the model
};

} // namespace tetvdb
