// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/GuardedSurface.h"

#include "tetvdb/fields/DistanceBand.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/MarchingCubes.h"
#include "tetvdb/surface/SolidSamples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace tetvdb {
namespace {

using Accessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree, false>;

constexpr double kCubeSquare = 0.75; ///< of the radius of a cube's ball, voxels
constexpr double kOffVoxels = 0.05;  ///< voxels that marchCubes() keeps vertices off centres

// Two neighbouring voxels, one inside.
struct Crossing {
  double inside, outside; ///< squares, voxels
  double inLimit, outLimit;

  double squareAt(double s) const { // lower bound of the square at s of the segment outward
    return inside + s * (outside - inside) - s * (1 - s);
  }
  // The position outward up to which the squared distance is at least `minimum`.
  double guarded(double minimum) const {
    const double b = inside - outside + 1, rest = inside - minimum;
    const double root = b * b - 4 * rest;
    if (b <= 0 || root < 0)
      return 1;
    return std::min(1.0, 2 * rest / (b + std::sqrt(root)));
  }
  double limited() const { return outLimit > 0 ? inLimit / (inLimit - outLimit) : 1; }
};

class GuardedSamples : public SolidSamples {
public:
  GuardedSamples(std::unique_ptr<SolidSamples> shape, const openvdb::FloatGrid* limit,
                 const Guard& guard)
      : shape_(std::move(shape)), limit_(limit), guard_(guard) {
    transform = shape_->transform;
    const double minimum = guard.ofVertices() / guard.voxel;
    square_ = minimum * minimum;
  }

  std::vector<Vec3i> blocks(Progress& progress) const override { return shape_->blocks(progress); }
  void load(const Vec3i& block, BlockSamples& samples) const override {
    shape_->load(block, samples);
  }
  bool hasHeights() const override { return true; }

  double passage(const Vec3i& voxel, std::size_t axis, bool startInside) const override {
    const Crossing crossing = crossingAt(voxel, axis, startInside);
    const double s = std::max(0.0, std::min(crossing.guarded(square_), crossing.limited()));
    return startInside ? s : 1 - s;
  }

  // For a vertex: a lower bound of its squared distance, voxels. It lies between two voxels, off
  // both.
  double squareAt(const Vec3d& point) const {
    Vec3i voxel;
    std::size_t axis = 0;
    double off = 0, along = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double index = (point[k] - transform.origin[k]) / transform.voxelSize[k];
      const double whole = std::round(index);
      voxel[k] = static_cast<std::int32_t>(whole);
      if (std::abs(index - whole) > off) {
        off = std::abs(index - whole);
        axis = k;
        along = index;
      }
    }
    voxel[axis] = static_cast<std::int32_t>(std::floor(along));
    const double t = along - voxel[axis];
    const Crossing crossing = crossingAt(voxel, axis, true);
    return crossing.squareAt(t);
  }

private:
  Crossing crossingAt(const Vec3i& voxel, std::size_t axis, bool startInside) const {
    openvdb::Coord from(voxel.data()), to = from;
    to[axis] += 1;
    if (!startInside)
      std::swap(from, to);
    const Accessor squares(guard_.squared.constTree());
    Crossing crossing{squares.getValue(from), squares.getValue(to), -1, -1};
    if (limit_ != nullptr) {
      const Accessor limits(limit_->constTree());
      crossing.inLimit = limits.getValue(from);
      crossing.outLimit = limits.getValue(to);
    }
    return crossing;
  }

  std::unique_ptr<SolidSamples> shape_;
  const openvdb::FloatGrid* limit_;
  const Guard& guard_;
  double square_;
};

// Of the smallest ball around a triangle.
double ballSquare(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  double sides[3] = {dot(minus(b, c), minus(b, c)), dot(minus(c, a), minus(c, a)),
                     dot(minus(a, b), minus(a, b))};
  std::sort(sides, sides + 3);
  if (sides[0] + sides[1] <= sides[2]) // right or obtuse
    return sides[2] / 4;
  const Vec3d normal = cross(minus(b, a), minus(c, a));
  const double area = dot(normal, normal); // twice the area, squared
  return area > 0 ? sides[0] * sides[1] * sides[2] / (4 * area) : sides[2] / 4;
}

} // namespace

double Guard::ofVertices() const {
  const double minimum = distance + rounding + kDistanceError * voxel;
  return std::sqrt(minimum * minimum + kCubeSquare * voxel * voxel);
}

double Guard::insideFrom() const {
  return ofVertices() + kOffVoxels * voxel;
}

GuardedSurface guardedSurface(const openvdb::FloatGrid::Ptr& shape, const openvdb::FloatGrid* limit,
                              const Guard& guard, Progress& progress) {
  GuardedSurface result;
  const auto grids = std::make_shared<GridSet>();
  grids->all = {shape};
  const Volume volume(grids);
  const GuardedSamples samples(solidSamples(volume, ""), limit, guard);
  result.mesh = marchCubes(samples, {}, progress);
  const std::vector<std::uint32_t>& corners = result.mesh.triangles;
  if (corners.empty())
    return result;
  std::vector<double> squares(result.mesh.points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, squares.size()), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      squares[i] = samples.squareAt(result.mesh.points[i]);
  });
  const double unit = 1 / (guard.voxel * guard.voxel);
  const double minimum = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, corners.size() / 3), std::numeric_limits<double>::max(),
      [&](const auto& range, double sofar) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const std::uint32_t* v = corners.data() + 3 * i;
          const auto& p = result.mesh.points;
          sofar = std::min(sofar, std::min({squares[v[0]], squares[v[1]], squares[v[2]]}) -
                                      ballSquare(p[v[0]], p[v[1]], p[v[2]]) * unit);
        }
        return sofar;
      },
      [](double a, double b) { return std::min(a, b); });
  result.distance =
      (std::sqrt(std::max(minimum, 0.0)) - kDistanceError) * guard.voxel - guard.rounding;
  return result;
}

} // namespace tetvdb
