// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/VolumePaint.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"

#include <cmath>

namespace tetvdb {

bool CutPlane::clip(Ray& ray, bool& entered) const {
  entered = false;
  const double slope = dot(normal, ray.direction);
  const double rest = offset - dot(normal, ray.origin);
  if (slope == 0)
    return rest >= 0;
  const double t = rest / slope;
  if (slope > 0) {
    ray.tMax = std::min(ray.tMax, t);
  } else if (t > ray.tMin) {
    ray.tMin = t;
    entered = true;
  }
  return ray.tMin <= ray.tMax;
}

VolumePaint::VolumePaint(const GridPaint& paint) : paint_(paint) {
  if (!paint_.grid)
    return;
  if (!paint_.colorOf)
    throw Error(Status::Usage, paint_.grid->getName(), "a grid's colours need a colour map");
  values_ = valuesOf(*paint_.grid);
  space_.emplace(paint_.grid->transform());
}

Rgb VolumePaint::at(const Vec3d& world) const {
  if (!values_)
    return paint_.plain;
  const Vec3d p = space_->toIndex(world);
  Vec3i voxel;
  for (std::size_t a = 0; a < 3; ++a)
    voxel[a] = static_cast<std::int32_t>(std::floor(p[a]));
  double value = 0;
  if (values_->at(voxel, value))
    return paint_.colorOf(value);
  double nearest = 0;
  bool found = false;
  for (int n = 0; n < 27; ++n) {
    const Vec3i other{voxel[0] + n / 9 - 1, voxel[1] + n / 3 % 3 - 1, voxel[2] + n % 3 - 1};
    double its = 0;
    if (!values_->at(other, its))
      continue;
    const Vec3d centre{other[0] + 0.5, other[1] + 0.5, other[2] + 0.5};
    const double away = length(minus(centre, p));
    if (found && away >= nearest)
      continue;
    found = true;
    nearest = away;
    value = its;
  }
  return found ? paint_.colorOf(value) : paint_.plain;
}

} // namespace tetvdb
