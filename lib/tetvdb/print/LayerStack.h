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

/// A writer into `pixels`, which it makes as large as all layers of the frame: the value of pixel
/// (x, y) of layer k is at [(k * height + y) * width + x], and 0 where a layer has none. `pixels`
/// must outlive it, and is complete once finish() has returned. Throws Error(Limit) where that does
/// not fit into `maxMemory` bytes for the whole process (0: what the machine has available).
std::unique_ptr<LayerWriter> layerStack(const LayerFrame& frame, std::size_t maxMemory,
                                        std::vector<std::uint8_t>& pixels);

} // namespace tetvdb
