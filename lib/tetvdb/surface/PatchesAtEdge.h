// SPDX-License-Identifier: Apache-2.0
//
// The loop over the patches at an edge, for the steps of FaceSides.
#pragma once

#include "tetvdb/surface/FaceSides.h"

#include <algorithm>
#include <utility>

namespace tetvdb {

template <typename Visit>
void FaceSides::eachPatchAt(std::uint32_t edge, const Visit& visit) const {
  const EdgeTable::Sides sides = edges_.sides(edge);
  if (sides.size() <= 2) { // of one patch
    int imbalance = 0;
    for (const std::uint32_t side : sides)
      imbalance += direction(side);
    visit(patches_.patchOf[EdgeTable::faceOf(sides[0])], imbalance);
    return;
  }
  std::vector<std::pair<std::uint32_t, int>> ofPatch;
  for (const std::uint32_t side : sides)
    ofPatch.emplace_back(patches_.patchOf[EdgeTable::faceOf(side)], direction(side));
  std::sort(ofPatch.begin(), ofPatch.end());
  for (std::size_t i = 0, end; i < ofPatch.size(); i = end) {
    int imbalance = 0;
    for (end = i; end < ofPatch.size() && ofPatch[end].first == ofPatch[i].first; ++end)
      imbalance += ofPatch[end].second;
    visit(ofPatch[i].first, imbalance);
  }
}

} // namespace tetvdb
