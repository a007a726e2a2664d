// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/visualize/VolumePaint.h"

#include <cmath>

namespace tetvdb {
namespace {

class SliceDrawable : public Drawable {
public:
  SliceDrawable(openvdb::GridBase::ConstPtr grid, int axis, double position, const VolumeLook& look)
      : grid_(std::move(grid)), axis_(static_cast<std::size_t>(axis)), position_(position),
        paint_(look.paint), space_(grid_->transform()), tree_(*grid_) {
    if (axis < 0 || axis > 2)
      throw Error(Status::Usage, "", "a slice's axis is x, y or z");
    const openvdb::Mat4d map = grid_->transform().baseMap()->getAffineMap()->getMat4();
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        if (row != column && map[row][column] != 0)
          throw Error(Status::Invalid, grid_->getName(),
                      "the grid's transform turns its axes, so it cannot be cut into slices");
    if (!paint_.grid && paint_.colorOf)
      paint_.grid = grid_;
    if (paint_.grid)
      values_ = valuesOf(*paint_.grid);
  }

  Box bounds() const override {
    Box box = space_.bounds(tree_.low(), tree_.high());
    if (box.low[axis_] <= box.high[axis_])
      box.low[axis_] = box.high[axis_] = position_;
    return box;
  }
  double skin() const override { return 1e-6 * space_.voxel(); }

  bool firstHit(const Ray& ray, RayHit& hit) const override {
    Vec3i voxel;
    if (!meet(ray, hit.t, voxel))
      return false;
    hit.normal = {0, 0, 0};
    hit.normal[axis_] = ray.direction[axis_] > 0 ? -1 : 1;
    hit.color = paint_.plain;
    if (values_) {
      double value = 0;
      values_->at(voxel, value);
      hit.color = paint_.colorOf(value);
    }
    hit.lit = false;
    return true;
  }
  bool blocks(const Ray& ray) const override {
    double t = 0;
    Vec3i voxel;
    return meet(ray, t, voxel);
  }

private:
  bool meet(const Ray& ray, double& t, Vec3i& voxel) const {
    if (ray.direction[axis_] == 0)
      return false;
    t = (position_ - ray.origin[axis_]) / ray.direction[axis_];
    if (!(t >= ray.tMin && t <= ray.tMax))
      return false;
    Vec3d world;
    for (std::size_t a = 0; a < 3; ++a)
      world[a] = ray.origin[a] + t * ray.direction[a];
    world[axis_] = position_;
    const Vec3d p = space_.toIndex(world);
    for (std::size_t a = 0; a < 3; ++a) {
      // No voxel is as far away as a whole number that does not fit.
      if (!(std::abs(p[a]) < 2e9))
        return false;
      voxel[a] = static_cast<std::int32_t>(std::floor(p[a]));
    }
    return tree_.isOn(voxel);
  }

  openvdb::GridBase::ConstPtr grid_;
  std::size_t axis_;
  double position_;
  GridPaint paint_;
  std::unique_ptr<GridValues> values_;
  GridSpace space_;
  ActiveTree tree_;
};

} // namespace

std::unique_ptr<Drawable> drawSlice(openvdb::GridBase::ConstPtr grid, int axis, double position,
                                    const VolumeLook& look) {
  return std::make_unique<SliceDrawable>(std::move(grid), axis, position, look);
}

} // namespace tetvdb
