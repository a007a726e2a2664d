// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/PointStar.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"

#include <algorithm>

namespace tetvdb {

PointStar::LinkFace PointStar::linkFace(const TetComplex& complex, const TetComplex::Tet& tet,
                                        unsigned localFace) {
  const auto& at = kFaceCorners[localFace];
  const std::array<std::uint32_t, 3> corners{tet.corners[at[0]], tet.corners[at[1]],
                                             tet.corners[at[2]]};
  return {complex.at(corners[0]), complex.at(corners[1]), complex.at(corners[2]), corners,
          cubedWeight(tet)};
}

void PointStar::gather(TetComplex& complex, std::uint32_t point) {
  point_ = point;
  faces_.clear();
  sheets_.clear();
  spokes_.clear();
  worst_ = 0;
  complex.star(point, tets_);
  if (seen_.size() < complex.points.size()) {
    seen_.resize(complex.points.size(), 0);
    spokeOf_.resize(complex.points.size());
  }
  ++round_;
  const Vec3d& centre = complex.at(point);
  for (const std::uint32_t t : tets_) {
    const TetComplex::Tet& tet = complex.tets[t];
    const unsigned i = tet.cornerOf(point);
    const auto& around = kFaceCorners[i];
    faces_.push_back(linkFace(complex, tet, i));
    const std::array<std::uint32_t, 3> corners = faces_.back().corners;
    for (const std::uint32_t corner : corners) {
      if (seen_[corner] == round_)
        continue;
      seen_[corner] = round_;
      spokeOf_[corner] = static_cast<std::uint32_t>(spokes_.size());
      const Vec3d spoke = minus(complex.at(corner), centre);
      spokes_.push_back({corner, 0, dot(spoke, spoke)});
    }
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned localFace = around[k];
      // Both tets of the face are in the star: the lower one counts it.
      if (!tet.tracked[localFace] || tet.neighbours[localFace] < t)
        continue;
      const std::uint32_t p = corners[(k + 1) % 3], q = corners[(k + 2) % 3];
      sheets_.push_back({p, q});
      ++spokes_[spokeOf_[p]].sheets;
      ++spokes_[spokeOf_[q]].sheets;
    }
    worst_ = std::max(worst_, static_cast<double>(energyOf(complex, t)));
  }
}

} // namespace tetvdb
