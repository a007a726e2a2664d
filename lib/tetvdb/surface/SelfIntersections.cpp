// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SelfIntersections.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/FaceContact.h"

#include <algorithm>
#include <functional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace tetvdb {
namespace {

// Faces looked at between two looks at the limit; the rounds double.
constexpr std::size_t kFirstRound = 1 << 10;
constexpr std::size_t kLargestRound = 1 << 16;
constexpr std::size_t kFacesPerTask = 1 << 8;

} // namespace

SelfIntersections countIntersections(const std::vector<Vec3d>& points,
                                     const std::vector<std::uint32_t>& corners, std::size_t limit,
                                     Progress& progress) {
  const std::size_t faces = corners.size() / 3;
  std::vector<Box> boxes(faces);
  for (std::size_t face = 0; face < faces; ++face)
    for (std::size_t k = 0; k < 3; ++k)
      boxes[face].add(points[corners[3 * face + k]]);
  const BoxTree tree(std::move(boxes));

  // Pairs of one face with later ones; no more are counted than would pass the limit.
  const auto pairsOf = [&](std::uint32_t face) {
    std::size_t pairs = 0;
    tree.visit([&](const Box& box) { return box.meets(tree.box(face)); },
               [&](std::uint32_t other) {
                 pairs += other > face && facesMeet(points, &corners[3 * std::size_t(face)],
                                                    &corners[3 * std::size_t(other)]);
                 return pairs > limit;
               });
    return pairs;
  };
  SelfIntersections result;
  for (std::size_t begin = 0, end, round = kFirstRound; begin < faces; begin = end) {
    end = std::min(faces, begin + round);
    round = std::min(2 * round, kLargestRound);
    result.pairs += tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(begin, end, kFacesPerTask), std::size_t(0),
        [&](const tbb::blocked_range<std::size_t>& range, std::size_t sum) {
          progress.check();
          for (std::size_t face = range.begin(); face != range.end() && sum <= limit; ++face)
            sum += pairsOf(static_cast<std::uint32_t>(face));
          return sum;
        },
        std::plus<>());
    if (result.pairs > limit)
      return {limit, false};
  }
  return result;
}

} // namespace tetvdb
