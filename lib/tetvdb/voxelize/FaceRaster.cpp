// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/FaceRaster.h"

#include "tetvdb/geometry/Ownership.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace tetvdb {
namespace {

// Up to this extent (1024 voxels) every number of the edge walk fits 62 bits.
constexpr double kNarrowExtent = static_cast<double>(std::int64_t(1) << 30);

// From this tolerance on (voxels) a plane is so steep that doubles say nothing of its crossings.
constexpr double kSteep = 0.25;

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

} // namespace

void SlabCrossings::clear() {
  std::memset(&entering, 0, sizeof entering);
  std::memset(&leaving, 0, sizeof leaving);
  extra.clear();
}

void SlabCrossings::add(int row, int z, std::int32_t weight) {
  std::uint64_t& word = (weight > 0 ? entering : leaving).rows[row][z >> 6];
  const std::uint64_t bit = std::uint64_t(1) << (z & 63);
  const std::int32_t one = weight > 0 ? 1 : -1;
  if (word & bit) {
    extra.push_back({row, z, weight});
    return;
  }
  word |= bit;
  if (weight != one)
    extra.push_back({row, z, weight - one});
}

FaceRaster::FaceRaster(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
                       std::int32_t weight)
    : p_{a, b, c} {
  const double ex = extent(a.x, b.x, c.x), ey = extent(a.y, b.y, c.y), ez = extent(a.z, b.z, c.z);
  xMin_ = ceilVoxel(std::min({a.x, b.x, c.x}));
  xMax_ = floorVoxel(std::max({a.x, b.x, c.x}));
  yMin_ = ceilVoxel(std::min({a.y, b.y, c.y}));
  yMax_ = floorVoxel(std::max({a.y, b.y, c.y}));
  zMin_ = ceilVoxel(std::min({a.z, b.z, c.z}));
  zMax_ = floorVoxel(std::max({a.z, b.z, c.z})) + 1;
  if (xMin_ > xMax_ || yMin_ > yMax_)
    return;

  ExactVector n = triangleNormal(a, b, c);
  if (n.z == 0)
    return;
  crosses_ = true;
  wide_ = std::max({ex, ey, ez}) >= kNarrowExtent;
  level_ = n.x == 0 && n.y == 0;
  if (n.z < 0) {
    std::swap(p_[1], p_[2]);
    n = {-n.x, -n.y, -n.z};
    weight_ = weight;
  } else {
    weight_ = -weight;
  }
  const double nx = static_cast<double>(n.x), ny = static_cast<double>(n.y),
               nz = static_cast<double>(n.z);
  slopeX_ = -nx / nz;
  slopeY_ = -ny / nz;
  // z = Pz + slopeX (x - Px) + slopeY (y - Py): each slope has three roundings, each product and
  // sum one more; 2^-49 leaves a factor of two. 256: Pz is taken relative to a node that the
  // crossing lies in or beside.
  tolerance_ =
      std::ldexp(std::abs(slopeX_) * (ex * kVoxelsPerUnit + 1) +
                     std::abs(slopeY_) * (ey * kVoxelsPerUnit + 1) + ez * kVoxelsPerUnit + 256,
                 -49);
}

bool FaceRaster::zRange(std::int64_t x0, std::int64_t x1, std::int64_t y0, std::int64_t y1,
                        std::int64_t& zLow, std::int64_t& zHigh) const {
  x0 = std::max(x0, xMin_);
  x1 = std::min(x1, xMax_);
  y0 = std::max(y0, yMin_);
  y1 = std::min(y1, yMax_);
  if (x0 > x1 || y0 > y1)
    return false;
  const LatticePoint& o = p_[0];
  const auto voxels = [](std::int64_t v, double origin) {
    return static_cast<double>(v) - origin * kVoxelsPerUnit;
  };
  const double left = voxels(x0, o.x), right = voxels(x1, o.x);
  const double front = voxels(y0, o.y), back = voxels(y1, o.y);
  for (int k = 0; k < 3; ++k) {
    const LatticePoint& p = p_[k];
    const LatticePoint& q = p_[(k + 1) % 3];
    const double b = (q.x - p.x) * kVoxelsPerUnit, d = (q.y - p.y) * kVoxelsPerUnit;
    const double px = (p.x - o.x) * kVoxelsPerUnit, py = (p.y - o.y) * kVoxelsPerUnit;
    const double farY = (b > 0 ? back : front) - py, farX = (d > 0 ? left : right) - px;
    const double size = std::abs(b * farY) + std::abs(d * farX);
    if (b * farY - d * farX < -1e-12 * size)
      return false;
  }
  const double z0 = slopeX_ * left, z1 = slopeX_ * right;
  const double z2 = slopeY_ * front, z3 = slopeY_ * back;
  const double low = std::min(z0, z1) + std::min(z2, z3) + o.z * kVoxelsPerUnit - tolerance_;
  const double high = std::max(z0, z1) + std::max(z2, z3) + o.z * kVoxelsPerUnit + tolerance_;
  zLow = zMin_;
  zHigh = zMax_;
  if (low > static_cast<double>(zLow) + 2)
    zLow = static_cast<std::int64_t>(low) - 2;
  if (high < static_cast<double>(zHigh) - 2)
    zHigh = static_cast<std::int64_t>(high) + 2;
  return zLow <= zHigh;
}

