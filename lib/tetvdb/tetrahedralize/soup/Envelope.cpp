// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/Envelope.h"

#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/tetrahedralize/soup/InputSheets.h"
#include "tetvdb/tetrahedralize/soup/TriangleTree.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace tetvdb {
namespace {

// Distances are off by the rounding of coordinates, 2^-53 of the lattice's 2^37 or so.
constexpr double kSafety = 1 - 2e-12;
constexpr std::uint32_t kNone = 0xFFFFFFFFu;
// Triangles near a corner that the other corners are tested against. Where there are more, they are
// small against the radius, and it is unlikely that all corners are near one of them.
constexpr int kTries = 8;
// Up to so many polygons wait in the order of their size, so that one that is out is found early.
// Of more the newest comes first, so that memory stays small.
constexpr std::size_t kWaiting = 512;
// Some ten milliseconds. A candidate in the wedge between two distant triangles is cut into
// (1 / kSlack)^2 polygons and more. A candidate over that many triangles is refused.
constexpr std::size_t kMaxPolygons = 20000;

// Corners of a polygon, and of one that is cut: a cut adds one corner, and three where rounding
// makes the polygon change sides six times.
constexpr std::size_t kMaxCorners = 9;
constexpr std::size_t kCutCorners = 6;
// How far from a triangle's edges polygons are cut, and how far a polygon has to go beyond them to
// be cut; shares of how far the triangle's neighbourhood reaches there. As the second is larger, no
// slivers are cut off.
constexpr double kCutAt = 0.6, kCutFrom = 0.95;

// Polygons larger than that, against what the neighbourhood reaches, are cut along its edges;
// others are quartered, which is quicker.
constexpr double kLarge = 3;

// A part of a candidate; a segment has 2 corners.
struct ConvexPolygon {
  std::array<Vec3d, kMaxCorners> at;
  std::size_t corners;

