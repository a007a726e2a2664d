// SPDX-License-Identifier: Apache-2.0
//
// Light through a fog: what it scatters once towards the eye, less what it absorbs on the way
// (the volume rendering equation with an isotropic phase function).
// Source: N. Max, "Optical Models for Direct Volume Rendering", IEEE TVCG 1(2), 1995.
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/visualize/VolumePaint.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

constexpr int kLightCells = 64; ///< along the longest side
constexpr int kSteps = 320;     ///< along the longest side, at most

/// How much of the light from one direction reaches points of a box.
class LightField {
public:
  LightField() = default;

  /// `makeDensity()` makes, for one thread, a function of a point in the world: optical depth a
  /// unit.
  template <class MakeDensity>
  LightField(const Box& box, const Vec3d& toLight, const MakeDensity& makeDensity,
             Progress& progress)
      : low_(box.low) {
    double longest = 0;
    for (std::size_t a = 0; a < 3; ++a)
      longest = std::max(longest, box.high[a] - box.low[a]);
    cell_ = longest / kLightCells;
    perCell_ = 1 / cell_;
    for (std::size_t a = 0; a < 3; ++a)
      count_[a] = std::max(
          1, std::min(kLightCells, int(std::ceil((box.high[a] - box.low[a]) / cell_ - 1e-9))));
    std::vector<float> depth(std::size_t(count_[0]) * std::size_t(count_[1]) *
                             std::size_t(count_[2]));
    reaches_.resize(depth.size());
    // The depth of a cell, from eight points in it.
    forCells([&] {
      return [&, density = makeDensity()](int i, int j, int k, std::size_t at) {
        double sum = 0;
        for (int n = 0; n < 8; ++n)
          sum += density({low_[0] + (i + (n & 1 ? 0.75 : 0.25)) * cell_,
                          low_[1] + (j + (n & 2 ? 0.75 : 0.25)) * cell_,
                          low_[2] + (k + (n & 4 ? 0.75 : 0.25)) * cell_});
        depth[at] = static_cast<float>(sum / 8 * cell_);
      };
    });
    progress.check();
    const auto reach = [&](int i, int j, int k, std::size_t at) {
      Vec3d p{i + 0.5, j + 0.5, k + 0.5}; // in cells; from the centre, half of its own depth
      double sum = 0.5 * double(depth[at]);
      for (;;) {
        p = plus(p, toLight);
        Vec3i c;
        bool out = false;
        for (std::size_t a = 0; a < 3; ++a) {
          c[a] = static_cast<std::int32_t>(std::floor(p[a]));
          out = out || c[a] < 0 || c[a] >= count_[a];
        }
        if (out)
          break;
        sum += double(depth[place(c[0], c[1], c[2])]);
      }
      reaches_[at] = static_cast<float>(std::exp(-sum));
    };
    forCells([&] { return reach; });
  }

  /// Between the centres of eight cells.
  float at(const Vec3d& world) const {
    int low[3];
    float part[3];
    std::size_t next[3]; // to the next cell along each axis, 0 where there is none
    const std::size_t strides[3] = {std::size_t(count_[1]) * std::size_t(count_[2]),
                                    std::size_t(count_[2]), 1};
    for (std::size_t a = 0; a < 3; ++a) {
      const double last = count_[a] - 1;
      const double p = std::min(std::max((world[a] - low_[a]) * perCell_ - 0.5, 0.0), last);
      low[a] = std::min(static_cast<int>(p), std::max(count_[a] - 2, 0));
      part[a] = static_cast<float>(p - low[a]);
      next[a] = count_[a] > 1 ? strides[a] : 0;
    }
    const float* cell = &reaches_[place(low[0], low[1], low[2])];
    float sum = 0;
    for (int n = 0; n < 8; ++n)
      sum += cell[(n & 1 ? next[0] : 0) + (n & 2 ? next[1] : 0) + (n & 4 ? next[2] : 0)] *
             (n & 1 ? part[0] : 1 - part[0]) * (n & 2 ? part[1] : 1 - part[1]) *
             (n & 4 ? part[2] : 1 - part[2]);
    return sum;
  }

private:
  std::size_t place(int i, int j, int k) const {
    return (std::size_t(i) * std::size_t(count_[1]) + std::size_t(j)) * std::size_t(count_[2]) +
           std::size_t(k);
  }
  /// `makeF()` makes the function for one thread.
  template <class MakeF>
  void forCells(const MakeF& makeF) const {
    tbb::parallel_for(0, count_[0], [&](int i) {
      const auto f = makeF();
      for (int j = 0; j < count_[1]; ++j)
        for (int k = 0; k < count_[2]; ++k)
          f(i, j, k, place(i, j, k));
    });
  }

