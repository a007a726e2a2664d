// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/FaceRaster.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace tetvdb {
namespace {

// Up to this extent (1024 voxels) every number of the edge walk fits 62 bits.
constexpr double kNarrowExtent = static_cast<double>(std::int64_t(1) << 30);

double extent(double a, double b, double c) {
  return std::max({a, b, c}) - std::min({a, b, c});
}

// One edge of the triangle as a bound on y for x = x0, x0 + 1, ..., stepped without division.
template <typename Int>
class EdgeWalk {
public:
  // From P to Q, the triangle on the left; yBase is the voxel row that bounds are relative to.
  EdgeWalk(const LatticePoint& p, const LatticePoint& q, std::int64_t x0, std::int64_t yBase) {
    const auto units = [](double v) { return static_cast<std::int64_t>(v); };
    const Int b = units(q.x - p.x), d = units(q.y - p.y);
    // p is inside iff b (y - Py) - d (x - Px) > 0, or = 0 and the tie rule for the gradient (-d,
    // b).
    const bool tieIn = tieSign<Int>(-d, b, 0) > 0;
    const Int dx = units(static_cast<double>(x0) * static_cast<double>(kUnitsPerVoxel) - p.x);
    if (b == 0) {
      kind_ = Kind::Vertical;
      vertical_ = d > 0 ? -dx : dx;
      step_ = d > 0 ? -kUnitsPerVoxel : kUnitsPerVoxel;
      tieIn_ = tieIn;
      return;
    }
    kind_ = b > 0 ? Kind::Lower : Kind::Upper;
    const Int absB = b > 0 ? b : -b;
    const Int slope = b > 0 ? d : -d;
    const Int py = units(p.y - static_cast<double>(yBase) * static_cast<double>(kUnitsPerVoxel));
    divisor_ = absB * kUnitsPerVoxel;
    divide(py * absB + slope * dx, quotient_, remainder_);
    divide(slope * kUnitsPerVoxel, quotientStep_, remainderStep_);
    // Lower bounds are inclusive, upper ones exclusive: both take the ceiling where a column on the
    // edge lies on the far side of the bound, else the floor + 1.
    ceiling_ = (kind_ == Kind::Lower) == tieIn;
  }

  // Narrows [low, high) to the rows inside at the present x.
  void narrow(std::int64_t& low, std::int64_t& high) const {
    if (kind_ == Kind::Vertical) {
      if (!(vertical_ > 0 || (vertical_ == 0 && tieIn_)))
        high = low;
      return;
    }
    const auto bound =
        static_cast<std::int64_t>(quotient_ + ((ceiling_ && remainder_ == 0) ? 0 : 1));
    if (kind_ == Kind::Lower)
      low = std::max(low, bound);
    else
      high = std::min(high, bound);
  }

  void next() {
    if (kind_ == Kind::Vertical) {
      vertical_ += step_;
      return;
    }
    quotient_ += quotientStep_;
    remainder_ += remainderStep_;
    if (remainder_ >= divisor_) {
      remainder_ -= divisor_;
      ++quotient_;
    }
  }

private:
  enum class Kind { Lower, Upper, Vertical };

  void divide(Int num, Int& q, Int& r) const {
    q = num / divisor_;
    r = num - q * divisor_;
    if (r < 0) {
      r += divisor_;
      --q;
    }
  }

  Kind kind_ = Kind::Vertical;
  bool tieIn_ = false, ceiling_ = false;
  Int divisor_ = 1, quotient_ = 0, remainder_ = 0, quotientStep_ = 0, remainderStep_ = 0;
  Int vertical_ = 0, step_ = 0;
};

// nearbyint() of numbers below 2^51, without a call: a sum has no bits for fractions.
double nearestWhole(double value) {
  constexpr double kShift = 0x1.8p52;
  return value + kShift - kShift;
}

} // namespace

void SlabCrossings::clear() {
  std::memset(&entering, 0, sizeof entering);
  std::memset(&leaving, 0, sizeof leaving);
  extra.clear();
}

