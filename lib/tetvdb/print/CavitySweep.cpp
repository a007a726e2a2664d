// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/CavitySweep.h"

#include "tetvdb/core/DisjointSets.h"

#include <algorithm>
#include <utility>

namespace tetvdb {
namespace {

// Merges two cavities that meet.
void merge(LayerCavity& to, const LayerCavity& from) {
  to.onPlate = to.onPlate || from.onPlate;
  to.first = std::min(to.first, from.first);
  to.voxels += from.voxels;
  to.volume += from.volume;
  to.box.include(from.box);
  const bool larger = from.largestPixels != to.largestPixels ? from.largestPixels > to.largestPixels
                                                             : from.largestLayer < to.largestLayer;
  if (larger) {
    to.largestPixels = from.largestPixels;
    to.largestLayer = from.largestLayer;
    to.largest = from.largest;
  }
}

} // namespace

void CavitySweep::end(std::uint32_t cavity, LayerCavity::End how) {
  open_[cavity].end = how;
  endedAs_[numbers_[cavity]] = static_cast<std::uint32_t>(ended_.size());
  ended_.push_back(open_[cavity]);
}

void CavitySweep::add(const LabelledSpans& gaps, const std::vector<LayerContact>& contacts) {
  // Element 0 is the outside, followed by the previous cavities and the components of this layer.
  const auto before = static_cast<std::uint32_t>(open_.size());
  const auto count = static_cast<std::uint32_t>(gaps.shapes.size());
  DisjointSets sets(1 + before + count);
  const auto elementBelow = [&](std::uint32_t label) {
    const std::uint32_t cavity = label == 0 ? kOutside : openOf_[label];
    return cavity == kOutside ? 0 : 1 + cavity;
  };
  const auto elementAbove = [&](std::uint32_t label) {
    return label == 0 ? 0 : 1 + before + label;
  };
  for (const LayerContact& contact : contacts)
    sets.join(elementBelow(contact.below), elementAbove(contact.above));

  constexpr std::uint32_t kNone = ~std::uint32_t(0);
  std::vector<std::uint32_t> cavityAt(1 + before + count, kNone);
  std::vector<LayerCavity> open;
  std::vector<std::uint32_t> numbers;
  std::vector<std::uint32_t> openOf(count, kOutside);
  for (std::uint32_t label = 1; label < count; ++label) {
    const std::uint32_t root = sets.find(elementAbove(label));
    if (root == 0)
      continue;
    const ComponentShape& shape = gaps.shapes[label];
    if (cavityAt[root] == kNone) {
      cavityAt[root] = static_cast<std::uint32_t>(open.size());
      open.emplace_back();
      open.back().first = k_;
      open.back().onPlate = k_ == 0;
      numbers.push_back(kNone);
    }
    openOf[label] = cavityAt[root];
    LayerCavity& cavity = open[openOf[label]];
    cavity.last = cavity.largestLayer = k_;
    cavity.largestPixels += shape.pixels;
    if (shape.pixels > cavity.largest.pixels)
      cavity.largest = shape;
    cavity.box.include(shape.box);
    cavity.voxels += static_cast<double>(shape.pixels);
  }
  for (LayerCavity& cavity : open)
    cavity.volume = cavity.voxels * frame_.pixelWidth * frame_.pixelHeight * frame_.heightOf(k_);
  for (std::uint32_t c = 0; c < before; ++c) {
    const std::uint32_t root = sets.find(1 + c);
    if (root == 0) {
      end(c, LayerCavity::End::Open);
    } else if (cavityAt[root] == kNone) {
      end(c, LayerCavity::End::Closed);
    } else {
      std::uint32_t& number = numbers[cavityAt[root]];
      if (number == kNone)
        number = numbers_[c];
      else
        becomes_[numbers_[c]] = number;
      merge(open[cavityAt[root]], open_[c]);
    }
  }
  for (std::uint32_t& number : numbers) {
    if (number != kNone)
      continue;
    number = static_cast<std::uint32_t>(becomes_.size());
    becomes_.push_back(number);
    endedAs_.push_back(kNone);
  }
  open_ = std::move(open);
  openOf_ = std::move(openOf);
  numbers_ = std::move(numbers);
  ++k_;
}

void CavitySweep::finish() {
  for (std::uint32_t c = 0; c < open_.size(); ++c)
    end(c, LayerCavity::End::Open);
  open_.clear();
  openOf_.clear();
  numbers_.clear();
}

std::uint32_t CavitySweep::cavityOf(std::uint32_t number) {
  while (becomes_[number] != number) {
    becomes_[number] = becomes_[becomes_[number]];
    number = becomes_[number];
  }
  return endedAs_[number];
}

} // namespace tetvdb
