// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

namespace tetvdb {

/// The position of the model; by default the centre of its box at the centre of the display, its
/// lowest point on the plate.
struct PlaceOptions {
  bool keep = false; ///< coordinates are those of the plate, in millimetres, from its corner
  std::optional<std::array<double, 2>> centre; ///< of the box, millimetres on the plate
  double scale = 1;                            ///< millimetres per unit of the model
};

} // namespace tetvdb
