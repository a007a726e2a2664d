// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/NvdbConvert.h"

namespace tetvdb {

NanoHandle toNano(const openvdb::FloatGrid& grid) {
  return buildNano(grid);
}

} // namespace tetvdb
