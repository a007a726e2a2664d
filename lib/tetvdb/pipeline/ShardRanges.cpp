// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/ShardRanges.h"

#include "tetvdb/volume/VoxelBounds.h"

#include <algorithm>

namespace tetvdb {

std::vector<CubeRange> shardRanges(const std::vector<std::uint64_t>& weights, std::size_t count) {
  double total = 0;
  for (const std::uint64_t weight : weights)
    total += static_cast<double>(weight);
  std::vector<CubeRange> ranges(count);
  double before = 0;
  std::size_t share = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double middle = before + static_cast<double>(weights[i]) / 2;
    before += static_cast<double>(weights[i]);
    const auto wanted =
        std::min(static_cast<std::size_t>(middle / total * static_cast<double>(count)), count - 1);
    while (share < wanted)
      ranges[++share] = {i, i};
    ranges[share].end = i + 1;
  }
  while (++share < count)
    ranges[share] = {weights.size(), weights.size()};
  return ranges;
}

std::vector<ShardPlan> planShards(const std::vector<RootCube>& cubes,
                                  const std::vector<std::uint64_t>& weights, std::size_t count) {
  double total = 0;
  for (const std::uint64_t weight : weights)
    total += static_cast<double>(weight);
  std::vector<ShardPlan> plan;
  for (const CubeRange& range : shardRanges(weights, count)) {
    ShardPlan& one = plan.emplace_back();
    VoxelBounds box;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      ++one.rootChildren;
      one.fullRootChildren += cubes[i].full ? 1 : 0;
      one.share += static_cast<double>(weights[i]) / total;
      box.add(cubes[i].origin, 4096);
    }
    if (one.rootChildren > 0) {
      one.boxMin = box.min;
      one.boxMax = box.max;
    }
  }
  return plan;
}

} // namespace tetvdb
