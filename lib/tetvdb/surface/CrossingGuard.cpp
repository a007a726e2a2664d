// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CrossingGuard.h"

#include "tetvdb/geometry/FaceContact.h"
#include "tetvdb/geometry/Orientation.h"

#include <algorithm>
#include <utility>

namespace tetvdb {

CrossingGuard::CrossingGuard(const std::vector<Vec3d>& points, std::vector<Corners> faces)
    : points_(points), faces_(std::move(faces)), isGone_(faces_.size(), 0),
      isFlat_(faces_.size(), 0), mark_(faces_.size(), 0), itemOf_(faces_.size(), 0),
      live_(faces_.size()), tree_({}) {
  for (std::size_t face = 0; face < faces_.size(); ++face)
    isFlat_[face] = isFlat(faces_[face]);
  build();
}

Box CrossingGuard::boxOf(const Corners& corners) const {
  Box box;
  for (const std::uint32_t v : corners)
    box.add(points_[v]);
  return box;
}

bool CrossingGuard::isFlat(const Corners& corners) const {
  return areCollinear(points_[corners[0]], points_[corners[1]], points_[corners[2]]);
}

void CrossingGuard::build() {
  std::vector<Box> boxes;
  items_.clear();
  for (std::uint32_t face = 0; face < faces_.size(); ++face)
    if (!isGone_[face]) {
      itemOf_[face] = static_cast<std::uint32_t>(items_.size());
      items_.push_back(face);
      boxes.push_back(boxOf(faces_[face]));
    }
  tree_ = BoxTree(std::move(boxes));
}

std::size_t CrossingGuard::crossings(const std::vector<Corners>& added,
                                     const std::vector<std::uint32_t>& replaced, std::size_t most) {
  std::size_t pairs = 0;
  std::vector<const Corners*> faces; // those that can meet others
  for (const Corners& corners : added)
    if (isFlat(corners))
      ++pairs;
    else
      faces.push_back(&corners);
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t j = 0; j < i && pairs < most; ++j)
      pairs += facesMeet(points_, faces[i]->data(), faces[j]->data());
  ++query_;
  for (const std::uint32_t face : replaced)
    mark_[face] = query_;
  for (const Corners* corners : faces) {
    if (pairs >= most)
      break;
    const Box box = boxOf(*corners);
    tree_.visit([&](const Box& other) { return other.meets(box); },
                [&](std::uint32_t item) {
                  const std::uint32_t face = items_[item];
                  pairs += mark_[face] != query_ && !isFlat_[face] &&
                           facesMeet(points_, corners->data(), faces_[face].data());
                  return pairs >= most;
                });
  }
  return std::min(pairs, most);
}

void CrossingGuard::change(std::uint32_t face, const Corners& corners) {
  faces_[face] = corners;
  isFlat_[face] = isFlat(corners);
  tree_.move(itemOf_[face], boxOf(corners));
}

void CrossingGuard::remove(std::uint32_t face) {
  isGone_[face] = 1;
  tree_.move(itemOf_[face], Box());
  // Rebuilds when half of the tree is empty, since boxes have also moved.
  if (--live_ < items_.size() / 2 && live_ > 0)
    build();
}

} // namespace tetvdb