FaceRaster::FaceRaster(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
                       std::int32_t weightOfFace)
    : CrossedFace(a, b, c, weightOfFace),
      wide_(std::max({extent(a.x, b.x, c.x), extent(a.y, b.y, c.y), extent(a.z, b.z, c.z)}) >=
            kNarrowExtent),
      level_(crosses != 0 && slopeX == 0 && slopeY == 0) {}

void FaceRaster::rasterize(std::int64_t x0, std::int64_t y0, std::int64_t z0,
                           SlabCrossings& slab) const {
  if (wide_)
    rasterizeWith<Int128>(x0, y0, z0, slab);
  else
    rasterizeWith<std::int64_t>(x0, y0, z0, slab);
}

template <typename Int>
void FaceRaster::rasterizeWith(std::int64_t x0, std::int64_t y0, std::int64_t z0,
                               SlabCrossings& slab) const {
  const std::int64_t xBegin = std::max<std::int64_t>(xMin, x0),
                     xEnd = std::min<std::int64_t>(xMax, x0 + kLeafSize - 1) + 1;
  const std::int64_t yBegin = std::max<std::int64_t>(yMin - y0, 0);
  const std::int64_t yEnd = std::min<std::int64_t>(yMax - y0, kNodeSize - 1) + 1;
  if (xBegin >= xEnd || yBegin >= yEnd)
    return;

  EdgeWalk<Int> edges[3] = {
      {p[0], p[1], xBegin, y0}, {p[1], p[2], xBegin, y0}, {p[2], p[0], xBegin, y0}};
  const LatticePoint& o = p[0];
  const double oz =
      (o.z - static_cast<double>(z0) * static_cast<double>(kUnitsPerVoxel)) * kVoxelsPerUnit;
  const double oy = static_cast<double>(y0) - o.y * kVoxelsPerUnit;
  const bool clipRows = !level_ && (zMin < z0 || zMax >= z0 + kNodeSize) && std::abs(slopeY) > 1e-3;
  const std::int64_t levelZ = level_ ? exactCrossing(xBegin, y0 + yBegin, floorVoxel(o.z)) - z0 : 0;

  for (std::int64_t x = xBegin; x < xEnd; ++x) {
    std::int64_t low = yBegin, high = yEnd;
    for (EdgeWalk<Int>& edge : edges) {
      edge.narrow(low, high);
      edge.next();
    }
    if (low >= high)
      continue;
    const int rowBase = static_cast<int>(x - x0) * kNodeSize;
    if (level_) {
      if (levelZ >= 0 && levelZ < kNodeSize)
        for (std::int64_t y = low; y < high; ++y)
          slab.add(rowBase + static_cast<int>(y), static_cast<int>(levelZ), weight);
      continue;
    }
    const double base = oz + slopeX * (static_cast<double>(x) - o.x * kVoxelsPerUnit);
    if (clipRows) {
      // Rows whose crossing can be in the node, by the plane's slope, with a margin far above the
      // rounding.
      double first = (-2 - base) / slopeY - oy, last = (kNodeSize + 2 - base) / slopeY - oy;
      if (first > last)
        std::swap(first, last);
      const double margin = 2 + 2 * tolerance / std::abs(slopeY);
      if (first - margin > static_cast<double>(low))
        low = static_cast<std::int64_t>(std::min(first - margin, 1e9));
      if (last + margin < static_cast<double>(high))
        high = static_cast<std::int64_t>(std::max(last + margin, -1e9));
    }
    for (std::int64_t y = low; y < high; ++y) {
      const double crossing = base + slopeY * (static_cast<double>(y) + oy);
      // Outside of the node by more than the rounding error.
      if (!(crossing > -2 - tolerance && crossing < kNodeSize + 2 + tolerance))
        continue;
      const double nearest = nearestWhole(crossing);
      std::int64_t z;
      if (tolerance >= kSteep)
        z = exactCrossing(x, y0 + y, z0) - z0;
      else if (std::abs(crossing - nearest) <= tolerance)
        z = exactCrossing(x, y0 + y, z0 + static_cast<std::int64_t>(nearest)) - z0;
      else
        z = static_cast<std::int64_t>(nearest) + (crossing > nearest ? 1 : 0);
      if (z >= 0 && z < kNodeSize)
        slab.add(rowBase + static_cast<int>(y), static_cast<int>(z), weight);
    }
  }
}

} // namespace tetvdb
