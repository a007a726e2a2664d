// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/Envelope.h"

#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/tetrahedralize/TriangleTree.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

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
// Some ten milliseconds. A candidate in the wedge between two far-off triangles is parted into
// (1 / kSlack)^2 pieces and more; one that lies over that many triangles is best not made either.
constexpr std::size_t kMostPieces = 20000;

// Corners of a piece, and of one that is cut: rounding apart it gets one more, and where rounding
// makes it change sides six times, three more.
constexpr std::size_t kMostCorners = 9;
constexpr std::size_t kCutCorners = 6;
// How far from a triangle's edges pieces are cut, and from where on they are, as a part of how far
// its neighbourhood reaches there: where the two are apart, no slivers are cut off.
constexpr double kCutAt = 0.6, kCutFrom = 0.95;

// Pieces larger than that, in what the neighbourhood reaches, are cut; others are parted in equal
// parts, which is quicker.
constexpr double kLarge = 3;

// A convex piece of a candidate: a segment or a polygon.
struct Piece {
  std::array<Vec3d, kMostCorners> at;
  std::size_t corners;

  Piece() = default;
  Piece(std::initializer_list<Vec3d> points) : corners(points.size()) {
    std::copy(points.begin(), points.end(), at.begin());
  }
  Piece(const Piece& other) : corners(other.corners) {
    std::copy(other.at.begin(), other.at.begin() + corners, at.begin());
  }
  Piece& operator=(const Piece& other) {
    corners = other.corners;
    std::copy(other.at.begin(), other.at.begin() + corners, at.begin());
    return *this;
  }
  void add(const Vec3d& p) { at[corners++] = p; }
  Vec3d centre() const {
    Vec3d sum{0, 0, 0};
    for (std::size_t k = 0; k < corners; ++k)
      sum = plus(sum, at[k]);
    return times(sum, 1 / static_cast<double>(corners));
  }
};

// Whether one triangle is near all corners: its neighbourhood is convex, so that all of the piece
// is near it.
bool isNear(const Piece& piece, const NearTriangle& triangle, double limit) {
  for (std::size_t k = 0; k < piece.corners; ++k)
    if (!(triangle.squaredDistance(piece.at[k]) <= limit))
      return false;
  return true;
}

// Parts a piece where heights of its corners change their sign.
void cut(const Piece& piece, const std::array<double, kMostCorners>& heights, Piece& below,
         Piece& above) {
  below.corners = above.corners = 0;
  for (std::size_t k = 0; k < piece.corners; ++k) {
    const std::size_t next = k + 1 < piece.corners ? k + 1 : 0;
    (heights[k] > 0 ? above : below).add(piece.at[k]);
    if ((heights[k] > 0) == (heights[next] > 0) || (piece.corners == 2 && next == 0))
      continue;
    const double share = heights[k] / (heights[k] - heights[next]);
    const Vec3d between = plus(piece.at[k], times(minus(piece.at[next], piece.at[k]), share));
    below.add(between);
    above.add(between);
  }
}

// Across its longest diagonal; many corners are shared out first.
void halve(const Piece& piece, Piece& one, Piece& other) {
  if (piece.corners > kCutCorners) {
    const std::size_t middle = piece.corners / 2;
    one.corners = other.corners = 0;
    for (std::size_t k = 0; k <= middle; ++k)
      one.add(piece.at[k]);
    for (std::size_t k = middle; k < piece.corners; ++k)
      other.add(piece.at[k]);
    other.add(piece.at[0]);
    return;
  }
  Vec3d longest{0, 0, 0};
  for (std::size_t k = 0; k < piece.corners; ++k)
    for (std::size_t l = 0; l < k; ++l) {
      const Vec3d diagonal = minus(piece.at[k], piece.at[l]);
      if (dot(diagonal, diagonal) > dot(longest, longest))
        longest = diagonal;
    }
  const Vec3d centre = piece.centre();
  std::array<double, kMostCorners> heights{};
  for (std::size_t k = 0; k < piece.corners; ++k)
    heights[k] = dot(minus(piece.at[k], centre), longest);
  cut(piece, heights, one, other);
}

// Quarters of a triangle, but for those that another one is near all of.
void addQuarters(const Piece& piece, const NearTriangle& triangle, double limit,
                 std::vector<Piece>& parts) {
  const Vec3d &a = piece.at[0], &b = piece.at[1], &c = piece.at[2];
  const Vec3d ab = times(plus(a, b), 0.5), bc = times(plus(b, c), 0.5), ca = times(plus(c, a), 0.5);
  const auto isOut = [&](const Vec3d& p) { return !(triangle.squaredDistance(p) <= limit); };
  const bool isAbOut = isOut(ab), isBcOut = isOut(bc), isCaOut = isOut(ca);
  if (isAbOut || isBcOut || isCaOut)
    parts.push_back({ab, bc, ca});
  if (isAbOut || isCaOut || isOut(a))
    parts.push_back({a, ab, ca});
  if (isAbOut || isBcOut || isOut(b))
    parts.push_back({ab, b, bc});
  if (isBcOut || isCaOut || isOut(c))
    parts.push_back({ca, bc, c});
}

