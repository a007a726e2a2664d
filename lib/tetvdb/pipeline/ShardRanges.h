// SPDX-License-Identifier: Apache-2.0
//
// How the cubes of a grid are shared out.
#pragma once

#include "tetvdb/pipeline/VoxelizeJob.h"
#include "tetvdb/volume/BitSource.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tetvdb {

/// Cubes begin <= i < end.
struct CubeRange {
  std::size_t begin = 0, end = 0;
};

/// `count` ranges in order that are as equal in weight as whole cubes allow: each cube belongs to
/// the share that the middle of its weight falls into. Some may be empty.
std::vector<CubeRange> shardRanges(const std::vector<std::uint64_t>& weights, std::size_t count);

/// What each of `count` shards would have to do.
std::vector<ShardPlan> planShards(const std::vector<RootCube>& cubes,
                                  const std::vector<std::uint64_t>& weights, std::size_t count);

} // namespace tetvdb
