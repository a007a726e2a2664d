// SPDX-License-Identifier: Apache-2.0
//
// What is looked for in the layers of a print, and what is found.
#pragma once

#include "tetvdb/print/PixelBox.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

enum class PrintFault : std::uint8_t {
  Outside,    ///< the model reaches beyond the printer; found by the caller
  EmptyLayer, ///< layers without solid below others that have some
  Island,     ///< solid that begins with nothing below it (IslandSweep.h)
  Overhang,   ///< solid that leans out farther than the angle allows
  Cup,        ///< void that is closed below and at its sides while it is printed (CavitySweep.h)
  Trap,       ///< void with solid all around
  Drain,      ///< void that only openings narrower than the limit lead to (DrainPockets.h)
  ThinWall,   ///< solid thinner than the limit within layers (NearPixels.h)
  ThinGap,    ///< void thinner than the limit within layers
  ThinFloor   ///< solid thinner than a wall may be, from below to above (FloorSweep.h)
};
constexpr std::size_t kPrintFaults = 10;

struct PrintFinding {
  PrintFault fault = PrintFault::Island;
  std::int32_t first = 0, last = 0; ///< layers that have a part of it
  std::int32_t layer = 0;           ///< of the place: where it begins (Island), else is largest
  std::array<double, 2> pixel{};    ///< the place: the centre of a pixel of it
  PixelBox box;                     ///< of all its layers
  std::int64_t pixels = 0;          ///< in `layer`
  double area = 0;                  ///< mm², in `layer`
  double totalArea = 0;             ///< mm²: Overhang, of all layers
  double largestArea = 0;           ///< mm²: Island, of what it grows to in one layer
  double volume = 0;                ///< mm³: Cup, Trap; Drain: where centres of balls can be
  double width = 0;                 ///< mm: ThinWall and ThinGap, the widest place
  double height = 0;                ///< mm, of layers first to last
  /// Island: the layer in which it is connected with what stands on the plate; Cup: that in which
  /// it opens to the side; -1: none.
  std::int32_t joins = -1;
  bool onPlate = false; ///< Cup: closed by the plate below, and above by solid
};

/// What is looked for. Lengths in millimetres; 0 leaves a check out.
struct PrintLimits {
  Neighbours neighbours = Neighbours::Eight; ///< of the solid in a layer; the void has the others
  bool emptyLayers = true, islands = true, cups = true, traps = true;
  double overhangAngle = 0; ///< degrees from the vertical, below 90
  double minWall = 0, minGap = 0, minFloor = 0, drain = 0;
  /// Findings are left out, and counted, where all their area in one layer is below `minArea`
  /// (Island: of what it grows to; Overhang: of all layers), or their volume below `minVolume`
  /// (Cup, Trap). Walls and gaps are too where they are less high than they may be wide.
  double minArea = 0, minVolume = 0;
};

struct PrintChecks {
  /// By fault, then from the largest on (area; volume; for islands what they grow to), then from
  /// below.
  std::vector<PrintFinding> findings;
  std::array<std::size_t, kPrintFaults> leftOut{}; ///< by fault, for being small
  double volume = 0;                               ///< mm³ of white pixels
  std::int32_t emptyLayers = 0;                    ///< of all layers
};

} // namespace tetvdb
