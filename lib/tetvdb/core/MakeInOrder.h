// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <utility>
#include <vector>

namespace tetvdb {

/// Makes blocks in parallel, a window at a time, and takes them in order: `next(piece)` sets the
/// next block to make, or returns false at the end; `make(piece)` returns its result;
/// `take(result)` uses it. `window`: blocks at a time; 0: four a thread.
template <class Piece, class Result, class Next, class Make, class Take>
void makeInOrder(const Next& next, const Make& make, const Take& take, std::size_t window = 0) {
  if (window == 0)
    window = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()) * 4;
  // oneTBB passes numbers of blocks: where one of the three throws it does not destroy what it
  // passes. The block before the last `window` is taken before another begins.
  struct Block {
    Piece piece;
    std::optional<Result> result;
  };
  std::vector<Block> blocks(window);
  std::size_t begun = 0;
  const auto begin = [&](tbb::flow_control& flow) {
    const std::size_t block = begun++ % window;
    blocks[block].piece = Piece{};
    if (!next(blocks[block].piece))
      flow.stop();
    return block;
  };
  const auto finish = [&](std::size_t block) {
    const Piece piece = std::move(blocks[block].piece);
    blocks[block].result.emplace(make(piece));
    return block;
  };
  const auto end = [&](std::size_t block) {
    take(*blocks[block].result);
    blocks[block].result.reset();
  };
  using tbb::filter_mode;
  tbb::parallel_pipeline(
      window, tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, begin) &
                  tbb::make_filter<std::size_t, std::size_t>(filter_mode::parallel, finish) &
                  tbb::make_filter<std::size_t, void>(filter_mode::serial_in_order, end));
}

} // namespace tetvdb
