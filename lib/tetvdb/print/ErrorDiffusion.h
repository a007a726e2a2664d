// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/print/Layer.h"

#include <cstdint>

namespace tetvdb {

/// Rounds the grey levels 1 to 254 of a layer to `levels` evenly spaced ones (2 to 255). The
/// rounding error of each pixel is distributed to the grey pixels right, below left, below and
/// below right of it by 7, 3, 5 and 1 sixteenths (Floyd and Steinberg, "An adaptive algorithm for
/// spatial greyscale", 1976), with rows in alternating directions. The parts of black and white
/// pixels, which do not change, are passed to the next grey pixel in that order: the layer's sum is
/// preserved up to about one step between levels, the error of the last grey pixel. Deterministic.
/// Cost: about 20 ns per grey pixel, and 12 bytes per column.
void diffuseErrors(Layer& layer, std::int32_t width, int levels);

} // namespace tetvdb
