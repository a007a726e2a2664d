// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/FaceSides.h"
#include "tetvdb/surface/PatchesAtEdge.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

constexpr std::size_t kFacesInAll = 200000;
constexpr std::uint32_t kDirectionsPerFace = 3; // each in both orientations
// Rays closer to the face's plane than this (sine) are ignored.
constexpr double kGrazing = 0.1;

// The faces of largest area in a list, in a fixed order.
std::vector<std::uint32_t> largestFaces(const std::uint32_t* begin, const std::uint32_t* end,
                                        const std::vector<double>& areas, std::size_t count) {
  std::vector<std::uint32_t> faces(begin, end);
  count = std::min(count, faces.size());
  std::partial_sort(faces.begin(), faces.begin() + static_cast<std::ptrdiff_t>(count), faces.end(),
                    [&](std::uint32_t a, std::uint32_t b) {
                      return areas[a] != areas[b] ? areas[a] > areas[b] : a < b;
                    });
  faces.resize(count);
  return faces;
}

} // namespace

// The worst imbalance of the edges where several patches of a shell meet.
std::vector<FaceSides::Balance> FaceSides::balanceOfShells() const {
  std::vector<Balance> balance(shellCount_, Balance::Even);
  for (std::uint32_t edge = 0; edge < edges_.edgeCount(); ++edge) {
    if (edges_.sides(edge).size() <= 2)
      continue;
    // All patches that do not balance by themselves are of one shell.
    std::size_t patches = 0;
    std::uint32_t shell = 0;
    int sum = 0;
    eachPatchAt(edge, [&](std::uint32_t patch, int imbalance) {
      if (imbalance == 0)
        return;
      ++patches;
      shell = shellOf_[patch];
      sum += imbalance;
    });
    if (patches < 2 || sum == 0)
      continue;
    // With an odd number of faces, one is left over in any orientation.
    const Balance here = std::abs(sum) > 1 ? Balance::Wrong : Balance::Odd;
    balance[shell] = std::max(balance[shell], here);
  }
  return balance;
}

// The number of directions by which the face is oriented outward minus the number by which it is
// oriented inward. A ray that crosses an even number of other faces reaches the outside. A
// direction counts only if the two sides differ: both sides of a fin are outside, both sides of a
// wall within a solid are inside. Only faces of the same shell are counted, since another shell may
// enclose the face.
int FaceSides::visibilityVote(std::uint32_t face) const {
  const Vec3d n = normal(face);
  std::vector<TriangleScene::Hit> hits;
  const auto reachesOutside = [&](const Vec3d& way) {
    shoot(face, way, hits);
    return std::count_if(hits.begin(), hits.end(),
                         [&](const TriangleScene::Hit& hit) {
                           return shellOf(hit.triangle) == shellOf(face);
                         }) %
               2 ==
           0;
  };
  int sum = 0;
  for (std::uint32_t number = 0; number < kDirectionsPerFace; ++number) {
    Vec3d forward = directionFrom(face, number);
    const double along = dot(n, forward);
    if (std::abs(along) <= kGrazing * length(n))
      continue;
    if (along < 0)
      forward = times(forward, -1);
    sum += int(reachesOutside(forward)) - int(reachesOutside(times(forward, -1)));
  }
  return sum;
}

// Collects the votes of the largest faces of a list.
FaceSides::Poll FaceSides::poll(const std::uint32_t* begin, const std::uint32_t* end,
                                std::size_t faces) const {
  Poll poll;
  for (const std::uint32_t face : largestFaces(begin, end, areas_, faces)) {
    const int vote = visibilityVote(face);
    ++poll.asked;
    poll.outward += vote > 0;
    poll.inward += vote < 0;
  }
  return poll;
}

void FaceSides::alignByVisibility(Progress& progress) {
  const std::vector<Balance> balance = balanceOfShells();
  std::vector<std::uint32_t> suspects;
  for (std::uint32_t patch = 0; patch < patches_.patchCount(); ++patch)
    if (balance[shellOf_[patch]] != Balance::Even && patches_.orientable[patch])
      suspects.push_back(patch);
  if (suspects.empty())
    return;
  scene();
  progress.check();

  const FaceLists lists = listByPatch(patches_);
  const std::size_t facesPerPatch =
      std::clamp<std::size_t>(kFacesInAll / suspects.size(), 1, kFacesPerPoll);
  std::vector<std::uint8_t> turn(suspects.size(), 0);
  const auto decide = [&](std::size_t i) {
    const Poll votes = poll(lists.begin(suspects[i]), lists.end(suspects[i]), facesPerPatch);
    turn[i] = balance[shellOf_[suspects[i]]] == Balance::Wrong
                  ? votes.inward > 0 && votes.inward >= 2 * votes.outward
                  : votes.isSureOf(votes.inward);
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, suspects.size(), 16),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      progress.check();
                      for (std::size_t i = range.begin(); i != range.end(); ++i)
                        decide(i);
                    });
  for (std::size_t i = 0; i < suspects.size(); ++i)
    if (turn[i])
      for (const std::uint32_t* face = lists.begin(suspects[i]); face != lists.end(suspects[i]);
           ++face)
        turned_[*face] ^= 1;
}

} // namespace tetvdb