// First voxel above the plane in column (x, y). zNear is not above the crossing by a voxel or more
// and not below it by more than one; planes from kSteep on are divided instead, relative to zNear
// so that the numbers fit 128 bits anywhere in index space.
std::int64_t FaceRaster::exactCrossing(std::int64_t x, std::int64_t y, std::int64_t zNear) const {
  const ExactVector n = triangleNormal(p_[0], p_[1], p_[2]);
  const auto units = [](std::int64_t v, double origin) {
    return static_cast<std::int64_t>(static_cast<double>(v) * static_cast<double>(kUnitsPerVoxel) -
                                     origin);
  };
  const Int128 planar = n.x * units(x, p_[0].x) + n.y * units(y, p_[0].y);
  const bool tieIn = tieSign(n.x, n.y, n.z) > 0;
  if (tolerance_ < kSteep) {
    const int sign = signOf(planar + n.z * units(zNear, p_[0].z));
    return sign > 0 || (sign == 0 && tieIn) ? zNear : zNear + 1;
  }
  const Int128 step = n.z * kUnitsPerVoxel;
  const Int128 num = -n.z * units(zNear, p_[0].z) - planar;
  return zNear +
         static_cast<std::int64_t>(tieIn ? ceilDivide(num, step) : floorDivide(num, step) + 1);
}

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
  const std::int64_t xBegin = std::max(xMin_, x0), xEnd = std::min(xMax_, x0 + kLeafSize - 1) + 1;
  const std::int64_t yBegin = std::max<std::int64_t>(yMin_ - y0, 0);
  const std::int64_t yEnd = std::min<std::int64_t>(yMax_ - y0, kNodeSize - 1) + 1;
  if (xBegin >= xEnd || yBegin >= yEnd)
    return;

  EdgeWalk<Int> edges[3] = {
      {p_[0], p_[1], xBegin, y0}, {p_[1], p_[2], xBegin, y0}, {p_[2], p_[0], xBegin, y0}};
  const LatticePoint& o = p_[0];
  const double oz =
      (o.z - static_cast<double>(z0) * static_cast<double>(kUnitsPerVoxel)) * kVoxelsPerUnit;
  const double oy = static_cast<double>(y0) - o.y * kVoxelsPerUnit;
  const bool clipRows =
      !level_ && (zMin_ < z0 || zMax_ >= z0 + kNodeSize) && std::abs(slopeY_) > 1e-3;
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
          slab.add(rowBase + static_cast<int>(y), static_cast<int>(levelZ), weight_);
      continue;
    }
    const double base = oz + slopeX_ * (static_cast<double>(x) - o.x * kVoxelsPerUnit);
    if (clipRows) {
      // Rows whose crossing can be in the node, by the plane's slope, with a margin far above the
      // rounding.
      double first = (-2 - base) / slopeY_ - oy, last = (kNodeSize + 2 - base) / slopeY_ - oy;
      if (first > last)
        std::swap(first, last);
      const double margin = 2 + 2 * tolerance_ / std::abs(slopeY_);
      if (first - margin > static_cast<double>(low))
        low = static_cast<std::int64_t>(std::min(first - margin, 1e9));
      if (last + margin < static_cast<double>(high))
        high = static_cast<std::int64_t>(std::max(last + margin, -1e9));
    }
    for (std::int64_t y = low; y < high; ++y) {
      const double crossing = base + slopeY_ * (static_cast<double>(y) + oy);
      // Beyond the node by more than the tolerance's own use.
      if (!(crossing > -2 - tolerance_ && crossing < kNodeSize + 2 + tolerance_))
        continue;
      const double nearest = std::nearbyint(crossing);
      std::int64_t z;
      if (tolerance_ >= kSteep)
        z = exactCrossing(x, y0 + y, z0) - z0;
      else if (std::abs(crossing - nearest) <= tolerance_)
        z = exactCrossing(x, y0 + y, z0 + static_cast<std::int64_t>(nearest)) - z0;
      else
        z = static_cast<std::int64_t>(nearest) + (crossing > nearest ? 1 : 0);
      if (z >= 0 && z < kNodeSize)
        slab.add(rowBase + static_cast<int>(y), static_cast<int>(z), weight_);
    }
  }
}

} // namespace tetvdb
