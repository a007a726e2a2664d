// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FacesOfPoints.h"

#include "tetvdb/core/ForEachIndex.h"

#include <algorithm>
#include <atomic>

namespace tetvdb {

FacesOfPoints::FacesOfPoints(const TriangleMesh& mesh)
    : first_(mesh.points.size() + 1), faces_(mesh.triangles.size()) {
  std::vector<std::atomic<std::uint32_t>> count(mesh.points.size());
  forEachIndex(mesh.triangles.size(), [&](std::size_t i) {
    count[mesh.triangles[i]].fetch_add(1, std::memory_order_relaxed);
  });
  for (std::size_t point = 0; point < count.size(); ++point) {
    first_[point + 1] = first_[point] + count[point].load(std::memory_order_relaxed);
    count[point].store(first_[point], std::memory_order_relaxed);
  }
  forEachIndex(mesh.triangles.size(), [&](std::size_t i) {
    faces_[count[mesh.triangles[i]].fetch_add(1, std::memory_order_relaxed)] =
        static_cast<std::uint32_t>(i / 3);
  });
  forEachIndex(count.size(), [&](std::size_t point) {
    std::sort(faces_.begin() + first_[point], faces_.begin() + first_[point + 1]);
  });
}

} // namespace tetvdb
