// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/LineDrawable.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace tetvdb {
namespace {

std::vector<Box> boxesOf(const std::vector<Line>& lines) {
  std::vector<Box> boxes(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    boxes[i].add(lines[i].from);
    boxes[i].add(lines[i].to);
  }
  return boxes;
}

// Whether the ray comes as near to the box as `reach`, measured along each axis.
bool passes(const Ray& ray, const Box& box, double reach) {
  double t0 = ray.tMin, t1 = ray.tMax;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double below = box.low[axis] - reach - ray.origin[axis];
    const double above = box.high[axis] + reach - ray.origin[axis];
    if (ray.direction[axis] == 0) {
      if (below > 0 || above < 0)
        return false;
      continue;
    }
    const double a = below / ray.direction[axis], b = above / ray.direction[axis];
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
  return t0 <= t1;
}

} // namespace

LineDrawable::LineDrawable(std::vector<Line> lines, double pixels)
    : lines_(std::move(lines)), pixels_(pixels), tree_(boxesOf(lines_)) {
  for (const Line& line : lines_) {
    box_.add(line.from);
    box_.add(line.to);
  }
}

bool LineDrawable::firstHit(const Ray& ray, RayHit& hit) const {
  if (!(ray.pixel > 0 || ray.spread > 0) || lines_.empty())
    return false;
  const double away = dot(ray.origin, ray.direction);
  // Lines are found up to so far behind what covers them.
  const auto lead = [&](double t) { return 2 * pixels_ * ray.pixelAt(t); };
  Ray longer = ray;
  longer.tMax += lead(std::min(ray.tMax, supportOf(box_, ray.direction) - away));
  constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  std::uint32_t first = kNone;
  double nearest = ray.tMax;
  tree_.visit(
      [&](const Box& box) {
        const double last = supportOf(box, ray.direction) - away;
        return last >= ray.tMin && passes(longer, box, pixels_ * ray.pixelAt(last));
      },
      [&](std::uint32_t number) {
        const Line& line = lines_[number];
        const Vec3d a = minus(line.from, ray.origin), along = minus(line.to, line.from);
        const double ta = dot(a, ray.direction), slope = dot(along, ray.direction);
        const Vec3d acrossA = minus(a, times(ray.direction, ta));
        const Vec3d across = minus(along, times(ray.direction, slope));
        const double squared = dot(across, across);
        const double s = squared > 0 ? std::clamp(-dot(acrossA, across) / squared, 0.0, 1.0) : 0;
        const Vec3d offset = plus(acrossA, times(across, s));
        const double onLine = ta + s * slope;
        const double reach = pixels_ / 2 * ray.pixelAt(onLine);
        const double t = onLine - lead(onLine);
        if (!(dot(offset, offset) <= reach * reach) || onLine < ray.tMin || t > nearest)
          return false;
        // Of lines at one place the first in the list, whatever the order of the search.
        if (t < nearest || number < first)
          first = number;
        nearest = t;
        return false;
      });
  if (first == kNone)
    return false;
  hit.t = std::max(nearest, ray.tMin);
  hit.normal = times(ray.direction, -1);
  hit.color = lines_[first].color;
  hit.lit = false;
  return true;
}

} // namespace tetvdb