  ConvexPolygon() = default;
  ConvexPolygon(std::initializer_list<Vec3d> points) : corners(points.size()) {
    std::copy(points.begin(), points.end(), at.begin());
  }
  ConvexPolygon(const ConvexPolygon& other) : corners(other.corners) {
    std::copy(other.at.begin(), other.at.begin() + corners, at.begin());
  }
  ConvexPolygon& operator=(const ConvexPolygon& other) {
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

// Whether one triangle is near all corners: its neighbourhood is convex, so that all of the polygon
// is near it.
bool isNear(const ConvexPolygon& polygon, const NearTriangle& triangle, double limit) {
  for (std::size_t k = 0; k < polygon.corners; ++k)
    if (!(triangle.squaredDistance(polygon.at[k]) <= limit))
      return false;
  return true;
}

// Cuts a polygon where the heights of its corners change their sign.
void cut(const ConvexPolygon& polygon, const std::array<double, kMaxCorners>& heights,
         ConvexPolygon& below, ConvexPolygon& above) {
  below.corners = above.corners = 0;
  for (std::size_t k = 0; k < polygon.corners; ++k) {
    const std::size_t next = k + 1 < polygon.corners ? k + 1 : 0;
    (heights[k] > 0 ? above : below).add(polygon.at[k]);
    if ((heights[k] > 0) == (heights[next] > 0) || (polygon.corners == 2 && next == 0))
      continue;
    const double share = heights[k] / (heights[k] - heights[next]);
    const Vec3d between = plus(polygon.at[k], times(minus(polygon.at[next], polygon.at[k]), share));
    below.add(between);
    above.add(between);
  }
}

// Across its longest diagonal; a polygon of many corners along one that halves their number.
void halve(const ConvexPolygon& polygon, ConvexPolygon& one, ConvexPolygon& other) {
  if (polygon.corners > kCutCorners) {
    const std::size_t median = polygon.corners / 2;
    one.corners = other.corners = 0;
    for (std::size_t k = 0; k <= median; ++k)
      one.add(polygon.at[k]);
    for (std::size_t k = median; k < polygon.corners; ++k)
      other.add(polygon.at[k]);
    other.add(polygon.at[0]);
    return;
  }
  Vec3d longest{0, 0, 0};
  for (std::size_t k = 0; k < polygon.corners; ++k)
    for (std::size_t l = 0; l < k; ++l) {
      const Vec3d diagonal = minus(polygon.at[k], polygon.at[l]);
      if (dot(diagonal, diagonal) > dot(longest, longest))
        longest = diagonal;
    }
  const Vec3d centre = polygon.centre();
  std::array<double, kMaxCorners> heights{};
  for (std::size_t k = 0; k < polygon.corners; ++k)
    heights[k] = dot(minus(polygon.at[k], centre), longest);
  cut(polygon, heights, one, other);
}

// Adds a triangle's quarters, without those that `triangle` is near all of.
void addQuarters(const ConvexPolygon& polygon, const NearTriangle& triangle, double limit,
                 std::vector<ConvexPolygon>& parts) {
  const Vec3d &a = polygon.at[0], &b = polygon.at[1], &c = polygon.at[2];
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

// Adds the parts of a polygon that `triangle` is not near all of. What goes beyond the triangle's
// edges is cut off, so that there are about as many parts as triangles below, however large these
// are against the radius. `reach` is how far from its edges the triangle's neighbourhood reaches.
void addParts(const ConvexPolygon& polygon, const NearTriangle& triangle, double reach,
              double limit, std::vector<ConvexPolygon>& parts) {
  ConvexPolygon rest = polygon, inner, outer;
  const Vec3d normal = cross(triangle.ab, triangle.ac);
  const std::array<Vec3d, 3> edges{triangle.ab, minus(triangle.ac, triangle.ab),
                                   minus(Vec3d{0, 0, 0}, triangle.ac)};
  bool isCut = false;
  for (std::size_t e = 0; e < 3 && !triangle.thin && rest.corners <= kCutCorners; ++e) {
    const Vec3d out = cross(edges[e], normal);
    const double scale = length(out);
    const Vec3d from = e == 1 ? plus(triangle.a, triangle.ab) : triangle.a;
    std::array<double, kMaxCorners> heights{};
    double lowest = reach * scale, highest = 0;
    for (std::size_t k = 0; k < rest.corners; ++k) {
      heights[k] = dot(minus(rest.at[k], from), out) - kCutAt * reach * scale;
      lowest = std::min(lowest, heights[k]);
      highest = std::max(highest, heights[k]);
    }
    if (lowest > 0)
      break; // none of it is over the triangle
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
  for (const ConvexPolygon& half : {inner, outer})
    if (!isNear(half, triangle, limit))
      parts.push_back(half);
}

// How much of a polygon is near one or a few triangles.
enum class Nearness { None, Some, All };

// Whether a triangle that is near the first corner is near all of the polygon. None: no triangle is
// near that corner; Some: it is not known.
Nearness nearnessOf(const TriangleTree& tree, const ConvexPolygon& polygon, double limit) {
  int tries = 0;
  Nearness found = Nearness::None;
  tree.visit(polygon.at[0], limit, [&](std::uint32_t i, double&) {
    const NearTriangle& triangle = tree.triangle(i);
    if (!(triangle.squaredDistance(polygon.at[0]) <= limit))
      return false;
    found = isNear(polygon, triangle, limit) ? Nearness::All : Nearness::Some;
    return found == Nearness::All || ++tries == kTries;
  });
  return found;
}

// Decides about a polygon at its centre. All: a triangle's neighbourhood holds it. None: it is out,
// or too small to be cut further. Some: it is cut, and its parts are added to `waiting`.
Nearness cutAtCentre(const TriangleTree& tree, const TriangleTree::Cut& cut,
                     const ConvexPolygon& polygon, double limit,
                     std::vector<ConvexPolygon>& waiting) {
  const Vec3d centre = polygon.centre();
  // The triangle nearest to the centre, at distance d: if its neighbourhood does not hold the
  // polygon, a corner is farther from it than the radius, and d + (centre to corner) exceeds it.
  std::uint32_t nearest = kNone;
  double square = limit;
  const bool isHeld = tree.visit(cut, centre, limit, [&](std::uint32_t i, double& farthest) {
    const NearTriangle& triangle = tree.triangle(i);
    const double here = triangle.squaredDistance(centre);
    if (!(here <= farthest))
      return false;
    farthest = square = here;
    nearest = i;
    return isNear(polygon, triangle, limit);
  });
  if (isHeld)
    return Nearness::All;
  if (nearest == kNone)
    return Nearness::None;
  double radius = 0; // squared
  for (std::size_t k = 0; k < polygon.corners; ++k) {
    const Vec3d out = minus(polygon.at[k], centre);
    radius = std::max(radius, dot(out, out));
  }
  if (radius < limit * Envelope::kSlack * Envelope::kSlack)
    return Nearness::None;
  const NearTriangle& triangle = tree.triangle(nearest);
  if (polygon.corners == 3 && radius < kLarge * kLarge * (limit - square))
    addQuarters(polygon, triangle, limit, waiting);
  else
    addParts(polygon, triangle, std::sqrt(limit - square), limit, waiting);
  return Nearness::Some;
}

bool containsPolygon(const TriangleTree& tree, const ConvexPolygon& whole, double limit) {
  const Nearness first = nearnessOf(tree, whole, limit);
  if (first != Nearness::Some)
    return first == Nearness::All;
  Box box;
  for (std::size_t k = 0; k < whole.corners; ++k)
    box.add(whole.at[k]);
  const TriangleTree::Cut cut(tree, box, std::sqrt(limit));
  for (std::size_t k = 1; k < whole.corners; ++k)
    if (!tree.visit(cut, whole.at[k], limit, [&](std::uint32_t i, double&) {
          return tree.triangle(i).squaredDistance(whole.at[k]) <= limit;
        }))
      return false;

  thread_local std::vector<ConvexPolygon> waiting;
  waiting.assign(1, whole);
  std::size_t visited = 0;
  for (std::size_t oldest = 0; oldest < waiting.size();) {
    if (++visited > kMaxPolygons)
      return false;
    ConvexPolygon polygon;
    if (waiting.size() - oldest < kWaiting) {
      polygon = waiting[oldest++];
    } else {
      polygon = waiting.back();
      waiting.pop_back();
    }
    if (cutAtCentre(tree, cut, polygon, limit, waiting) == Nearness::None)
      return false;
  }
  return true;
}

} // namespace

struct Envelope::Impl {
  TriangleTree tree;
  InputSheets sheets;
  double epsilon;

  Impl(const std::vector<Vec3d>& points, const std::vector<std::array<std::uint32_t, 3>>& faces,
       double farthest)
      : tree(points, faces), sheets(tree, faces, points.size()), epsilon(farthest) {}

  bool contains(const Vec3d& p, double limit) const {
    return tree.visit(p, limit, [&](std::uint32_t i, double&) {
      return tree.triangle(i).squaredDistance(p) <= limit;
    });
  }
  /// As Envelope::depth(); a bound below `enough` is not improved.
  double depth(const Vec3d& p, const Vec3d& q, const Vec3d& r, double radius, double enough) const;
};

Envelope::Envelope(const std::vector<Vec3d>& points,
                   const std::vector<std::array<std::uint32_t, 3>>& faces, double epsilon)
    : impl_(new Impl(points, faces, epsilon)) {}

Envelope::~Envelope() = default;

double Envelope::epsilon() const {
  return impl_->epsilon;
}

bool Envelope::empty() const {
  return impl_->tree.empty();
}

std::vector<std::array<Vec3d, 3>> Envelope::faces() const {
  std::vector<std::array<Vec3d, 3>> faces(impl_->tree.size());
  forEachIndex(faces.size(), [&](std::size_t i) {
    const NearTriangle& triangle = impl_->tree.triangle(static_cast<std::uint32_t>(i));
    faces[i] = {triangle.a, plus(triangle.a, triangle.ab), plus(triangle.a, triangle.ac)};
  });
  return faces;
}

bool Envelope::contains(const Vec3d& p, double radius) const {
  return impl_->contains(p, radius * radius * kSafety);
}

bool Envelope::contains(const Vec3d& p, const Vec3d& q, double radius) const {
  return containsPolygon(impl_->tree, {p, q}, radius * radius * kSafety);
}

bool Envelope::contains(const Vec3d& p, const Vec3d& q, const Vec3d& r, double radius) const {
  return impl_->depth(p, q, r, radius, radius) <= radius;
}

double Envelope::depth(const Vec3d& p, const Vec3d& q, const Vec3d& r, double radius) const {
  return impl_->depth(p, q, r, radius, 0);
}

// Most candidates are over a sheet of triangles, and near it everywhere; others are cut.
double Envelope::Impl::depth(const Vec3d& p, const Vec3d& q, const Vec3d& r, double radius,
                             double enough) const {
  const double limit = radius * radius * kSafety, most = std::sqrt(limit);
  const Vec3d centre = times(plus(plus(p, q), r), 1.0 / 3);
  std::uint32_t nearest = kNone;
  tree.visit(centre, limit, [&](std::uint32_t i, double& farthest) {
    const double here = tree.triangle(i).squaredDistance(centre);
    if (here <= farthest) {
      farthest = here;
      nearest = i;
    }
    return false;
  });
  if (nearest == kNone)
    return std::numeric_limits<double>::infinity();
  const NearTriangle& triangle = tree.triangle(nearest);
  const double farthest = std::max(
      {triangle.squaredDistance(p), triangle.squaredDistance(q), triangle.squaredDistance(r)});
  if (farthest <= limit)
    return std::sqrt(farthest);
  const InputSheets::Gap gap = sheets.gap(p, q, r, nearest, most, std::min(most, enough));
  if (gap.bound <= radius)
    return gap.bound;
  if (gap.isFar && !contains(gap.far, limit))
    return std::numeric_limits<double>::infinity();
  return containsPolygon(tree, {p, q, r}, limit) ? radius : std::numeric_limits<double>::infinity();
}

Envelope::Nearest Envelope::nearest(const Vec3d& p) const {
  // Near neighbours first by what is quick, then by distances that tie across shared edges.
  constexpr double kFarthest = 1e300, kAbout = 1 + 1e-9;
  const TriangleTree& tree = impl_->tree;
  Nearest best;
  double minSquared = kFarthest;
  tree.visit(p, kFarthest, [&](std::uint32_t i, double& limit) {
    const NearTriangle& triangle = tree.triangle(i);
    if (triangle.squaredDistance(p) > limit)
      return false;
    const Vec3d a = minus(triangle.a, p);
    const NearestOffset to = nearestOnTriangle(a, plus(a, triangle.ab), plus(a, triangle.ac));
    if (to.squared < minSquared || (to.squared == minSquared && triangle.face < best.face)) {
      minSquared = to.squared;
      limit = minSquared * kAbout;
      best.point = plus(p, to.offset);
      best.face = triangle.face;
    }
    return false;
  });
  best.distance = std::sqrt(minSquared);
  return best;
}

} // namespace tetvdb
