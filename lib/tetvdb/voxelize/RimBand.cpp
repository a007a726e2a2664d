// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/RimBand.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace tetvdb {
namespace {

constexpr double kHalfVoxel = static_cast<double>(kUnitsPerVoxel) / 2;
// Halves count as passed a little late (nearestWinding()), and at() has its error.
constexpr double kMargin = 3 * kRimWindingError;
// A winding number this close to a half is one: in the plane of a flat sheet it is but for
// rounding.
constexpr double kTie = kRimWindingError / 10;
// Beyond these a box is split rather than predicted.
constexpr double kMostUnsure = 0.03;
// And the smallest looked at voxel by voxel.
constexpr double kMostUnsureOfSmallest = 0.3;
constexpr std::size_t kMostCurtains = 1024;
// Not split further.
constexpr std::int64_t kSmallestBox = 4;

LatticePoint centreOf(const std::array<std::int64_t, 3>& voxel) {
  return {static_cast<double>(voxel[0] * kUnitsPerVoxel),
          static_cast<double>(voxel[1] * kUnitsPerVoxel),
          static_cast<double>(voxel[2] * kUnitsPerVoxel)};
}

void set(RimBand::Leaf& leaf, const std::array<std::int64_t, 3>& origin,
         const std::array<std::int64_t, 3>& voxel, double value) {
  const auto x = static_cast<std::size_t>(voxel[0] - origin[0]);
  const auto bit = static_cast<std::size_t>((voxel[1] - origin[1]) * 8 + voxel[2] - origin[2]);
  leaf.flags[x] |= std::uint64_t(1) << bit;
  leaf.values[x * 64 + bit] = value;
}

// Distance to the nearest half.
double toHalf(double winding) {
  return std::abs(winding - std::floor(winding) - 0.5);
}

} // namespace

struct RimBand::Middle {
  LatticePoint centre{0, 0, 0};
  double reach = 0;                                          // from the centre to a corner
  double winding = std::numeric_limits<double>::quiet_NaN(); // where it was not needed
  RimWinding::Slope slope;
};

std::int32_t nearestWinding(double winding) {
  const double size = std::ceil(std::abs(winding) - 0.5 - kTie);
  return static_cast<std::int32_t>(winding < 0 ? -size : size);
}

bool RimBand::mayPassHalf(const Corner& first, std::int64_t size, Middle& middle) const {
  if (size >= kLeafSize)
    progress_.check();
  const auto steps = static_cast<double>(size - 1);
  const LatticePoint low = centreOf(first);
  middle.centre = {low.x + steps * kHalfVoxel, low.y + steps * kHalfVoxel,
                   low.z + (steps - 1) * kHalfVoxel};
  middle.reach = kHalfVoxel * std::sqrt(2 * steps * steps + (steps + 1) * (steps + 1));
  middle.slope = rim_.slope(middle.centre, middle.reach);
  const auto& g = middle.slope.gradient;
  const double steepness = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) + middle.slope.error;
  const double change = middle.reach * (steepness + middle.slope.bend * middle.reach / 2);
  if (!(change < 0.5))
    return true;
  middle.winding = rim_.at(middle.centre);
  return toHalf(middle.winding) <= change + kMargin;
}

// Calls visit(first) for the boxes of `smallest` voxels a side that may pass a half.
template <typename Visit>
void RimBand::descend(const Corner& first, std::int64_t size, std::int64_t smallest,
                      const Visit& visit) const {
  Middle middle;
  if (!mayPassHalf(first, size, middle))
    return;
  if (size == smallest) {
    visit(first);
    return;
  }
  const std::int64_t half = size / 2;
  for (int child = 0; child < 8; ++child)
    descend({first[0] + (child >> 2) * half, first[1] + (child >> 1 & 1) * half,
             first[2] + (child & 1) * half},
            half, smallest, visit);
}

std::vector<NodeIndex> RimBand::nodes() const {
  std::vector<NodeIndex> found;
  if (rim_.empty())
    return found;
  const RimWinding::Ball ball = rim_.reach();
  const double radius = ball.radius * kVoxelsPerUnit + 2;
  Corner low{}, high{};
  double longest = 0;
  const double centre[3] = {ball.centre.x, ball.centre.y, ball.centre.z};
  for (std::size_t k = 0; k < 3; ++k) {
    const double c = centre[k] * kVoxelsPerUnit;
    low[k] = static_cast<std::int64_t>(std::floor((c - radius) / kNodeSize));
    high[k] = static_cast<std::int64_t>(std::floor((c + radius) / kNodeSize));
    longest = std::max(longest, static_cast<double>(high[k] - low[k] + 1));
  }
  std::int64_t size = kNodeSize;
  while (static_cast<double>(size) < longest * kNodeSize)
    size *= 2;
  // Eight cubes of a power of two hold the ball wherever it lies.
  Corner start{};
  for (std::size_t k = 0; k < 3; ++k)
    start[k] = low[k] * kNodeSize >= 0 ? low[k] * kNodeSize / size * size
                                       : -((-low[k] * kNodeSize + size - 1) / size) * size;
  constexpr std::int64_t kLast = std::numeric_limits<std::int32_t>::max() / kNodeSize;
  for (int cube = 0; cube < 8; ++cube)
    descend({start[0] + (cube >> 2) * size, start[1] + (cube >> 1 & 1) * size,
             start[2] + (cube & 1) * size},
            size, kNodeSize, [&](const Corner& first) {
              for (const std::int64_t c : first)
                if (c < -kLast * kNodeSize || c > kLast * kNodeSize)
                  throw Error(Status::Limit, "",
                              "the mesh leaves 32-bit index space at this voxel size",
                              "use larger voxels");
              found.push_back({static_cast<std::int32_t>(first[0] / kNodeSize),
                               static_cast<std::int32_t>(first[1] / kNodeSize),
                               static_cast<std::int32_t>(first[2] / kNodeSize)});
            });
  std::sort(found.begin(), found.end());
  return found;
}

