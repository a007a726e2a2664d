// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/visualize/GridDrawable.h"

#include <cmath>

namespace tetvdb {
namespace {

/// Voxels this many pixels wide or wider get their edges drawn.
constexpr double kEdgePixels = 5;

class VoxelDrawable : public GridDrawable {
public:
  VoxelDrawable(openvdb::GridBase::ConstPtr grid, const VolumeLook& look)
      : GridDrawable(std::move(grid), look) {}

  double skin() const override { return 1e-3 * space_.voxel(); }

  bool firstHit(const Ray& asked, RayHit& hit) const override {
    Kept kept;
    ActiveTree::Voxel voxel;
    if (!keep(asked, kept) || !tree_.first(kept.inside, voxel))
      return false;
    hit.t = voxel.t;
    const Vec3d p = kept.inside.at(voxel.t);
    const int axis = voxel.axis;
    if (axis >= 0) {
      Vec3d gradient{0, 0, 0};
      const auto a = static_cast<std::size_t>(axis);
      gradient[a] = kept.inside.direction[a] > 0 ? -1 : 1;
      hit.normal = space_.normal(gradient);
    } else {
      hit.normal = kept.onCut ? look_.cut->normal : times(kept.ray.direction, -1);
    }
    hit.color = colorOf(voxel.at);
    if (isEdge(p, voxel, kept.ray.pixelAt(voxel.t)))
      for (float& c : hit.color)
        c *= 0.45f;
    hit.lit = true;
    return true;
  }

  bool blocks(const Ray& ray) const override {
    Kept kept;
    ActiveTree::Voxel voxel;
    return keep(ray, kept) && tree_.first(kept.inside, voxel);
  }

private:
  Rgb colorOf(const Vec3i& voxel) const {
    return paint_.at(space_.toWorld({voxel[0] + 0.5, voxel[1] + 0.5, voxel[2] + 0.5}));
  }
  /// On the face through which the ray entered, or on the cut.
  bool isEdge(const Vec3d& p, const ActiveTree::Voxel& voxel, double pixel) const {
    if (!(pixel > 0 && space_.voxel() >= kEdgePixels * pixel))
      return false;
    const double edge = std::min(0.5 * pixel / space_.voxel(), 0.06); // half the line, in voxels
    for (std::size_t a = 0; a < 3; ++a) {
      if (static_cast<int>(a) == voxel.axis)
        continue;
      const double part = p[a] - voxel.at[a];
      if (part < edge || part > 1 - edge)
        return true;
    }
    return false;
  }
};

} // namespace

std::unique_ptr<Drawable> drawVoxels(openvdb::GridBase::ConstPtr grid, const VolumeLook& look) {
  return std::make_unique<VoxelDrawable>(std::move(grid), look);
}

} // namespace tetvdb
