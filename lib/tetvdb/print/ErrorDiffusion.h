// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/print/Layer.h"

#include <cstdint>

namespace tetvdb {

/// Rounds the grey levels 1 to 254 of a layer to `levels` evenly spaced ones (2 to 255), each
/// pixel's rounding error passed on to the grey pixels right, below left, below and below right of
/// it by 7, 3, 5 and 1 sixteenths (Floyd and Steinberg, "An adaptive algorithm for spatial
/// greyscale", 1976), rows in turn from the left and from the right. What would go to black and
/// white pixels, which stay as they are, goes to the next grey pixel in that order: the layer's sum
/// stays, but for about a step between levels that the last grey pixel cannot take. Deterministic.
/// Cost: about 20 ns a grey pixel, and 12 bytes a column.
void diffuseErrors(Layer& layer, std::int32_t width, int levels);

} // namespace tetvdb
