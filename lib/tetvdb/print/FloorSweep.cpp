// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/FloorSweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tetvdb {
namespace {

std::int32_t layersOf(double limit, const LayerFrame& frame) {
  constexpr double kRounding = 1e-9;
  return static_cast<std::int32_t>(
      std::clamp(std::ceil(limit / frame.layerHeight - kRounding), 1.0, 1e6));
}

} // namespace

FloorSweep::FloorSweep(const LayerFrame& frame, double limit, Take take)
    : height_(layersOf(limit, frame)), disc_(frame.pixelWidth, frame.pixelHeight, 2 * limit, false),
      take_(std::move(take)) {
  std::size_t levels = 1;
  while ((std::int32_t(1) << levels) <= height_)
    ++levels;
  all_.resize(levels);
  any_.resize(levels);
  for (Window& window : any_) // no column begins below the first layer
    window.first = 1 - height_;
  for (std::int32_t k = 1 - height_; k < 0; ++k)
    addThick({});
}

void FloorSweep::Window::push(SpanRows set, std::size_t keep) {
  sets.push_back(std::move(set));
  while (sets.size() > keep) {
    sets.pop_front();
    ++first;
  }
}

void FloorSweep::add(const SpanRows& solid) {
  const auto keep = static_cast<std::size_t>(height_) + 1;
  solid_.push(solid, keep);
  all_[0].push(solid, keep);
  for (std::size_t p = 1; p < all_.size(); ++p) {
    const std::int32_t half = std::int32_t(1) << (p - 1), from = k_ - 2 * half + 1;
    if (from >= 0)
      all_[p].push(intersectionOf(all_[p - 1].at(from), all_[p - 1].at(from + half)), keep);
  }
  ++k_;
  if (k_ < height_)
    return;
  const std::int32_t from = k_ - height_, part = std::int32_t(1) << (all_.size() - 1);
  addThick(intersectionOf(all_.back().at(from), all_.back().at(k_ - part)));
}

// The columns of the limit's height that begin in the next layer.
void FloorSweep::addThick(SpanRows whole) {
  const auto keep = static_cast<std::size_t>(height_) + 1;
  any_[0].push(std::move(whole), keep);
  const std::int32_t last = any_[0].first + static_cast<std::int32_t>(any_[0].sets.size()) - 1;
  for (std::size_t p = 1; p < any_.size(); ++p) {
    const std::int32_t half = std::int32_t(1) << (p - 1), from = last - 2 * half + 1;
    if (from >= 1 - height_)
      any_[p].push(unionOf(any_[p - 1].at(from), any_[p - 1].at(from + half)), keep);
  }
  if (last < 0)
    return;
  const std::int32_t part = std::int32_t(1) << (any_.size() - 1);
  const SpanRows thick =
      unionOf(any_.back().at(last - height_ + 1), any_.back().at(last - part + 1));
  const SpanRows& solid = solid_.at(last);
  take_(last, withoutNear(solid, thick, disc_));
  ++given_;
}

void FloorSweep::finish() {
  // No column reaches above the last layer.
  while (given_ < k_)
    addThick({});
}

} // namespace tetvdb
