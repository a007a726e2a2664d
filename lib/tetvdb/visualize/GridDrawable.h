// SPDX-License-Identifier: Apache-2.0
//
// The common base of drawables that traverse a grid's tree. Internal.
#pragma once

#include "tetvdb/visualize/VolumePaint.h"

#include <utility>

namespace tetvdb {

class GridDrawable : public Drawable {
public:
  Box bounds() const override { return space_.bounds(tree_.low(), tree_.high()); }
  double support(const Vec3d& direction) const override { return space_.support(tree_, direction); }
  bool mark(EntryMap& map) const override {
    space_.mark(tree_, map);
    return true;
  }

protected:
  GridDrawable(openvdb::GridBase::ConstPtr grid, const VolumeLook& look)
      : grid_(std::move(grid)), look_(look), paint_(look.paint), space_(grid_->transform()),
        tree_(*grid_) {}

  /// The part of a ray that a cut keeps.
  struct Kept {
    Ray ray;
    IndexRay inside;
    bool onCut = false; ///< it begins on the cut's plane
  };
  /// False where nothing is kept.
  bool keep(const Ray& ray, Kept& kept) const {
    kept.ray = ray;
    if (look_.cut && !look_.cut->clip(kept.ray, kept.onCut))
      return false;
    kept.inside = space_.toIndex(kept.ray);
    return true;
  }

  openvdb::GridBase::ConstPtr grid_;
  VolumeLook look_;
  VolumePaint paint_;
  GridSpace space_;
  ActiveTree tree_;
};

} // namespace tetvdb
