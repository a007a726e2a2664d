// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/RimBand.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace tetvdb {
namespace {

using Corner = std::array<std::int64_t, 3>;

// Halves count as passed a little late (nearestWinding()), and at() has its error.
constexpr double kMargin = 3 * kRimWindingError;

} // namespace

std::int32_t nearestWinding(double winding) {
  const double size = std::ceil(std::abs(winding) - 0.5 - kRimWindingError);
  return static_cast<std::int32_t>(winding < 0 ? -size : size);
}

bool RimBand::mayPassHalf(const Corner& first, std::int64_t size) const {
  const double half = static_cast<double>(kUnitsPerVoxel) / 2;
  const auto steps = static_cast<double>(size - 1);
  const LatticePoint centre{(2 * static_cast<double>(first[0]) + steps) * half,
                            (2 * static_cast<double>(first[1]) + steps) * half,
                            (2 * static_cast<double>(first[2]) + steps - 1) * half};
  const double reach = half * std::sqrt(2 * steps * steps + (steps + 1) * (steps + 1));
  const double change = reach * rim_.gradientBound(centre, reach, 0.5 / reach);
  if (!(change < 0.5))
    return true;
  const double winding = rim_.at(centre);
  return std::abs(winding - std::floor(winding) - 0.5) <= change + kMargin;
}

// Calls visit(first, size) for the boxes of `smallest` voxels a side that may pass a half.
template <typename Visit>
void RimBand::descend(const Corner& first, std::int64_t size, std::int64_t smallest,
                      const Visit& visit) const {
  if (!mayPassHalf(first, size))
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

std::vector<NodeIndex> RimBand::nodes(Progress& progress) const {
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
              progress.check();
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
  descend(first, kLeafSize, 2, [&](const Corner& pair) {
    for (int i = 0; i < 8; ++i) {
      const Corner voxel{pair[0] + (i >> 2), pair[1] + (i >> 1 & 1), pair[2] + (i & 1)};
      const auto x = static_cast<std::size_t>(voxel[0] - first[0]);
      const auto bit = static_cast<std::size_t>((voxel[1] - first[1]) * 8 + voxel[2] - first[2]);
      leaf.flags[x] |= std::uint64_t(1) << bit;
      leaf.values[x * 64 + bit] = rim_.at({static_cast<double>(voxel[0] * kUnitsPerVoxel),
                                           static_cast<double>(voxel[1] * kUnitsPerVoxel),
                                           static_cast<double>(voxel[2] * kUnitsPerVoxel)});
    }
  });
}

} // namespace tetvdb
