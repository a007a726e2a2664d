// SPDX-License-Identifier: Apache-2.0
//
// A field's zero along a ray: found by steps through leaf nodes, then by regula falsi. Fields are
// positive inside; between voxels a level set is trilinear, an occupancy a quadratic B-spline
// (which is exactly a half on a flat side of voxels, and rounds their corners).
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/visualize/GridDrawable.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#include <openvdb/tools/Count.h>
#include <utility>

namespace tetvdb {
namespace {

std::int32_t cellOf(double x) {
  return static_cast<std::int32_t>(std::floor(x));
}

/// Minus the distance, in voxels. Points have their voxels' corners at whole numbers.
template <class TreeT>
class LevelSetField {
public:
  explicit LevelSetField(const openvdb::GridBase& grid)
      : tree_(static_cast<const openvdb::Grid<TreeT>&>(grid).constTree()),
        scale_(-1 / grid.voxelSize()[0]) {}
  /// Steps along the ray, as a share of the distance.
  static constexpr double kStride = 0.9;
  static constexpr double kNarrowest = 1;
  static constexpr double kWidest = 2; ///< normals are no wider than the narrow band

  class Sampler {
  public:
    explicit Sampler(const LevelSetField& field) : values_(field.tree_), scale_(field.scale_) {}
    double operator()(const Vec3d& p) {
      const Vec3d q{p[0] - 0.5, p[1] - 0.5, p[2] - 0.5};
      const openvdb::Coord low(cellOf(q[0]), cellOf(q[1]), cellOf(q[2]));
      const double x = q[0] - low[0], y = q[1] - low[1], z = q[2] - low[2];
      const auto run = [&](int i, int j) {
        return double(values_.getValue(low.offsetBy(i, j, 0))) * (1 - z) +
               double(values_.getValue(low.offsetBy(i, j, 1))) * z;
      };
      const auto slab = [&](int i) { return run(i, 0) * (1 - y) + run(i, 1) * y; };
      return scale_ * (slab(0) * (1 - x) + slab(1) * x);
    }

  private:
    openvdb::tree::ValueAccessor<const TreeT, false> values_;
    double scale_;
  };

private:
  const TreeT& tree_;
  double scale_;
};

/// Three values' shares at p, whose voxel's centre is at 1/2: a quadratic B-spline's.
std::array<double, 3> splineWeights(double p) {
  const double f = p - std::floor(p) - 0.5;
  return {0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)};
}

/// Four values' shares at f between the centres of the second and the third: a cubic B-spline's.
std::array<double, 4> cubicWeights(double f) {
  const double g = 1 - f;
  return {g * g * g / 6, (3 * f * f * f - 6 * f * f + 4) / 6, (3 * g * g * g - 6 * g * g + 4) / 6,
          f * f * f / 6};
}

/// Their derivatives.
std::array<double, 4> cubicSlopes(double f) {
  const double g = 1 - f;
  return {-g * g / 2, f * (3 * f - 4) / 2, -g * (3 * g - 4) / 2, f * f / 2};
}

/// The weighted sum of `value(i, j, k)` around p, less one half.
template <class Value>
double splineSum(const Vec3d& p, const Value& value) {
  const auto wx = splineWeights(p[0]), wy = splineWeights(p[1]), wz = splineWeights(p[2]);
  const Vec3i low{cellOf(p[0]) - 1, cellOf(p[1]) - 1, cellOf(p[2]) - 1};
  double sum = -0.5;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double run = 0;
      for (int k = 0; k < 3; ++k)
        run += wz[std::size_t(k)] * value({low[0] + i, low[1] + j, low[2] + k});
      sum += wx[std::size_t(i)] * wy[std::size_t(j)] * run;
    }
  return sum;
}

class OccupancyField {
public:
  explicit OccupancyField(const ActiveTree& tree) : tree_(tree) {}
  static constexpr double kStride = 0;      // no distance
  static constexpr double kNarrowest = 2.5; ///< wide enough to hide the sides of voxels
  static constexpr double kWidest = 64;

  class Sampler {
  public:
    explicit Sampler(const OccupancyField& field) : probe_(field.tree_) {}
    double operator()(const Vec3d& p) {
      return splineSum(p, [&](const Vec3i& voxel) { return probe_.isOn(voxel) ? 1.0 : 0.0; });
    }

  private:
    ActiveTree::Probe probe_;
  };

private:
  const ActiveTree& tree_;
};

class FogField {
public:
  explicit FogField(const openvdb::GridBase& grid)
      : tree_(static_cast<const openvdb::FloatGrid&>(grid).constTree()) {}
  static constexpr double kStride = 0;
  static constexpr double kNarrowest = 1;
  static constexpr double kWidest = 64;

