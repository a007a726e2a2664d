// SPDX-License-Identifier: Apache-2.0
//
// Layers as one array in memory.
#pragma once

#include "tetvdb/print/LayerFile.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace tetvdb {

/// A writer into `pixels`, which it resizes to all layers of the frame: the value of pixel (x, y)
/// of layer k is at [(k * height + y) * width + x], and 0 without a run. `pixels` must outlive it,
/// and is complete after finish(). Throws Error(Limit) if it does not fit into `maxMemory` bytes
/// for the whole process (0: the available memory).
std::unique_ptr<LayerWriter> layerStack(const LayerFrame& frame, std::size_t maxMemory,
                                        std::vector<std::uint8_t>& pixels);

} // namespace tetvdb