  Vec3d low_{};
  double cell_ = 1; ///< side, world units
  double perCell_ = 1;
  std::array<int, 3> count_{1, 1, 1};
  std::vector<float> reaches_;
};

class FogMedium : public Medium {
public:
  FogMedium(openvdb::GridBase::ConstPtr grid, const FogLook& look, Progress& progress)
      : grid_(std::move(grid)), look_(look), paint_(look.paint), space_(grid_->transform()),
        tree_(*grid_), values_(valuesOf(*grid_)), isOwnPaint_(look.paint.grid == grid_) {
    const Box box = bounds();
    double longest = 0;
    for (std::size_t a = 0; a < 3; ++a)
      longest = std::max(longest, box.high[a] - box.low[a]);
    if (!(longest > 0))
      return;
    perUnit_ = look.depth / longest;
    step_ = std::max(space_.voxel(), longest / kSteps);
    light_ = LightField(
        box, look.toLight,
        [&] {
          return [this, near = std::shared_ptr<GridValues::Reader>(values_->reader())](
                     const Vec3d& world) { return perUnit_ * valueAt(*near, world); };
        },
        progress);
  }

  Box bounds() const override { return space_.bounds(tree_.low(), tree_.high()); }

  bool mark(EntryMap& map) const override {
    space_.mark(tree_, map);
    return true;
  }

  void gather(const Ray& asked, double jitter, Rgb& light, float& transmittance) const override {
    light = {0, 0, 0};
    transmittance = 1;
    Ray ray = asked;
    bool onCut = false;
    if (look_.cut && !look_.cut->clip(ray, onCut))
      return;
    // Samples have equal distances along the whole ray, whatever nodes it meets.
    const std::unique_ptr<GridValues::Reader> near = values_->reader();
    double before = 0; // a value and its result: equal values in a row are common
    float opacity = 0;
    tree_.walk(space_.toIndex(ray), [&](double begin, double end) {
      const double first = std::ceil(begin / step_ - jitter);
      const double last = std::ceil(end / step_ - jitter);
      for (double n = first; n < last; ++n) {
        const double t = (n + jitter) * step_;
        const Vec3d world = plus(ray.origin, times(ray.direction, t));
        const double value = valueAt(*near, world);
        if (value <= 0)
          continue;
        if (value != before) {
          opacity = static_cast<float>(-std::expm1(-perUnit_ * value * step_));
          before = value;
        }
        const float reaches = look_.ambient + look_.light * light_.at(world);
        const Rgb color = isOwnPaint_ ? paint_.of(value) : paint_.at(world);
        for (std::size_t c = 0; c < 3; ++c)
          light[c] += transmittance * opacity * reaches * color[c];
        transmittance *= 1 - opacity;
      }
      return transmittance < 1e-3f;
    });
    if (transmittance < 1e-3f)
      transmittance = 0;
  }

private:
  /// Of the voxel around a point; 0 where that is not active or the value no positive number.
  double valueAt(GridValues::Reader& near, const Vec3d& world) const {
    const Vec3d p = space_.toIndex(world);
    double value = 0;
    // A call of std::floor() costs as much as all the rest.
    const auto below = [](double x) {
      const auto whole = static_cast<std::int32_t>(x);
      return whole - std::int32_t(x < double(whole));
    };
    if (!near.at({below(p[0]), below(p[1]), below(p[2])}, value))
      return 0;
    return value > 0 && std::isfinite(value) ? value : 0;
  }

  openvdb::GridBase::ConstPtr grid_;
  FogLook look_;
  VolumePaint paint_;
  GridSpace space_;
  ActiveTree tree_;
  std::unique_ptr<GridValues> values_;
  bool isOwnPaint_;    ///< colours are those of the fog's own values
  double perUnit_ = 0; ///< optical depth at value 1, a world unit
  double step_ = 1;    ///< world units
  LightField light_;
};

} // namespace

std::unique_ptr<Medium> drawFog(openvdb::GridBase::ConstPtr grid, const FogLook& look,
                                Progress& progress) {
  return std::make_unique<FogMedium>(std::move(grid), look, progress);
}

} // namespace tetvdb
