// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CrossingGuard.h"

#include "tetvdb/geometry/FaceContact.h"

#include <utility>

namespace tetvdb {

CrossingGuard::CrossingGuard(const std::vector<Vec3d>& points, std::vector<Corners> faces)
    : points_(points), faces_(std::move(faces)), isGone_(faces_.size(), 0), mark_(faces_.size(), 0),
      itemOf_(faces_.size(), 0), live_(faces_.size()), tree_({}) {
  build();
}

Box CrossingGuard::boxOf(const Corners& corners) const {
  Box box;
  for (const std::uint32_t v : corners)
    box.add(points_[v]);
  return box;
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

bool CrossingGuard::crosses(const std::vector<Corners>& added,
                            const std::vector<std::uint32_t>& replaced) {
  for (std::size_t i = 0; i < added.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (facesMeet(points_, added[i].data(), added[j].data()))
        return true;
  ++call_;
  for (const std::uint32_t face : replaced)
    mark_[face] = call_;
  for (const Corners& corners : added) {
    const Box box = boxOf(corners);
    bool meets = false;
    tree_.visit([&](const Box& other) { return other.meets(box); },
                [&](std::uint32_t item) {
                  const std::uint32_t face = items_[item];
                  meets = mark_[face] != call_ &&
                          facesMeet(points_, corners.data(), faces_[face].data());
                  return meets;
                });
    if (meets)
      return true;
  }
  return false;
}

void CrossingGuard::change(std::uint32_t face, const Corners& corners) {
  faces_[face] = corners;
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