std::bitset<4096> RimBand::leaves(const NodeIndex& node) const {
  std::bitset<4096> marks;
  const Corner first{std::int64_t(node[0]) * kNodeSize, std::int64_t(node[1]) * kNodeSize,
                     std::int64_t(node[2]) * kNodeSize};
  descend(first, kNodeSize, kLeafSize, [&](const Corner& leaf) {
    std::size_t bit = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bit = bit * kSlabsPerNode + static_cast<std::size_t>((leaf[k] - first[k]) / kLeafSize);
    marks.set(bit);
  });
  return marks;
}

void RimBand::look(const Vec3i& firstVoxel, Leaf& leaf) const {
  leaf.flags.fill(0);
  const Corner first{firstVoxel[0], firstVoxel[1], firstVoxel[2]};
  look(first, first, kLeafSize, leaf);
}

// Value and slope in a box's middle tell the nearest whole number at nearly all of its voxels, once
// the bend is small; until then boxes are split, and small ones looked at voxel by voxel. Across
// curtains the value jumps by whole numbers.
void RimBand::look(const Corner& origin, const Corner& first, std::int64_t size, Leaf& leaf) const {
  Middle middle;
  if (!mayPassHalf(first, size, middle))
    return;
  const RimWinding::Slope& slope = middle.slope;
  const double unsure = middle.reach * (slope.error + slope.bend * middle.reach / 2);
  const double mostUnsure = size > kSmallestBox ? kMostUnsure : kMostUnsureOfSmallest;
  std::vector<std::uint32_t> curtains;
  if (unsure < mostUnsure && rim_.curtains(middle.centre, static_cast<double>(size) * kHalfVoxel,
                                           kMostCurtains, curtains)) {
    predict(origin, first, size, middle, curtains, leaf);
    return;
  }
  if (size > kSmallestBox) {
    const std::int64_t half = size / 2;
    for (int child = 0; child < 8; ++child)
      look(origin,
           {first[0] + (child >> 2) * half, first[1] + (child >> 1 & 1) * half,
            first[2] + (child & 1) * half},
           half, leaf);
    return;
  }
  RimPoints points;
  for (std::int64_t x = first[0]; x < first[0] + size; ++x)
    for (std::int64_t y = first[1]; y < first[1] + size; ++y)
      for (std::int64_t z = first[2]; z < first[2] + size; ++z) {
        const LatticePoint p = centreOf({x, y, z});
        points.x.push_back(p.x);
        points.y.push_back(p.y);
        points.z.push_back(p.z);
      }
  rim_.at(middle.centre, middle.reach, points);
  std::size_t i = 0;
  for (std::int64_t x = first[0]; x < first[0] + size; ++x)
    for (std::int64_t y = first[1]; y < first[1] + size; ++y)
      for (std::int64_t z = first[2]; z < first[2] + size; ++z)
        set(leaf, origin, {x, y, z}, points.sum[i++]);
}

void RimBand::predict(const Corner& origin, const Corner& first, std::int64_t size,
                      const Middle& middle, const std::vector<std::uint32_t>& curtains,
                      Leaf& leaf) const {
  const RimWinding::Slope& slope = middle.slope;
  const auto& g = slope.gradient;
  const double winding = std::isnan(middle.winding) ? rim_.at(middle.centre) : middle.winding;
  for (std::int64_t x = first[0]; x < first[0] + size; ++x)
    for (std::int64_t y = first[1]; y < first[1] + size; ++y) {
      LatticePoint p = centreOf({x, y, first[2]});
      const double dx = p.x - middle.centre.x, dy = p.y - middle.centre.y;
      const double here = winding + g[0] * dx + g[1] * dy + rim_.jump(middle.centre, p, curtains);
      for (std::int64_t z = first[2]; z < first[2] + size; ++z) {
        p.z = static_cast<double>(z * kUnitsPerVoxel);
        const double dz = p.z - middle.centre.z;
        const double square = dx * dx + dy * dy + dz * dz;
        double value = here + g[2] * dz;
        if (!rim_.rough() &&
            toHalf(value) <= slope.bend * square / 2 + slope.error * std::sqrt(square) + kMargin)
          value = rim_.at(p);
        set(leaf, origin, {x, y, z}, value);
      }
    }
}

} // namespace tetvdb
