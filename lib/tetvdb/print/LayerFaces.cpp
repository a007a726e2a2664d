// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/LayerFaces.h"

#include <algorithm>
#include <utility>

namespace tetvdb {

LayerFaces::LayerFaces(std::vector<LayerRange> ranges, std::int32_t layers, std::size_t pairsInSlab)
    : ranges_(std::move(ranges)), begins_(static_cast<std::size_t>(layers) + 1, 0), layers_(layers),
      pairsInSlab_(pairsInSlab) {
  for (LayerRange& range : ranges_) {
    range.first = std::max(range.first, 0);
    range.last = std::min(range.last, layers - 1);
    if (range.first <= range.last)
      ++begins_[static_cast<std::size_t>(range.first) + 1];
  }
  for (std::size_t i = 1; i < begins_.size(); ++i)
    begins_[i] += begins_[i - 1];
  order_.resize(begins_.back());
  std::vector<std::size_t> at(begins_.begin(), begins_.end() - 1);
  for (std::size_t i = 0; i < ranges_.size(); ++i)
    if (ranges_[i].first <= ranges_[i].last)
      order_[at[static_cast<std::size_t>(ranges_[i].first)]++] = static_cast<std::uint32_t>(i);
}

LayerSlab LayerFaces::next() {
  // Number of layers: each adds the faces that begin in it, and those that continue.
  std::size_t pairs = 0, met = active_.size();
  std::int32_t end = at_;
  do {
    met += begins_[static_cast<std::size_t>(end) + 1] - begins_[static_cast<std::size_t>(end)];
    pairs += met;
    ++end;
  } while (end < layers_ && pairs < pairsInSlab_);

  active_.insert(
      active_.end(),
      order_.begin() + static_cast<std::ptrdiff_t>(begins_[static_cast<std::size_t>(at_)]),
      order_.begin() + static_cast<std::ptrdiff_t>(begins_[static_cast<std::size_t>(end)]));
  LayerSlab slab;
  slab.first = at_;
  slab.starts.assign(static_cast<std::size_t>(end - at_) + 1, 0);
  const auto forEachPair = [&](const auto& visit) {
    for (const std::uint32_t face : active_) {
      const LayerRange range = ranges_[face];
      for (std::int32_t k = std::max(range.first, at_); k <= std::min(range.last, end - 1); ++k)
        visit(face, static_cast<std::size_t>(k - at_));
    }
  };
  forEachPair([&](std::uint32_t, std::size_t layer) { ++slab.starts[layer + 1]; });
  for (std::size_t i = 1; i < slab.starts.size(); ++i)
    slab.starts[i] += slab.starts[i - 1];
  slab.faces.resize(slab.starts.back());
  std::vector<std::size_t> place(slab.starts.begin(), slab.starts.end() - 1);
  forEachPair([&](std::uint32_t face, std::size_t layer) { slab.faces[place[layer]++] = face; });
  active_.erase(std::remove_if(active_.begin(), active_.end(),
                               [&](std::uint32_t face) { return ranges_[face].last < end; }),
                active_.end());
  at_ = end;
  return slab;
}

} // namespace tetvdb
