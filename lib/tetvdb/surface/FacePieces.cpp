// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FacePieces.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tetvdb {

FacePlanes::FacePlanes(const std::array<Vec3d, 3>& c)
    : corners(c), plane(LatticePlane::through(c[0], c[1], c[2])), axis(plane.steepestAxis()) {
  for (std::size_t k = 0; k < 3; ++k)
    edges[k] = LatticePlane::alongAxis(c[k], c[(k + 1) % 3], axis, c[(k + 2) % 3]);
}

FacePieces::FacePieces(const FacePlanes& face) : face_(face) {
  Piece whole;
  for (std::size_t k = 0; k < 3; ++k) {
    whole.corners.emplace_back(face.corners[k]);
    whole.sides.push_back({&face.edges[k], 1});
  }
  pieces_.push_back(std::move(whole));
}

std::size_t FacePieces::cut(const FacePlanes& other) {
  std::array<int, 3> sides;
  for (std::size_t k = 0; k < 3; ++k)
    sides[k] = face_.plane.side(other.corners[k]);
  const auto inPlane = std::count(sides.begin(), sides.end(), 0);
  const auto [low, high] = std::minmax_element(sides.begin(), sides.end());
  const std::array<LatticePlane, 3>& edges = other.edges;
  if (inPlane == 3) {
    std::size_t looked = 0;
    for (std::size_t k = 0; k < 3; ++k)
      looked += cutAlong(edges[k], {&edges[(k + 1) % 3], &edges[(k + 2) % 3], nullptr});
    return looked;
  }
  if (inPlane == 2) {
    for (std::size_t k = 0; k < 3; ++k)
      if (sides[(k + 2) % 3] != 0)
        return cutAlong(other.plane, {&edges[(k + 1) % 3], &edges[(k + 2) % 3], nullptr});
  }
  if (*low < 0 && *high > 0)
    return cutAlong(other.plane, {&edges[0], &edges[1], &edges[2]});
  return 0; // at most a point
}

std::size_t FacePieces::cutAlong(const LatticePlane& plane, const Limits& limits) {
  std::vector<std::size_t> open{0};
  std::vector<int> signs;
  std::size_t looked = 0;
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    ++looked;
    const Piece& piece = pieces_[at];
    const std::size_t count = piece.corners.size();
    signs.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      signs[i] = piece.corners[i].side(plane);
    const auto [low, high] = std::minmax_element(signs.begin(), signs.end());
    if (*low >= 0 || *high <= 0)
      continue;
    // The points where the line enters and leaves the piece.
    std::array<PlaneCorner, 2> ends;
    std::size_t found = 0;
    for (std::size_t i = 0; i < count && found < 2; ++i) {
      if (signs[i] == 0)
        ends[found++] = piece.corners[i];
      else if (signs[i] * signs[(i + 1) % count] < 0)
        ends[found++] = PlaneCorner(face_.plane, *piece.sides[i].plane, plane);
    }
    const bool beyond = std::any_of(limits.begin(), limits.end(), [&](const LatticePlane* limit) {
      return limit != nullptr && ends[0].side(*limit) <= 0 && ends[1].side(*limit) <= 0;
    });
    if (beyond)
      continue;
    if (piece.halves != 0) {
      open.push_back(piece.halves);
      open.push_back(piece.halves + 1);
    } else {
      divide(at, plane, signs);
    }
  }
  return looked;
}

void FacePieces::divide(std::size_t at, const LatticePlane& plane, const std::vector<int>& signs) {
  const std::size_t count = signs.size();
  const auto half = [&](int inner) {
    const Piece& piece = pieces_[at];
    Piece part;
    for (std::size_t i = 0; i < count; ++i) {
      const int here = signs[i] * inner, next = signs[(i + 1) % count] * inner;
      if (here >= 0) {
        part.corners.push_back(piece.corners[i]);
        // At a corner on the line toward the outside, the line becomes the next side.
        part.sides.push_back(here == 0 && next < 0 ? Side{&plane, inner} : piece.sides[i]);
      }
      if (here * next < 0) {
        part.corners.emplace_back(face_.plane, *piece.sides[i].plane, plane);
        part.sides.push_back(here > 0 ? Side{&plane, inner} : piece.sides[i]);
      }
    }
    return part;
  };
  Piece positive = half(1), negative = half(-1);
  pieces_[at].halves = pieces_.size();
  pieces_.push_back(std::move(positive));
  pieces_.push_back(std::move(negative));
}

std::vector<Vec3d> FacePieces::outline(std::size_t piece) const {
  std::vector<Vec3d> points;
  for (const PlaneCorner& corner : pieces_[piece].corners)
    points.push_back(corner.position());
  return points;
}

bool FacePieces::innerPoint(std::size_t at, unsigned attempt, std::int64_t& u,
                            std::int64_t& v) const {
  const Piece& piece = pieces_[at];
  const std::size_t p = (face_.axis + 1) % 3, q = (face_.axis + 2) % 3;
  // A mean of the corners, with equal weights first.
  double sum = 0, first = 0, second = 0;
  std::uint64_t random = attempt;
  for (const Vec3d& corner : outline(at)) {
    random = random * 6364136223846793005u + 1442695040888963407u;
    const double weight = attempt == 0 ? 1 : 0.25 + static_cast<double>(random >> 40) * 0x1p-24;
    sum += weight;
    first += weight * corner[p];
    second += weight * corner[q];
  }
  u = std::llrint(first / sum * (1 << kFineBits));
  v = std::llrint(second / sum * (1 << kFineBits));
  const LiftedPoint point(face_.plane, face_.axis, u, v);
  return std::all_of(piece.sides.begin(), piece.sides.end(),
                     [&](const Side& side) { return point.side(*side.plane) == side.inner; });
}

} // namespace tetvdb
