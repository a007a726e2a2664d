// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace tetvdb {

/// Lattices of cubes with a corner of one at 0.
enum class InfillKind : std::uint8_t {
  Gyroid,   ///< a sheet along the gyroid
  SchwarzP, ///< a sheet along Schwarz' primitive surface
  Diamond,  ///< a sheet along Schwarz' diamond surface
  Bcc,      ///< struts from the midpoint of each cell to its corners
  Octet     ///< struts along the diagonals of the cells' sides, and between these sides' midpoints
};

/// "gyroid", "schwarz-p", "diamond", "bcc", "octet".
const char* nameOf(InfillKind kind);
/// False, and nothing changed, for any other text.
bool readInfill(const std::string& name, InfillKind& kind);

/// How thick a lattice is: a number, or one that an array of the input says.
struct InfillAmount {
  bool isDensity = false; ///< the share of a cell that is filled, 0 to 1; else a thickness
  std::string array;      ///< empty: `low` everywhere
  /// Where the array is at its minimum and at its maximum, linear between.
  double low = 0, high = 0;
};

struct InfillSettings {
  InfillKind kind = InfillKind::Gyroid;
  double cell = 0; ///< along a cell, world units
  InfillAmount amount;
};

} // namespace tetvdb
