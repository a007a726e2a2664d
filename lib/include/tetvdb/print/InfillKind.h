// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace tetvdb {

/// Cubic lattices with a corner of a cell at 0.
enum class InfillKind : std::uint8_t {
  Gyroid,   ///< a sheet along the gyroid
  SchwarzP, ///< a sheet along Schwarz' primitive surface
  Diamond,  ///< a sheet along Schwarz' diamond surface
  Bcc,      ///< struts from the midpoint of each cell to its corners
  Octet     ///< struts along the diagonals of the cells' sides, and between these sides' midpoints
};

/// "gyroid", "schwarz-p", "diamond", "bcc", "octet".
const char* nameOf(InfillKind kind);
/// Returns false, and changes nothing, for any other text.
bool readInfill(const std::string& name, InfillKind& kind);

/// The thickness of a lattice: a number, or a function of an array of the input.
struct InfillAmount {
  bool isDensity = false; ///< the filled share of a cell, 0 to 1; else a thickness
  std::string array;      ///< empty: `low` everywhere
  /// Values at the array's minimum and maximum, linear between.
  double low = 0, high = 0;
};

struct InfillSettings {
  InfillKind kind = InfillKind::Gyroid;
  double cell = 0; ///< side of a cell, world units
  InfillAmount amount;
};

} // namespace tetvdb