// Parts of a piece that a triangle is not near all of: what goes over the triangle's edges is cut
// off, so that there are about as many parts as there are triangles below, however large these are
// beside the radius. `reach` is how far from its edges the triangle's neighbourhood reaches.
void addParts(const Piece& piece, const NearTriangle& triangle, double reach, double limit,
              std::vector<Piece>& parts) {
  Piece rest = piece, inner, outer;
  const Vec3d normal = cross(triangle.ab, triangle.ac);
  const std::array<Vec3d, 3> edges{triangle.ab, minus(triangle.ac, triangle.ab),
                                   minus(Vec3d{0, 0, 0}, triangle.ac)};
  bool isCut = false;
  for (std::size_t e = 0; e < 3 && !triangle.thin && rest.corners <= kCutCorners; ++e) {
    const Vec3d out = cross(edges[e], normal);
    const double scale = length(out);
    const Vec3d from = e == 1 ? plus(triangle.a, triangle.ab) : triangle.a;
    std::array<double, kMostCorners> heights{};
    double lowest = reach * scale, highest = 0;
    for (std::size_t k = 0; k < rest.corners; ++k) {
      heights[k] = dot(minus(rest.at[k], from), out) - kCutAt * reach * scale;
      lowest = std::min(lowest, heights[k]);
      highest = std::max(highest, heights[k]);
    }
    if (lowest > 0)
      break; // all of it is beside the triangle
    if (highest <= (kCutFrom - kCutAt) * reach * scale)
      continue;
    cut(rest, heights, inner, outer);
    parts.push_back(outer);
    rest = inner;
    isCut = true;
  }
  if (isCut && isNear(rest, triangle, limit))
    return;
  halve(rest, inner, outer);
  for (const Piece& half : {inner, outer})
    if (!isNear(half, triangle, limit))
      parts.push_back(half);
}

bool containsPiece(const TriangleTree& tree, const Piece& whole, double limit) {
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
  for (std::size_t k = 0; k < whole.corners; ++k)
    box.add(whole.at[k]);
  const TriangleTree::Cut cut(tree, box, std::sqrt(limit));
  for (std::size_t k = 1; k < whole.corners; ++k)
    if (!tree.visit(cut, whole.at[k], limit, [&](std::uint32_t i, double&) {
          return tree.triangle(i).squaredDistance(whole.at[k]) <= limit;
        }))
      return false;

  const double least = limit * Envelope::kSlack * Envelope::kSlack;
  thread_local std::vector<Piece> waiting;
  waiting.assign(1, whole);
  std::size_t looked = 0;
  for (std::size_t oldest = 0; oldest < waiting.size();) {
    if (++looked > kMostPieces)
      return false;
    Piece piece;
    if (waiting.size() - oldest < kWaiting) {
      piece = waiting[oldest++];
    } else {
      piece = waiting.back();
      waiting.pop_back();
    }
    const Vec3d centre = piece.centre();
    // The triangle nearest to the centre, at distance d: if its neighbourhood does not hold the
    // piece, a corner is farther from it than the radius, and d + (centre to corner) exceeds it.
    std::uint32_t nearest = kNone;
    double square = limit;
    const bool isHeld = tree.visit(cut, centre, limit, [&](std::uint32_t i, double& farthest) {
      const NearTriangle& triangle = tree.triangle(i);
      const double here = triangle.squaredDistance(centre);
      if (!(here <= farthest))
        return false;
      farthest = square = here;
      nearest = i;
      return isNear(piece, triangle, limit);
    });
    if (isHeld)
      continue;
    if (nearest == kNone)
      return false;
    double radius = 0;
    for (std::size_t k = 0; k < piece.corners; ++k) {
      const Vec3d out = minus(piece.at[k], centre);
      radius = std::max(radius, dot(out, out));
    }
    if (radius < least)
      return false;
    const NearTriangle& triangle = tree.triangle(nearest);
    if (piece.corners == 3 && radius < kLarge * kLarge * (limit - square))
      addQuarters(piece, triangle, limit, waiting);
    else
      addParts(piece, triangle, std::sqrt(limit - square), limit, waiting);
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

std::vector<std::array<Vec3d, 3>> Envelope::faces() const {
  std::vector<std::array<Vec3d, 3>> faces;
  faces.reserve(impl_->tree.size());
  for (std::uint32_t i = 0; i < impl_->tree.size(); ++i) {
    const NearTriangle& triangle = impl_->tree.triangle(i);
    faces.push_back({triangle.a, plus(triangle.a, triangle.ab), plus(triangle.a, triangle.ac)});
  }
  return faces;
}

bool Envelope::contains(const Vec3d& p, double radius) const {
  const double limit = radius * radius * kSafety;
  const TriangleTree& tree = impl_->tree;
  return tree.visit(p, limit, [&](std::uint32_t i, double&) {
    return tree.triangle(i).squaredDistance(p) <= limit;
  });
}

bool Envelope::contains(const Vec3d& p, const Vec3d& q, double radius) const {
  return containsPiece(impl_->tree, {p, q}, radius * radius * kSafety);
}

bool Envelope::contains(const Vec3d& p, const Vec3d& q, const Vec3d& r, double radius) const {
  return containsPiece(impl_->tree, {p, q, r}, radius * radius * kSafety);
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
