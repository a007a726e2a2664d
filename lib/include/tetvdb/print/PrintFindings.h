// SPDX-License-Identifier: Apache-2.0
//
// The limits and the findings of checks of a print's layers.
#pragma once

#include "tetvdb/print/PixelBox.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

enum class PrintFault : std::uint8_t {
  Outside,    ///< the model exceeds the printer; found by the caller
  EmptyLayer, ///< layers without solid below layers with solid
  Island,     ///< solid that begins with nothing below it (IslandSweep.h)
  Overhang,   ///< solid that extends farther than the angle allows
  Cup,        ///< void that is closed below and at its sides while it is printed (CavitySweep.h)
  Trap,       ///< void enclosed by solid
  Drain,      ///< void reached only through openings narrower than the limit (DrainPockets.h)
  ThinWall,   ///< solid thinner than the limit within layers (NearPixels.h)
  ThinGap,    ///< void thinner than the limit within layers
  ThinFloor   ///< solid thinner than a wall may be, vertically (FloorSweep.h)
};
constexpr std::size_t kPrintFaults = 10;

struct PrintFinding {
  PrintFault fault = PrintFault::Island;
  std::int32_t first = 0, last = 0; ///< layers that contain a part of it
  std::int32_t layer = 0;           ///< of the position: the first (Island), else the largest
  std::array<double, 2> pixel{};    ///< the position: the centre of one of its pixels
  PixelBox box;                     ///< of all its layers
  std::int64_t pixels = 0;          ///< in `layer`
  double area = 0;                  ///< mm², in `layer`
  double totalArea = 0;             ///< mm²: Overhang, of all layers
  double largestArea = 0;           ///< mm²: Island, the largest size in one layer before it joins
  double volume = 0;                ///< mm³: Cup, Trap; Drain: reached by centres of balls
  double width = 0;                 ///< mm: ThinWall and ThinGap, the maximum
  double height = 0;                ///< mm, of layers first to last
  /// Island: the layer in which it joins a component that stands on the plate; Cup: that in which
  /// it opens to the side; -1: none.
  std::int32_t joins = -1;
  bool onPlate = false; ///< Cup: closed by the plate below, and above by solid
};

/// The limits of the checks. Lengths in millimetres; 0 disables a check.
struct PrintLimits {
  Neighbours neighbours = Neighbours::Eight; ///< of the solid in a layer; the void has the others
  bool emptyLayers = true, islands = true, cups = true, traps = true;
  double overhangAngle = 0; ///< degrees from the vertical, below 90
  double minWall = 0, minGap = 0, minFloor = 0, drain = 0;
  /// Findings are omitted, and counted, if their whole area in one layer is below `minArea`
  /// (Island: its largest size; Overhang: that of all layers), or their volume is below `minVolume`
  /// (Cup, Trap). Walls and gaps are also omitted if they are lower than their width limit.
  double minArea = 0, minVolume = 0;
};

struct PrintChecks {
  /// By fault, the largest first (area; volume; for islands the largest size), then from
  /// below.
  std::vector<PrintFinding> findings;
  std::array<std::size_t, kPrintFaults> leftOut{}; ///< by fault: findings omitted for their size
  double volume = 0;                               ///< mm³ of white pixels
  std::int32_t emptyLayers = 0;                    ///< number in all layers
};

} // namespace tetvdb
