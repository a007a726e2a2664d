// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/ActiveTreeWalk.h"

#include <cmath>
#include <limits>

namespace tetvdb {
namespace {

/// Components of a direction below this count as 0: their inverse would overflow.
constexpr double kFlat = 1e-300;

} // namespace

// Where the ray enters the active voxels' box. False where it misses the box.
bool ActiveTree::enter(const IndexRay& ray, Step& step) const {
  double begin = ray.tMin, end = ray.tMax;
  for (std::size_t a = 0; a < 3; ++a) {
    const double low = low_[a], high = double(high_[a]) + 1, d = ray.direction[a];
    if (std::abs(d) < kFlat) {
      if (ray.origin[a] < low || ray.origin[a] >= high)
        return false;
      step.inverse[a] = std::numeric_limits<double>::infinity();
      step.ahead[a] = -1; // to a face that lies ahead, at an infinite t
      continue;
    }
    const double inverse = 1 / d;
    const double in = ((d > 0 ? low : high) - ray.origin[a]) * inverse;
    const double out = ((d > 0 ? high : low) - ray.origin[a]) * inverse;
    if (in > begin) {
      begin = in;
      step.axis = static_cast<int>(a);
    }
    end = std::min(end, out);
    step.inverse[a] = inverse;
    step.ahead[a] = d > 0 ? -1 : 0;
    step.octant |= std::uint32_t(d < 0) << a;
  }
  if (!(begin <= end))
    return false;
  for (std::size_t a = 0; a < 3; ++a) {
    const double place = std::floor(ray.origin[a] + begin * ray.direction[a]);
    step.at[a] =
        static_cast<std::int32_t>(std::min(std::max(place, double(low_[a])), double(high_[a])));
  }
  step.t = begin;
  step.last = end;
  return true;
}

bool ActiveTree::first(const IndexRay& ray, Voxel& found) const {
  const auto find = [&](const Step& step, int) {
    found = {step.at, step.t, step.axis};
    return true;
  };
  const auto findInLeaf = [&](const Step& step, const Leaf& leaf, const auto& ahead,
                              const auto& leave) __attribute__((always_inline)) {
    const Vec3i inLeaf = step.at;
    do {
      const std::uint32_t pair = place<2>(step.at, 1);
      int log2Side = 0;
      if (!(leaf.pairs & ahead[pair]))
        log2Side = 3;
      else if (!(leaf.pairs >> pair & 1))
        log2Side = holdsAround(leaf.pairs, pair) ? 1 : 2;
      else if (leaf.mask->isOn(place<3>(step.at, 0))) {
        find(step, 0);
        return Onward::Stop;
      }
      if (!leave(log2Side))
        return Onward::RayEnds;
    } while (step.isNear(inLeaf, 3));
    return Onward::Continue;
  };
  return descend(ray, findInLeaf, find);
}

} // namespace tetvdb
