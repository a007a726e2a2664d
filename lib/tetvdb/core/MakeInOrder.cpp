// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/MakeInOrder.h"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

namespace tetvdb {

void passInOrder(std::size_t window, const std::function<bool(std::size_t)>& next,
                 const std::function<void(std::size_t)>& make,
                 const std::function<void(std::size_t)>& take) {
  std::size_t begun = 0;
  const auto begin = [&](tbb::flow_control& flow) {
    const std::size_t block = begun++ % window;
    if (!next(block))
      flow.stop();
    return block;
  };
  const auto finish = [&](std::size_t block) {
    make(block);
    return block;
  };
  // oneTBB passes numbers of blocks: where one of the three throws it does not destroy what it
  // passes. The block before the last `window` is taken before another begins.
  using tbb::filter_mode;
  tbb::parallel_pipeline(
      window, tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, begin) &
                  tbb::make_filter<std::size_t, std::size_t>(filter_mode::parallel, finish) &
                  tbb::make_filter<std::size_t, void>(filter_mode::serial_in_order, take));
}

std::size_t blocksInOrder() {
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()) * 4;
}

} // namespace tetvdb
