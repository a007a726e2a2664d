// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/geometry/Exact.h"

#include <cstdint>

namespace tetvdb {

/// The double nearest to v, with ties to even: static_cast<double>(v), written explicitly so that
/// it does not depend on the compiler's routine.
TETVDB_HD inline double nearestDouble(Int128 v) {
  __extension__ typedef unsigned __int128 Magnitude;
  Magnitude rest = v < 0 ? -static_cast<Magnitude>(v) : static_cast<Magnitude>(v);
  double power = 1;
  bool cut = false; // whether a bit shifted out was set
  while (rest >> 64 != 0) {
    cut = cut || (rest & 1) != 0;
    rest >>= 1;
    power *= 2;
  }
  // The last of 64 bits is so far below the double's precision that `cut` decides only ties.
  const double size =
      static_cast<double>(static_cast<std::uint64_t>(rest) | (cut ? 1u : 0u)) * power;
  return v < 0 ? -size : size;
}

} // namespace tetvdb
