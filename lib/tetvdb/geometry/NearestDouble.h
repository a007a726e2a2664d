// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/geometry/Exact.h"

#include <cstdint>

namespace tetvdb {

/// The double nearest to v, of two equally near the even one: static_cast<double>(v), written out
/// so that it does not rest on each compiler's own routine.
TETVDB_HD inline double nearestDouble(Int128 v) {
  __extension__ typedef unsigned __int128 Magnitude;
  Magnitude rest = v < 0 ? -static_cast<Magnitude>(v) : static_cast<Magnitude>(v);
  double power = 1;
  bool cut = false; // whether a bit that was shifted out was set
  while (rest >> 64 != 0) {
    cut = cut || (rest & 1) != 0;
    rest >>= 1;
    power *= 2;
  }
  // Of 64 bits the last is so far below the double's that what was cut decides ties alone.
  const double size =
      static_cast<double>(static_cast<std::uint64_t>(rest) | (cut ? 1u : 0u)) * power;
  return v < 0 ? -size : size;
}

} // namespace tetvdb
