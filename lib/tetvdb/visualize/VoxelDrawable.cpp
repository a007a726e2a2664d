// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/visualize/VolumePaint.h"

#include <cmath>

namespace tetvdb {
namespace {

/// Voxels this many pixels wide or wider get their edges drawn.
constexpr double kEdgePixels = 5;

class VoxelDrawable : public Drawable {
public:
  VoxelDrawable(openvdb::GridBase::ConstPtr grid, const VolumeLook& look)
      : grid_(std::move(grid)), look_(look), paint_(look.paint), space_(grid_->transform()),
        tree_(*grid_) {}

  Box bounds() const override { return space_.bounds(tree_.low(), tree_.high()); }
  double support(const Vec3d& direction) const override { return space_.support(tree_, direction); }
  double skin() const override { return 1e-3 * space_.voxel(); }

  bool firstHit(const Ray& asked, RayHit& hit) const override {
    Ray ray = asked;
    bool onCut = false;
    if (look_.cut && !look_.cut->clip(ray, onCut))
      return false;
    const IndexRay inside = space_.toIndex(ray);
    ActiveTree::Voxel voxel;
    if (!tree_.first(inside, voxel))
      return false;
    hit.t = voxel.t;
    const Vec3d p = inside.at(voxel.t);
    const int axis = voxel.axis;
    if (axis >= 0) {
      Vec3d gradient{0, 0, 0};
      const auto a = static_cast<std::size_t>(axis);
      gradient[a] = inside.direction[a] > 0 ? -1 : 1;
      hit.normal = space_.normal(gradient);
    } else {
      hit.normal = onCut ? look_.cut->normal : times(ray.direction, -1);
    }
    hit.color = colorOf(voxel.at);
    if (isEdge(p, voxel, ray.pixelAt(voxel.t)))
      for (float& c : hit.color)
        c *= 0.45f;
    hit.lit = true;
    return true;
  }

  bool blocks(const Ray& asked) const override {
    Ray ray = asked;
    bool onCut = false;
    if (look_.cut && !look_.cut->clip(ray, onCut))
      return false;
    ActiveTree::Voxel voxel;
    return tree_.first(space_.toIndex(ray), voxel);
  }

private:
  Rgb colorOf(const Vec3i& voxel) const {
    return paint_.at(space_.toWorld({voxel[0] + 0.5, voxel[1] + 0.5, voxel[2] + 0.5}));
  }
  /// On the face through which the ray came in, or on the cut.
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

  openvdb::GridBase::ConstPtr grid_;
  VolumeLook look_;
  VolumePaint paint_;
  GridSpace space_;
  ActiveTree tree_;
};

} // namespace

std::unique_ptr<Drawable> drawVoxels(openvdb::GridBase::ConstPtr grid, const VolumeLook& look) {
  return std::make_unique<VoxelDrawable>(std::move(grid), look);
}

} // namespace tetvdb