  class Sampler {
  public:
    explicit Sampler(const FogField& field) : values_(field.tree_) {}
    double operator()(const Vec3d& p) {
      return splineSum(p, [&](const Vec3i& voxel) {
        const double value = double(values_.getValue({voxel[0], voxel[1], voxel[2]}));
        return std::min(std::max(value, 0.0), 1.0);
      });
    }

  private:
    openvdb::tree::ValueAccessor<const openvdb::FloatTree, false> values_;
  };

private:
  const openvdb::FloatTree& tree_;
};

/// Active voxels all have one value: states suffice, and are cheaper to read.
bool isUniform(const openvdb::FloatGrid& grid) {
  const auto range = openvdb::tools::minMax(grid.tree());
  return !(range.min() < range.max());
}

template <class Field>
class SurfaceDrawable : public GridDrawable {
public:
  SurfaceDrawable(openvdb::GridBase::ConstPtr grid, const VolumeLook& look)
      : GridDrawable(std::move(grid), look), field_(makeField(*grid_, tree_)) {
    const Box box = bounds();
    for (std::size_t a = 0; a < 3; ++a)
      centre_[a] = box.low[a] <= box.high[a] ? 0.5 * (box.low[a] + box.high[a]) : 0;
  }

  double skin() const override { return 1.5 * space_.voxel(); }

  /// A cut shows the inside of a surface, where voxels need not be active.
  bool mark(EntryMap& map) const override {
    constexpr bool kOfStates = std::is_same<Field, OccupancyField>::value;
    return (kOfStates || !look_.cut) && GridDrawable::mark(map);
  }

  bool firstHit(const Ray& asked, RayHit& hit) const override {
    Kept kept;
    if (!keep(asked, kept))
      return false;
    const Ray& ray = kept.ray;
    Sampler sample(field_);
    if (!find(kept.inside, kept.onCut, isCoarse(ray), sample, hit.t))
      return false;
    const Vec3d p = kept.inside.at(hit.t);
    if (kept.onCut) {
      hit.normal = look_.cut->normal;
    } else {
      const double radius = std::min(
          std::max(0.75 * ray.pixelAt(hit.t) / space_.voxel(), Field::kNarrowest), Field::kWidest);
      hit.normal = space_.normal(outwards(p, radius, sample));
      if (dot(hit.normal, hit.normal) < 0.5)
        hit.normal = times(ray.direction, -1);
      else if (dot(hit.normal, ray.direction) > 0) // a thin wall seen at a grazing angle
        hit.normal = times(hit.normal, -1);
    }
    hit.color = paint_.at(minus(space_.toWorld(p), times(hit.normal, 0.5 * space_.voxel())));
    hit.lit = true;
    return true;
  }

  bool blocks(const Ray& ray) const override {
    Kept kept;
    if (!keep(ray, kept))
      return false;
    if constexpr (Field::kStride == 0) { // as good within a voxel, and many times faster
      ActiveTree::Voxel voxel;
      return tree_.first(kept.inside, voxel);
    }
    Sampler sample(field_);
    double t = 0;
    return find(kept.inside, kept.onCut, false, sample, t);
  }

private:
  using Sampler = typename Field::Sampler;

  static Field makeField(const openvdb::GridBase& grid, const ActiveTree& tree) {
    if constexpr (std::is_same<Field, OccupancyField>::value)
      return Field(tree);
    else
      return Field(grid);
  }

  /// Voxels are smaller than the ray's pixel is at the centre of the volume: the first one is the
  /// surface.
  bool isCoarse(const Ray& ray) const {
    const double central = std::max(0.0, dot(minus(centre_, ray.origin), ray.direction));
    return ray.pixelAt(central) > 1.5 * space_.voxel();
  }

  /// The first t at which the field is not negative; `onCut` says, and is told, whether that is
  /// where the ray begins.
  bool find(const IndexRay& ray, bool& onCut, bool coarse, Sampler& sample, double& t) const {
    if (onCut && sample(ray.at(ray.tMin)) >= 0) {
      t = ray.tMin;
      return true;
    }
    onCut = false;
    const double voxelsPerT = length(ray.direction);
    if constexpr (Field::kStride > 0) {
      return tree_.walk(ray, [&](double begin, double end) {
        return stepThrough(ray, sample, begin, end, voxelsPerT, t);
      });
    } else {
      // The surface lies within a voxel of active ones.
      IndexRay rest = ray;
      for (ActiveTree::Voxel voxel; tree_.first(rest, voxel);) {
        if (coarse) {
          t = voxel.t;
          return true;
        }
        const double begin = std::max(ray.tMin, voxel.t - 0.5 / voxelsPerT);
        const double end = std::min(ray.tMax, voxel.t + 1.5 / voxelsPerT);
        if (stepThrough(ray, sample, begin, end, voxelsPerT, t))
          return true;
        rest.tMin = end;
        if (!(rest.tMin < rest.tMax))
          return false;
      }
      return false;
    }
  }

