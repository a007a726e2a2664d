// SPDX-License-Identifier: Apache-2.0
//
// From weights of a voxel in its tet to values of point arrays; the same source, and the same bits,
// on the CPU and on a GPU.
#pragma once

#include "tetvdb/core/HostDevice.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// `corners`: the value at the first corner by position, and how much more it is at the others.
TETVDB_HD inline double interpolate(const std::array<double, 4>& corners,
                                    const std::array<double, 3>& w) {
  return corners[0] + (w[0] * corners[1] + w[1] * corners[2] + w[2] * corners[3]);
}

/// The corner by position that has the largest weight, the first of several.
TETVDB_HD inline std::size_t nearestCorner(const std::array<double, 3>& w) {
  std::size_t nearest = 0;
  double most = 1 - (w[0] + w[1] + w[2]);
  for (std::size_t i = 0; i < 3; ++i)
    if (w[i] > most) {
      most = w[i];
      nearest = i + 1;
    }
  return nearest;
}

} // namespace tetvdb
