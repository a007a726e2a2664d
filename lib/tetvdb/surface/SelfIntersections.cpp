// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SelfIntersections.h"

#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/FaceContact.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <numeric>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <utility>

namespace tetvdb {
namespace {

// Faces tested between two checks of the limit, in the first round; the rounds double.
constexpr std::size_t kFirstRound = 1 << 10;
constexpr std::size_t kLargestRound = 1 << 16;
constexpr std::size_t kFacesPerTask = 1 << 8;

Box boxOf(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& corners,
          std::size_t face) {
  Box box;
  for (std::size_t k = 0; k < 3; ++k)
    box.add(points[corners[3 * face + k]]);
  return box;
}

// Of the faces with these numbers, in this order.
BoxTree treeOf(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& corners,
               const std::vector<std::uint32_t>& faces) {
  std::vector<Box> boxes(faces.size());
  forEachIndex(faces.size(), [&](std::size_t i) { boxes[i] = boxOf(points, corners, faces[i]); });
  return BoxTree(std::move(boxes));
}

} // namespace

SelfIntersections countIntersections(const std::vector<Vec3d>& points,
                                     const std::vector<std::uint32_t>& corners, std::size_t limit,
                                     Progress& progress) {
  const std::size_t faces = corners.size() / 3;
  std::vector<std::uint32_t> all(faces);
  std::iota(all.begin(), all.end(), 0u);
  const BoxTree tree = treeOf(points, corners, all);

  // Pairs of one face with later faces, up to the limit.
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

std::vector<std::uint32_t> facesThatMeetOthers(const std::vector<Vec3d>& points,
                                               const std::vector<std::uint32_t>& corners,
                                               const std::vector<char>& looked,
                                               Progress& progress) {
  const std::size_t faces = corners.size() / 3;
  std::vector<std::uint32_t> asked; // they are in the tree
  for (std::uint32_t face = 0; face < faces; ++face)
    if (looked.empty() || looked[face] != 0)
      asked.push_back(face);
  const BoxTree tree = treeOf(points, corners, asked);
  std::vector<std::atomic<bool>> meets(faces);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, faces, kFacesPerTask),
      [&](const tbb::blocked_range<std::size_t>& range) {
        progress.check();
        for (std::size_t face = range.begin(); face != range.end(); ++face) {
          const bool isAsked = looked.empty() || looked[face] != 0;
          const Box box = boxOf(points, corners, face);
          tree.visit(
              [&](const Box& other) { return other.meets(box); },
              [&](std::uint32_t item) {
                const std::uint32_t other = asked[item];
                const bool isTested = isAsked && other <= face; // from the other one
                if (!isTested && !(meets[other] && (meets[face] || !isAsked)) &&
                    facesMeet(points, &corners[3 * face], &corners[3 * std::size_t(other)])) {
                  meets[other] = true;
                  meets[face] = isAsked;
                }
                return false;
              });
        }
      });
  asked.erase(
      std::remove_if(asked.begin(), asked.end(), [&](std::uint32_t face) { return !meets[face]; }),
      asked.end());
  return asked;
}

} // namespace tetvdb
