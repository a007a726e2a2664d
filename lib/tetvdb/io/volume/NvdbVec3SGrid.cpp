// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/NvdbConvert.h"

namespace tetvdb {

NanoHandle toNano(const openvdb::Vec3SGrid& grid) {
  return buildNano(grid);
}

} // namespace tetvdb