  bool stepThrough(const IndexRay& ray, Sampler& sample, double begin, double end,
                   double voxelsPerT, double& t) const {
    double before = begin, beforeValue = sample(ray.at(before));
    if (beforeValue >= 0) {
      t = before;
      return true;
    }
    while (before < end) {
      const double stride = std::max(0.5, -Field::kStride * beforeValue) / voxelsPerT;
      const double next = std::min(before + stride, end);
      const double value = sample(ray.at(next));
      if (value >= 0) {
        t = closeIn(ray, sample, before, beforeValue, next, value);
        return true;
      }
      before = next;
      beforeValue = value;
    }
    return false;
  }

  /// Regula falsi with Illinois' halving.
  static double closeIn(const IndexRay& ray, Sampler& sample, double out, double outValue,
                        double in, double inValue) {
    int side = 0;
    for (int round = 0; round < 5 && inValue > 0; ++round) {
      const double between = out + (in - out) * outValue / (outValue - inValue);
      const double value = sample(ray.at(between));
      if (value >= 0) {
        in = between;
        inValue = value;
        if (side == 1)
          outValue *= 0.5;
        side = 1;
      } else {
        out = between;
        outValue = value;
        if (side == -1)
          inValue *= 0.5;
        side = -1;
      }
    }
    return outValue < inValue ? out + (in - out) * outValue / (outValue - inValue) : in;
  }

  /// Against the field's gradient: over `radius` voxels.
  Vec3d outwards(const Vec3d& p, double radius, Sampler& sample) const {
    Vec3d normal{0, 0, 0};
    if (!std::is_same<Field, OccupancyField>::value || radius <= 2) {
      for (std::size_t a = 0; a < 3; ++a) {
        Vec3d ahead = p, behind = p;
        ahead[a] += radius;
        behind[a] -= radius;
        normal[a] = sample(behind) - sample(ahead);
      }
      return normal;
    }
    // Of the share of active voxels in cubes about as large as the radius, a cubic B-spline: on a
    // plane of any slope it errs by 2 degrees in the mean, a quadratic one by 4, which is visible
    // as ripples.
    ActiveTree::Probe probe(tree_);
    const int log2Side = radius < 3 ? 1 : radius < 6 ? 2 : 3;
    const double side = 1 << log2Side;
    std::array<std::array<double, 4>, 3> weights{}, slopes{};
    Vec3i low{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double q = p[a] / side - 0.5, f = q - std::floor(q);
      low[a] = cellOf(q) - 1;
      weights[a] = cubicWeights(f);
      slopes[a] = cubicSlopes(f);
    }
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        const std::array<double, 4> shares =
            probe.filled({low[0] + int(i), low[1] + int(j), low[2]}, log2Side);
        double share = 0, slope = 0; // of the row
        for (std::size_t k = 0; k < 4; ++k) {
          share += weights[2][k] * shares[k];
          slope += slopes[2][k] * shares[k];
        }
        normal[0] -= slopes[0][i] * weights[1][j] * share;
        normal[1] -= weights[0][i] * slopes[1][j] * share;
        normal[2] -= weights[0][i] * weights[1][j] * slope;
      }
    return normal;
  }

  Field field_;
  Vec3d centre_{}; ///< of the bounds
};

} // namespace

std::unique_ptr<Drawable> drawSurface(openvdb::GridBase::ConstPtr grid, const VolumeLook& look) {
  using openvdb::DoubleGrid;
  using openvdb::FloatGrid;
  if (grid->getGridClass() == openvdb::GRID_LEVEL_SET) {
    if (grid->isType<FloatGrid>())
      return std::make_unique<SurfaceDrawable<LevelSetField<openvdb::FloatTree>>>(grid, look);
    if (grid->isType<DoubleGrid>())
      return std::make_unique<SurfaceDrawable<LevelSetField<openvdb::DoubleTree>>>(grid, look);
  }
  const bool shares = grid->getName() == "density" || grid->getName() == "coverage";
  if (shares && grid->isType<FloatGrid>() && !isUniform(static_cast<const FloatGrid&>(*grid)))
    return std::make_unique<SurfaceDrawable<FogField>>(grid, look);
  return std::make_unique<SurfaceDrawable<OccupancyField>>(std::move(grid), look);
}

} // namespace tetvdb
