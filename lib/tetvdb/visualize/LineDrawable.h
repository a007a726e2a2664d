// SPDX-License-Identifier: Apache-2.0
//
// Lines of constant width in the picture, however far away.
#pragma once

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/visualize/Drawable.h"

#include <vector>

namespace tetvdb {

struct Line {
  Vec3d from, to; ///< world units
  Rgb color{1, 0, 0};
};

/// Shown in their own colours, without light; they cast no shadow. A line is drawn in front of
/// a surface that it is on, and of surfaces less than twice its width before it. Rays without a
/// pixel do not hit it. About 200 bytes a line.
class LineDrawable : public Drawable {
public:
  LineDrawable(std::vector<Line> lines, double pixels);

  Box bounds() const override { return box_; }
  bool firstHit(const Ray& ray, RayHit& hit) const override;
  bool blocks(const Ray&) const override { return false; }
  double skin() const override { return 0; }

private:
  std::vector<Line> lines_;
  double pixels_;
  Box box_;
  BoxTree tree_;
};

} // namespace tetvdb
