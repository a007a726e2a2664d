// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/SoupBoundary.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/LargeVector.h"

#include <algorithm>
#include <atomic>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace tetvdb {

SoupBoundary soupBoundary(const std::vector<std::uint32_t>& triangles, Progress& progress) {
  // Smaller index, larger index, and whether the face runs from the larger to the smaller.
  LargeVector<std::uint64_t> keys(triangles.size());
  std::atomic<bool> tooLarge{false};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.size() / 3, 16384),
                    [&](const auto& range) {
                      for (std::size_t t = range.begin(); t != range.end(); ++t)
                        for (std::size_t i = 0; i < 3; ++i) {
                          const std::uint64_t a = triangles[3 * t + i];
                          const std::uint64_t b = triangles[3 * t + (i + 1) % 3];
                          if ((a | b) >> 31 != 0)
                            tooLarge = true;
                          keys[3 * t + i] = a < b ? a << 32 | b << 1 : b << 32 | a << 1 | 1;
                        }
                    });
  if (tooLarge)
    throw Error(Status::Limit, "", "the mesh has 2^31 points or more", "split it in parts");
  progress.check();
  tbb::parallel_sort(keys.begin(), keys.end());
  progress.check();

  SoupBoundary boundary;
  for (std::size_t i = 0; i < keys.size();) {
    const std::uint64_t edge = keys[i] >> 1;
    std::int32_t sum = 0;
    std::size_t count = 0;
    for (; i < keys.size() && keys[i] >> 1 == edge; ++i, ++count)
      sum += (keys[i] & 1) != 0 ? -1 : 1;
    const auto low = static_cast<std::uint32_t>(edge >> 31);
    const auto high = static_cast<std::uint32_t>(edge & 0x7FFFFFFFu);
    if (low == high)
      continue; // of a face with a repeated point
    if (sum > 0)
      boundary.edges.push_back({low, high, sum});
    else if (sum < 0)
      boundary.edges.push_back({high, low, -sum});
    boundary.oddEdges += count % 2;
  }
  return boundary;
}

} // namespace tetvdb
