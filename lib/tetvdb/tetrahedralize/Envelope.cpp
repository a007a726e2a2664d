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

// Whether one triangle is near all corners: its neighbourhood is convex, so that all of the piece
// is near it.
template <std::size_t corners>
bool isNear(const Piece<corners>& piece, const NearTriangle& triangle, double limit) {
  for (const Vec3d& corner : piece.at)
    if (!(triangle.squaredDistance(corner) <= limit))
      return false;
  return true;
}

// Halves or quarters of a piece, but for those that one triangle is near all of.
void addParts(const Piece<2>& piece, const NearTriangle& triangle, double limit,
              std::vector<Piece<2>>& parts) {
  const auto& [a, b] = piece.at;
  const Vec3d ab = middleOf(a, b);
  const auto isOut = [&](const Vec3d& p) { return !(triangle.squaredDistance(p) <= limit); };
  const bool isMiddleOut = isOut(ab);
  if (isMiddleOut || isOut(a))
    parts.push_back({{a, ab}});
  if (isMiddleOut || isOut(b))
    parts.push_back({{ab, b}});
}
void addParts(const Piece<3>& piece, const NearTriangle& triangle, double limit,
              std::vector<Piece<3>>& parts) {
  const auto& [a, b, c] = piece.at;
  const Vec3d ab = middleOf(a, b), bc = middleOf(b, c), ca = middleOf(c, a);
  const auto isOut = [&](const Vec3d& p) { return !(triangle.squaredDistance(p) <= limit); };
  const bool isAbOut = isOut(ab), isBcOut = isOut(bc), isCaOut = isOut(ca);
  if (isAbOut || isBcOut || isCaOut)
    parts.push_back({{ab, bc, ca}});
  if (isAbOut || isCaOut || isOut(a))
    parts.push_back({{a, ab, ca}});
  if (isAbOut || isBcOut || isOut(b))
    parts.push_back({{ab, b, bc}});
  if (isBcOut || isCaOut || isOut(c))
    parts.push_back({{ca, bc, c}});
}

template <std::size_t corners>
bool containsPiece(const TriangleTree& tree, const Piece<corners>& whole, double limit) {
  // Triangles near one corner may be near the others.
  int tries = 0;
  bool isIn = false, isWholeIn = false;
  tree.visit(whole.at[0], limit, [&](std::uint32_t i, double&) {
    const NearTriangle& triangle = tree.triangle(i);
    if (!(triangle.squaredDistance(whole.at[0]) <= limit))
      return false;
    isIn = true;
    isWholeIn = isNear(whole, triangle, limit);
    return isWholeIn || ++tries == kTries;
  });
  if (!isIn || isWholeIn)
    return isWholeIn;

  Box box;
  for (const Vec3d& corner : whole.at)
    box.add(corner);
  const TriangleTree::Cut cut(tree, box, std::sqrt(limit));
  for (std::size_t k = 1; k < corners; ++k)
    if (!tree.visit(cut, whole.at[k], limit, [&](std::uint32_t i, double&) {
          return tree.triangle(i).squaredDistance(whole.at[k]) <= limit;
        }))
      return false;

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
    const bool isHeld = tree.visit(cut, centre, limit, [&](std::uint32_t i, double& farthest) {
      const NearTriangle& triangle = tree.triangle(i);
      const double square = triangle.squaredDistance(centre);
      if (!(square <= farthest))
        return false;
      farthest = square;
      nearest = i;
      return isNear(piece, triangle, limit);
    });
    if (isHeld)
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
    addParts(piece, tree.triangle(nearest), limit, waiting);
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
