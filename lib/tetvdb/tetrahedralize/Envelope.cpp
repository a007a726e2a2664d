// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/Envelope.h"

#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/tetrahedralize/TriangleTree.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

// Distances are off by the rounding of coordinates, 2^-53 of the lattice's 2^37 or so.
constexpr double kSafety = 1 - 2e-12;
constexpr std::uint32_t kNone = 0xFFFFFFFFu;
// Triangles near a corner that the other corners are tried against. Where there are more, they are
// small beside the radius, and one of them is unlikely to have all corners near.
constexpr int kTries = 8;
// Parts wait in the order of their size, so that what is out is found before much is looked at
// closely; of more than that, the newest comes first, so that memory stays small.
constexpr std::size_t kWaiting = 512;

// A piece of a candidate: a segment or a triangle.
template <std::size_t corners>
struct Piece {
  std::array<Vec3d, corners> at;
};

Vec3d middleOf(const Vec3d& a, const Vec3d& b) {
  return times(plus(a, b), 0.5);
}

Vec3d centreOf(const Piece<2>& piece) {
  return middleOf(piece.at[0], piece.at[1]);
}
Vec3d centreOf(const Piece<3>& piece) {
  return times(plus(plus(piece.at[0], piece.at[1]), piece.at[2]), 1.0 / 3);
}

std::array<Piece<2>, 2> parted(const Piece<2>& piece) {
  const Vec3d middle = centreOf(piece);
  return {{{{{piece.at[0], middle}}}, {{{middle, piece.at[1]}}}}};
}
std::array<Piece<3>, 4> parted(const Piece<3>& piece) {
  const auto& [a, b, c] = piece.at;
  const Vec3d ab = middleOf(a, b), bc = middleOf(b, c), ca = middleOf(c, a);
  return {{{{{ab, bc, ca}}}, {{{a, ab, ca}}}, {{{ab, b, bc}}}, {{{ca, bc, c}}}}};
}

// Whether one triangle is near all corners: its neighbourhood is convex, so that all of the piece
// is near it.
template <std::size_t corners>
bool isNear(const Piece<corners>& piece, const NearTriangle& triangle, double limit) {
  for (const Vec3d& corner : piece.at)
    if (!(triangle.squaredDistance(corner) <= limit))
      return false;
  return true;
}

template <std::size_t corners>
bool containsPiece(const TriangleTree& tree, const Piece<corners>& whole, double limit) {
  // Corners, each of which may meet the triangle that is near all of them.
  for (std::size_t k = 0; k < corners; ++k) {
    int tries = 0;
    bool isIn = false, isWholeIn = false;
    tree.visit(whole.at[k], limit, [&](std::uint32_t i, double&) {
      const NearTriangle& triangle = tree.triangle(i);
      if (!(triangle.squaredDistance(whole.at[k]) <= limit))
        return false;
      isIn = true;
      isWholeIn = isNear(whole, triangle, limit);
      return isWholeIn || ++tries == kTries || k > 0;
    });
    if (!isIn || isWholeIn)
      return isWholeIn;
  }

  const double least = limit * Envelope::kSlack * Envelope::kSlack;
  thread_local std::vector<Piece<corners>> waiting;
  waiting.assign(1, whole);
  for (std::size_t oldest = 0; oldest < waiting.size();) {
    Piece<corners> piece;
    if (waiting.size() - oldest < kWaiting) {
      piece = waiting[oldest++];
    } else {
      piece = waiting.back();
      waiting.pop_back();
    }
    const Vec3d centre = centreOf(piece);
    // The triangle nearest to the centre, at distance d: if its neighbourhood does not hold the
    // piece, a corner is farther from it than the radius, and d + (centre to corner) exceeds it.
    std::uint32_t nearest = kNone;
    const bool isIn = tree.visit(centre, limit, [&](std::uint32_t i, double& farthest) {
      const NearTriangle& triangle = tree.triangle(i);
      const double square = triangle.squaredDistance(centre);
      if (!(square <= farthest))
        return false;
      farthest = square;
      nearest = i;
      return isNear(piece, triangle, limit);
    });
    if (isIn)
      continue;
    if (nearest == kNone)
      return false;
    double radius = 0;
    for (const Vec3d& corner : piece.at) {
      const Vec3d out = minus(corner, centre);
      radius = std::max(radius, dot(out, out));
    }
    if (radius < least)
      return false;
    for (const Piece<corners>& part : parted(piece))
      if (!isNear(part, tree.triangle(nearest), limit))
        waiting.push_back(part);
  }
  return true;
}

} // namespace

struct Envelope::Impl {
  TriangleTree tree;
  double epsilon;
};

Envelope::Envelope(const std::vector<Vec3d>& points,
                   const std::vector<std::array<std::uint32_t, 3>>& faces, double epsilon)
    : impl_(new Impl{TriangleTree(points, faces), epsilon}) {}

Envelope::~Envelope() = default;

double Envelope::epsilon() const {
  return impl_->epsilon;
}

bool Envelope::empty() const {
  return impl_->tree.empty();
}

bool Envelope::contains(const Vec3d& p, double radius) const {
  const double limit = radius * radius * kSafety;
  const TriangleTree& tree = impl_->tree;
  return tree.visit(p, limit, [&](std::uint32_t i, double&) {
    return tree.triangle(i).squaredDistance(p) <= limit;
  });
}

bool Envelope::contains(const Vec3d& p, const Vec3d& q, double radius) const {
  return containsPiece(impl_->tree, Piece<2>{{p, q}}, radius * radius * kSafety);
}

bool Envelope::contains(const Vec3d& p, const Vec3d& q, const Vec3d& r, double radius) const {
  return containsPiece(impl_->tree, Piece<3>{{p, q, r}}, radius * radius * kSafety);
}

Envelope::Nearest Envelope::nearest(const Vec3d& p) const {
  // Near neighbours first by what is quick, then by distances that tie across shared edges.
  constexpr double kFarthest = 1e300, kAbout = 1 + 1e-9;
  const TriangleTree& tree = impl_->tree;
  Nearest best;
  double least = kFarthest;
  tree.visit(p, kFarthest, [&](std::uint32_t i, double& limit) {
    const NearTriangle& triangle = tree.triangle(i);
    if (triangle.squaredDistance(p) > limit)
      return false;
    const Vec3d a = minus(triangle.a, p);
    const NearestOffset to = nearestOnTriangle(a, plus(a, triangle.ab), plus(a, triangle.ac));
    if (to.squared < least || (to.squared == least && triangle.face < best.face)) {
      least = to.squared;
      limit = least * kAbout;
      best.point = plus(p, to.offset);
      best.face = triangle.face;
    }
    return false;
  });
  best.distance = std::sqrt(least);
  return best;
}

} // namespace tetvdb
