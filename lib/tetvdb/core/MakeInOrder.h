// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace tetvdb {

/// Numbers of blocks, 0 to `window` - 1 in turn, through three steps: `next(block)` prepares a
/// block, or returns false at the end; `make(block)` runs in parallel; `take(block)` comes in the
/// order of `next`. A block is taken before its number is prepared again. What a step throws leaves
/// here.
void passInOrder(std::size_t window, const std::function<bool(std::size_t)>& next,
                 const std::function<void(std::size_t)>& make,
                 const std::function<void(std::size_t)>& take);

/// Blocks at a time that keep all threads busy: four a thread.
[[nodiscard]] std::size_t blocksInOrder();

/// Makes blocks in parallel, a window at a time, and takes them in order: `next(piece)` sets the
/// next block to make, or returns false at the end; `make(piece)` returns its result;
/// `take(result)` uses it. `window`: blocks at a time; 0: blocksInOrder().
template <class Piece, class Result>
void makeInOrder(const std::function<bool(Piece&)>& next,
                 const std::function<Result(const Piece&)>& make,
                 const std::function<void(Result&)>& take, std::size_t window = 0) {
  struct Block {
    Piece piece;
    std::optional<Result> result;
  };
  std::vector<Block> blocks(window == 0 ? blocksInOrder() : window);
  passInOrder(
      blocks.size(),
      [&](std::size_t block) {
        blocks[block].piece = Piece{};
        return next(blocks[block].piece);
      },
      [&](std::size_t block) {
        const Piece piece = std::move(blocks[block].piece);
        blocks[block].result.emplace(make(piece));
      },
      [&](std::size_t block) {
        take(*blocks[block].result);
        blocks[block].result.reset();
      });
}

} // namespace tetvdb
