// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/PeelTets.h"

#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/SheetEdge.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"

#include <utility>

namespace tetvdb {
namespace {

// Of a tet with two tracked faces: the edge of neither, and the edge of both.
std::array<std::array<std::uint32_t, 2>, 2> edgesOf(const TetComplex::Tet& tet) {
  std::array<std::array<std::uint32_t, 2>, 2> edges{};
  std::size_t counts[2] = {0, 0};
  for (unsigned localFace = 0; localFace < 4; ++localFace) {
    const std::size_t edge = tet.tracked[localFace] ? 0 : 1;
    edges[edge][counts[edge]++] = tet.corners[localFace];
  }
  return edges;
}

} // namespace

std::size_t TetPeeler::sweep() {
  const auto order = takeChangedTets(complex_, kChanged, energy_, 1);
  std::size_t gone = 0;
  for (const auto& [energy, t] : order) {
    const Answer answer = mayGo(t);
    if (answer == Answer::Yes) {
      complex_.crossOver(t, beyond_);
      ++gone;
    } else if (answer == Answer::NotHere) {
      for (const std::uint32_t corner : complex_.tets[t].corners)
        complex_.points[corner].setChanged(kChanged);
    }
  }
  return gone;
}

TetPeeler::Answer TetPeeler::mayGo(std::uint32_t t) {
  const TetComplex::Tet& tet = complex_.tets[t];
  std::size_t trackedCount = 0;
  Chain out = 0;
  bool isHere = true;
  for (unsigned localFace = 0; localFace < 4; ++localFace) {
    isHere = isHere && tet.neighbours[localFace] < TetComplex::kElsewhere;
    if (!tet.tracked[localFace])
      continue;
    if (trackedCount++ > 0 && tet.chains[localFace] != out)
      return Answer::No;
    out = tet.chains[localFace];
  }
  if (trackedCount == 0 || trackedCount == 4)
    return Answer::No;
  if (!isHere)
    return Answer::NotHere;
  for (unsigned localFace = 0; localFace < 4; ++localFace)
    if (tet.tracked[localFace]) {
      beyond_ = complex_.tets[tet.neighbours[localFace]].weight;
      if (!(beyond_ < 1))
        return Answer::No;
    }
  const Answer topology = keepsTopology(t, trackedCount);
  return topology == Answer::Yes && !keepsBounds(tet) ? Answer::No : topology;
}

// The surface moves from the tet's tracked faces to its others: an edge or point that comes onto
// the surface must not be on it yet, and one that leaves it must be on no other tracked face.
TetPeeler::Answer TetPeeler::keepsTopology(std::uint32_t t, std::size_t trackedCount) const {
  const TetComplex::Tet& tet = complex_.tets[t];
  if (trackedCount == 2) {
    const auto [lone, shared] = edgesOf(tet);
    const OnSheet onSheet = edgeOnSheet(complex_, lone[0], lone[1], t);
    if (onSheet != OnSheet::No)
      return onSheet == OnSheet::Yes ? Answer::No : Answer::NotHere;
    // Other sheets may meet in the edge that leaves the surface.
    std::size_t sheets = 0;
    std::vector<std::uint32_t> ringPoints;
    if (!complex_.ring(shared[0], shared[1], star_, ringPoints, t))
      return Answer::NotHere;
    for (const std::uint32_t around : star_) {
      const TetComplex::Tet& other = complex_.tets[around];
      for (unsigned localFace = 0; localFace < 4; ++localFace)
        sheets += other.tracked[localFace] && other.corners[localFace] != shared[0] &&
                  other.corners[localFace] != shared[1];
    }
    return sheets == 4 ? Answer::Yes : Answer::No; // each of two counted from both sides
  }
  // The corner that leaves the surface, or comes onto it.
  unsigned apex = 0;
  while (tet.tracked[apex] != (trackedCount == 1))
    ++apex;
  const std::uint32_t point = tet.corners[apex];
  if (complex_.points[point].fixed)
    return Answer::NotHere;
  complex_.star(point, star_);
  std::size_t sheets = 0; // counted from both sides
  for (const std::uint32_t around : star_) {
    const TetComplex::Tet& other = complex_.tets[around];
    for (unsigned localFace = 0; localFace < 4; ++localFace)
      sheets += other.tracked[localFace] && other.corners[localFace] != point;
  }
  return sheets == (trackedCount == 1 ? 0u : 6u) ? Answer::Yes : Answer::No;
}

bool TetPeeler::keepsBounds(const TetComplex::Tet& tet) {
  before_.clear();
  after_.clear();
  for (unsigned localFace = 0; localFace < 4; ++localFace) {
    const auto& corner = kFaceCorners[localFace];
    (tet.tracked[localFace] ? before_ : after_)
        .push_back({complex_.at(tet.corners[corner[0]]), complex_.at(tet.corners[corner[1]]),
                    complex_.at(tet.corners[corner[2]])});
  }
  if (before_.size() == 2) {
    const auto [lone, shared] = edgesOf(tet);
    return guard_.allowsFlip(complex_.at(shared[0]), complex_.at(shared[1]), complex_.at(lone[0]),
                             complex_.at(lone[1]));
  }
  // The apex is farthest from the face opposite.
  const auto& [a, b, c] = before_.size() == 1 ? before_[0] : after_[0];
  for (unsigned localFace = 0; localFace < 4; ++localFace)
    if (tet.tracked[localFace] == (before_.size() == 1)) {
      const Vec3d& apex = complex_.at(tet.corners[localFace]);
      if (nearestOnTriangle(minus(a, apex), minus(b, apex), minus(c, apex)).squared >
          bounds_.radius * bounds_.radius)
        return false;
    }
  return guard_.allowsExchange(before_, after_);
}

} // namespace tetvdb
