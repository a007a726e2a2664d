// SPDX-License-Identifier: Apache-2.0
//
// The range of values that renderers show.
#pragma once

#include "tetvdb/volume/Volume.h"

#include <string>

namespace tetvdb {

/// Blender's Cycles omits smaller densities (volume.render.clipping, its default).
constexpr double kMinShown = 0.001;
/// Larger densities are opaque in scenes of usual size.
constexpr double kMaxShown = 1000;
/// Largest number of 16 bits.
constexpr double kLargestHalf = 65504;

/// The warning's code.
constexpr const char* kHiddenValues = "hidden-values";

/// The reason why a renderer does not show the values of a scalar grid: "ranges from -1 to 2:
/// renderers treat negative densities as empty". Empty if it does, or if the grid is empty.
std::string whyHidden(const GridInfo& grid);

} // namespace tetvdb
