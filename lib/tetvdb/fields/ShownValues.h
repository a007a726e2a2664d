// SPDX-License-Identifier: Apache-2.0
//
// Which values renderers show as they stand.
#pragma once

#include "tetvdb/volume/Volume.h"

#include <string>

namespace tetvdb {

/// Blender's Cycles takes what is below for nothing (volume.render.clipping, its default).
constexpr double kMinShown = 0.001;
/// Densities above are a solid block in any scene of ordinary size.
constexpr double kMaxShown = 1000;
/// Largest number that 16 bits hold.
constexpr double kLargestHalf = 65504;

/// The warning's code.
constexpr const char* kHiddenValues = "hidden-values";

/// Why a renderer would not show the values of a grid of single numbers as they are: "has negative
/// values, which renderers take for nothing". Empty where it would, or where the grid holds none.
std::string whyHidden(const GridInfo& grid);

} // namespace tetvdb
