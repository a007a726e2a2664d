// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/PatchSweep.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/print/LayerContacts.h"

#include <algorithm>
#include <utility>

namespace tetvdb {

void PatchSweep::add(std::int32_t k, LabelledSpans region, const std::vector<double>& widths) {
  const auto before = static_cast<std::uint32_t>(open_.size());
  const auto count = static_cast<std::uint32_t>(region.shapes.size());
  DisjointSets sets(before + count);
  for (const LayerContact& contact : nearContacts(below_, region, columns_, rows_))
    sets.join(patchOf_[contact.below], before + contact.above);

  constexpr std::uint32_t kNone = ~std::uint32_t(0);
  std::vector<std::uint32_t> number(before + count, kNone);
  std::vector<LayerPatch> open;
  patchOf_.assign(count, 0);
  for (std::uint32_t c = 0; c < count; ++c) {
    const std::uint32_t root = sets.find(before + c);
    if (number[root] == kNone) {
      number[root] = static_cast<std::uint32_t>(open.size());
      open.emplace_back();
      open.back().first = open.back().last = open.back().largestLayer = k;
    }
    patchOf_[c] = number[root];
    LayerPatch& patch = open[number[root]];
    const ComponentShape& shape = region.shapes[c];
    patch.pixels += shape.pixels;
    patch.largestPixels += shape.pixels;
    if (shape.pixels > patch.largest.pixels)
      patch.largest = shape;
    patch.box.include(shape.box);
    if (!widths.empty())
      patch.width = std::max(patch.width, widths[c]);
  }
  for (std::uint32_t p = 0; p < before; ++p) {
    const LayerPatch& from = open_[p];
    const std::uint32_t now = number[sets.find(p)];
    if (now == kNone) {
      ended_.push_back(from);
      continue;
    }
    LayerPatch& to = open[now];
    to.first = std::min(to.first, from.first);
    to.pixels += from.pixels;
    to.box.include(from.box);
    to.width = std::max(to.width, from.width);
    if (from.largestPixels > to.largestPixels ||
        (from.largestPixels == to.largestPixels && from.largestLayer < to.largestLayer)) {
      to.largestPixels = from.largestPixels;
      to.largestLayer = from.largestLayer;
      to.largest = from.largest;
    }
  }
  open_ = std::move(open);
  below_ = std::move(region);
}

void PatchSweep::finish() {
  ended_.insert(ended_.end(), open_.begin(), open_.end());
  open_.clear();
}

} // namespace tetvdb
