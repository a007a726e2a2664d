// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/IslandSweep.h"

#include "tetvdb/core/DisjointSets.h"

#include <algorithm>
#include <utility>

namespace tetvdb {

void IslandSweep::add(const LabelledSpans& solid, const std::vector<LayerContact>& contacts) {
  const auto before = static_cast<std::uint32_t>(bodies_.size());
  const auto count = static_cast<std::uint32_t>(solid.shapes.size());
  DisjointSets sets(before + count);
  std::vector<std::uint8_t> supported(count, k_ == 0);
  for (const LayerContact& contact : contacts) {
    sets.join(bodyOf_[contact.below], before + contact.above);
    supported[contact.above] = 1;
  }
  // The bodies that reach this layer, in the order of their first components.
  constexpr std::uint32_t kNone = ~std::uint32_t(0);
  std::vector<std::uint32_t> number(before + count, kNone);
  std::vector<Body> bodies;
  std::vector<std::int64_t> pixels;
  bodyOf_.assign(count, 0);
  for (std::uint32_t c = 0; c < count; ++c) {
    const std::uint32_t root = sets.find(before + c);
    if (number[root] == kNone) {
      number[root] = static_cast<std::uint32_t>(bodies.size());
      bodies.emplace_back();
      pixels.push_back(0);
    }
    bodyOf_[c] = number[root];
    Body& body = bodies[bodyOf_[c]];
    pixels[bodyOf_[c]] += solid.shapes[c].pixels;
    if (k_ == 0)
      body.stands = true;
    if (supported[c])
      continue;
    body.islands.push_back(static_cast<std::uint32_t>(islands_.size()));
    islands_.push_back({k_, solid.shapes[c], -1, k_, 0});
  }
  for (std::uint32_t b = 0; b < before; ++b) {
    const std::uint32_t now = number[sets.find(b)];
    if (now == kNone)
      continue;
    Body& body = bodies[now];
    body.stands = body.stands || bodies_[b].stands;
    if (body.islands.size() < bodies_[b].islands.size())
      std::swap(body.islands, bodies_[b].islands);
    body.islands.insert(body.islands.end(), bodies_[b].islands.begin(), bodies_[b].islands.end());
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (const std::uint32_t i : bodies[b].islands) {
      Island& island = islands_[i];
      if (bodies[b].stands) {
        island.joins = k_;
        continue;
      }
      island.last = k_;
      island.largestPixels = std::max(island.largestPixels, pixels[b]);
    }
    if (bodies[b].stands)
      bodies[b].islands.clear();
  }
  bodies_ = std::move(bodies);
  ++k_;
}

} // namespace tetvdb
