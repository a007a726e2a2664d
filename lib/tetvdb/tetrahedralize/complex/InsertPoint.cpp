// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/InsertPoint.h"

namespace tetvdb {

void addEdgeHalves(const TetComplex& complex, const std::vector<std::uint32_t>& around,
                   std::uint32_t a, std::uint32_t b, std::vector<TetComplex::NewTet>& fresh) {
  for (const std::uint32_t t : around) {
    const TetComplex::Tet& tet = complex.tets[t];
    const unsigned i = tet.cornerOf(a), j = tet.cornerOf(b);
    for (const unsigned corner : {i, j}) {
      TetComplex::NewTet half;
      half.corners = tet.corners;
      half.corners[corner] = static_cast<std::uint32_t>(complex.points.size());
      half.weight = tet.weight;
      for (unsigned k = 0; k < 4; ++k)
        if (k != i && k != j) {
          half.chains[k] = tet.chains[k];
          half.tracked[k] = tet.tracked[k];
        }
      fresh.push_back(half);
    }
  }
}

// The child's face opposite `corner` is the parent's; its others have the new point, and the
// callers set the chains of those that are parts of a face of the parent.
void PointInsertion::addChild(std::uint32_t t, unsigned corner, std::uint32_t point) {
  const TetComplex::Tet& tet = complex_.tets[t];
  TetComplex::NewTet child;
  child.corners = tet.corners;
  child.corners[corner] = point;
  fresh_.push_back(child);
}

std::uint32_t PointInsertion::commit(const Vec3d& at) {
  const std::uint32_t point = complex_.addPoint(at);
  for (const TetComplex::NewTet& tet : fresh_)
    if (!complex_.isPositive(tet.corners)) {
      complex_.points.pop_back();
      return TetComplex::kNone;
    }
  complex_.replace(old_, fresh_);
  return point;
}

std::uint32_t PointInsertion::intoEdge(std::uint32_t a, std::uint32_t b, const Vec3d& at) {
  if (!complex_.ring(a, b, old_, ring_))
    return TetComplex::kNone;
  fresh_.clear();
  addEdgeHalves(complex_, old_, a, b, fresh_);
  return commit(at);
}

std::uint32_t PointInsertion::intoFace(std::uint32_t t, unsigned localFace, const Vec3d& at) {
  const std::uint32_t across = complex_.tets[t].neighbours[localFace];
  if (across >= TetComplex::kElsewhere)
    return TetComplex::kNone;
  const auto point = static_cast<std::uint32_t>(complex_.points.size());
  old_ = {t, across};
  fresh_.clear();
  const unsigned localFaces[] = {localFace, complex_.localFaceOf(across, t)};
  for (int side = 0; side < 2; ++side) {
    const TetComplex::Tet& tet = complex_.tets[old_[static_cast<std::size_t>(side)]];
    for (unsigned corner = 0; corner < 4; ++corner) {
      if (corner == localFaces[side])
        continue;
      addChild(old_[static_cast<std::size_t>(side)], corner, point);
      fresh_.back().chains[localFaces[side]] = tet.chains[localFaces[side]];
      fresh_.back().tracked[localFaces[side]] = tet.tracked[localFaces[side]];
    }
  }
  return commit(at);
}

} // namespace tetvdb
