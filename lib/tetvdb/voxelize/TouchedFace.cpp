// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/TouchedFace.h"

#include "tetvdb/geometry/Ownership.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

constexpr std::int64_t kHalf = kUnitsPerVoxel / 2;
// Up to this extent values of lines, for cubes that the triangle's box meets, fit 64 bits.
constexpr std::int64_t kNarrow = std::int64_t(1) << 30;

Int128 absolute(Int128 v) {
  return v < 0 ? -v : v;
}

// In the coordinates of cubes: cube i is from i to i + 1.
std::int64_t firstCube(std::int64_t low) {
  return (low + kHalf) >> kLatticeBits;
}
std::int64_t lastCube(std::int64_t high) {
  return ((high + kHalf + kUnitsPerVoxel - 1) >> kLatticeBits) - 1;
}

} // namespace

TouchedFace::TouchedFace(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
  const LatticePoint* points[3] = {&a, &b, &c};
  std::int64_t p[3][3];
  for (int i = 0; i < 3; ++i) {
    p[i][0] = static_cast<std::int64_t>(points[i]->x);
    p[i][1] = static_cast<std::int64_t>(points[i]->y);
    p[i][2] = static_cast<std::int64_t>(points[i]->z);
  }
  std::int64_t extent = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax({p[0][k], p[1][k], p[2][k]});
    corner_[k] = p[0][k];
    first_[k] = firstCube(low);
    last_[k] = lastCube(high);
    extent = std::max(extent, high - low);
  }
  narrow_ = extent <= kNarrow;

  const ExactVector n = triangleNormal(a, b, c);
  const Int128 normal[3] = {n.x, n.y, n.z};
  Int128 sum = 0;
  double approximateSum = 0;
  for (int k = 0; k < 3; ++k) {
    normal_[k] = normal[k];
    sum += absolute(normal[k]);
    approximate_[k] = static_cast<double>(normal[k]);
    approximateSum += std::abs(approximate_[k]);
  }
  reach_ = sum * kHalf;
  approximateReach_ = approximateSum * static_cast<double>(kHalf);
  // Seven roundings, of numbers up to the normal's sum times the distance from the first corner.
  error_ = 0x1p-49 * approximateSum * static_cast<double>(extent + 2 * kUnitsPerVoxel);
  if (sum == 0)
    last_[0] = first_[0] - 1;

  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int64_t* from = p[i];
      const std::int64_t* to = p[(i + 1) % 3];
      const std::int64_t* other = p[(i + 2) % 3];
      Line& line = lines_[axis][i];
      line.u = from[v] - to[v];
      line.v = to[u] - from[u];
      line.used = line.u != 0 || line.v != 0;
      const auto value = [&](const std::int64_t* q) {
        return Int128(line.u) * (q[u] - corner_[u]) + Int128(line.v) * (q[v] - corner_[v]);
      };
      const Int128 edge = value(from), opposite = value(other);
      const Int128 reach = (absolute(line.u) + absolute(line.v)) * kHalf;
      line.low = std::min(edge, opposite) - reach;
      line.high = std::max(edge, opposite) + reach;
    }
  }
}

template <typename Int>
bool TouchedFace::between(const Line& line, std::int64_t u, std::int64_t v) const {
  if (!line.used)
    return true;
  const Int value = Int(line.u) * u + Int(line.v) * v;
  return value > static_cast<Int>(line.low) && value < static_cast<Int>(line.high);
}

bool TouchedFace::planeMeets(std::int64_t x, std::int64_t y, std::int64_t z) const {
  const double value =
      std::abs(approximate_[0] * static_cast<double>(x) + approximate_[1] * static_cast<double>(y) +
               approximate_[2] * static_cast<double>(z));
  if (value < approximateReach_ - error_)
    return true;
  if (value > approximateReach_ + error_)
    return false;
  return absolute(normal_[0] * x + normal_[1] * y + normal_[2] * z) < reach_;
}

bool TouchedFace::mayMeet(const NodeIndex& node) const {
  double value = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double midpoint = (static_cast<double>(node[k]) * kNodeSize + 0.5 * (kNodeSize - 1)) *
                                static_cast<double>(kUnitsPerVoxel) -
                            static_cast<double>(corner_[k]);
    value += approximate_[k] * midpoint;
  }
  // A node's half is 64 voxels.
  return std::abs(value) <= approximateReach_ * (kNodeSize + 1);
}

template <typename Int>
void TouchedFace::rasterizeWith(std::int64_t x0, std::int64_t y0, std::int64_t z0,
                                SlabBits& bits) const {
  const auto clip = [](std::int64_t first, std::int64_t last, std::int64_t start, int size) {
    return std::pair(std::max(first, start), std::min(last, start + size - 1));
  };
  const auto [xBegin, xLast] = clip(first_[0], last_[0], x0, kLeafSize);
  const auto [yBegin, yLast] = clip(first_[1], last_[1], y0, kNodeSize);
  const auto [zBegin, zLast] = clip(first_[2], last_[2], z0, kNodeSize);
  const auto centre = [&](std::int64_t voxel, std::size_t k) {
    return voxel * kUnitsPerVoxel - corner_[k];
  };
  const auto all = [&](std::size_t axis, std::int64_t u, std::int64_t v) {
    const auto& lines = lines_[axis];
    return between<Int>(lines[0], u, v) && between<Int>(lines[1], u, v) &&
           between<Int>(lines[2], u, v);
  };
  for (std::int64_t x = xBegin; x <= xLast; ++x) {
    const std::int64_t cx = centre(x, 0);
    for (std::int64_t y = yBegin; y <= yLast; ++y) {
      const std::int64_t cy = centre(y, 1);
      if (!all(2, cx, cy))
        continue;
      // The plane's height says where to look; how far off it may be does not matter.
      std::int64_t from = zBegin, to = zLast;
      if (approximate_[2] != 0) {
        const double unit = static_cast<double>(kUnitsPerVoxel);
        const double midpoint =
            (static_cast<double>(corner_[2]) - (approximate_[0] * static_cast<double>(cx) +
                                                approximate_[1] * static_cast<double>(cy)) /
                                                   approximate_[2]) /
            unit;
        const double reach = (approximateReach_ + error_) / std::abs(approximate_[2]) / unit + 1;
        if (reach < kNodeSize) {
          from = std::max(from, static_cast<std::int64_t>(std::floor(midpoint - reach)));
          to = std::min(to, static_cast<std::int64_t>(std::ceil(midpoint + reach)));
        }
      }
      std::uint64_t* row = bits.rows[(x - x0) * kNodeSize + (y - y0)];
      for (std::int64_t z = from; z <= to; ++z) {
        const std::int64_t cz = centre(z, 2);
        if (planeMeets(cx, cy, cz) && all(0, cy, cz) && all(1, cz, cx))
          row[(z - z0) >> 6] |= std::uint64_t(1) << ((z - z0) & 63);
      }
    }
  }
}

void TouchedFace::rasterize(std::int64_t x0, std::int64_t y0, std::int64_t z0,
                            SlabBits& bits) const {
  if (narrow_)
    rasterizeWith<std::int64_t>(x0, y0, z0, bits);
  else
    rasterizeWith<Int128>(x0, y0, z0, bits);
}

} // namespace tetvdb
