// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/SimplifyPart.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = SoupSurface::kNone;
constexpr std::size_t kMaxFaces = 48; ///< around a point
// Sines of the smallest angle of a face: below the first a face is a sliver, and may only be made
// where there was a worse one; below the second it has no normal worth keeping.
constexpr double kSliver = 0.1;
constexpr double kFlat = 1e-7;
constexpr double kMinCosine = 0.2;  ///< of the angle that a normal may turn by at a collapse
constexpr double kHold = 1e-3;      ///< weight of the edge's midpoint; planes have 1
constexpr double kCoplanar = 0.996; ///< cosine between faces whose edge may be swapped: 5 degrees
constexpr double kBetter = 1.1;     ///< what a swap has to gain
// Points out of a face's box that is enlarged by so many radii are farther from it than a radius,
// in spite of rounding.
constexpr double kBoxReach = 1.001;
constexpr std::size_t kManyTimes = 64; ///< steps between calls of Progress::check()

Vec3d normalOf(const std::array<Vec3d, 3>& at) {
  return cross(minus(at[1], at[0]), minus(at[2], at[0]));
}

// The sine of the smallest angle, which lies between the two longest sides.
double shapeOf(const std::array<Vec3d, 3>& at, const Vec3d& normal) {
  std::array<double, 3> squares;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d edge = minus(at[(k + 1) % 3], at[k]);
    squares[k] = dot(edge, edge);
  }
  const double shortest = std::min({squares[0], squares[1], squares[2]});
  const double product = squares[0] * squares[1] * squares[2];
  return product > 0 ? std::sqrt(dot(normal, normal) * shortest / product) : 0;
}

} // namespace

SimplifyPart::SimplifyPart(SoupSurface& surface, const Envelope& envelope, double radius,
                           Progress& progress)
    : s_(surface), envelope_(envelope), radius_(radius), progress_(progress) {}

void SimplifyPart::run(const std::vector<std::uint32_t>& points) {
  if (points.empty())
    return;
  part_ = s_.part[points[0]];
  std::vector<std::uint32_t> due;
  for (const std::uint32_t v : points)
    if (s_.firstCorner[v] != kNone && s_.isDue[v])
      due.push_back(v);
  for (const std::uint32_t v : due)
    enqueueStar(v, true);
  for (const std::uint32_t v : due)
    s_.isDue[v] = 0;
  Edge last{-1, 0, 0};
  for (std::size_t steps = 0; !queue_.empty(); ++steps) {
    if (steps % kManyTimes == 0)
      progress_.check();
    const Edge edge = queue_.front();
    std::pop_heap(queue_.begin(), queue_.end());
    queue_.pop_back();
    if (edge == last || s_.firstCorner[edge.a] == kNone || s_.firstCorner[edge.b] == kNone ||
        square(edge.a, edge.b) != edge.square)
      continue;
    last = edge;
    tryToCollapse(edge.a, edge.b);
  }
  for (const std::uint32_t v : points)
    if (s_.firstCorner[v] != kNone)
      swapAt(v);
}

double SimplifyPart::square(std::uint32_t a, std::uint32_t b) const {
  const Vec3d edge = minus(s_.points[b], s_.points[a]);
  return dot(edge, edge);
}

void SimplifyPart::enqueue(std::uint32_t a, std::uint32_t b) {
  if (s_.part[a] != part_ || s_.part[b] != part_ || (s_.isFixed[a] && s_.isFixed[b]))
    return;
  queue_.push_back({square(a, b), std::min(a, b), std::max(a, b)});
  std::push_heap(queue_.begin(), queue_.end());
}

// An edge whose two points are both due is put in by one of them.
void SimplifyPart::enqueueStar(std::uint32_t point, bool isNewOnly) {
  s_.findStar(point, kMaxFaces, starA_);
  if (starA_.size() > kMaxFaces)
    return;
  findNeighbours(point, starA_, neighboursA_);
  for (const std::uint32_t other : neighboursA_)
    if (!isNewOnly || point < other || s_.part[other] != part_ || !s_.isDue[other])
      enqueue(point, other);
}

bool SimplifyPart::isWithinPart(const std::vector<std::uint32_t>& star) const {
  for (const std::uint32_t face : star)
    for (const std::uint32_t v : s_.faces[face])
      if (s_.part[v] != part_)
        return false;
  return true;
}

void SimplifyPart::findNeighbours(std::uint32_t point, const std::vector<std::uint32_t>& star,
                                  std::vector<std::uint32_t>& neighbours) const {
  neighbours.clear();
  for (const std::uint32_t face : star)
    for (const std::uint32_t v : s_.faces[face])
      if (v != point && std::find(neighbours.begin(), neighbours.end(), v) == neighbours.end())
        neighbours.push_back(v);
}

void SimplifyPart::tryToCollapse(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t keep = s_.isFixed[b] ? b : a, gone = s_.isFixed[b] ? a : b;
  s_.findStar(keep, kMaxFaces, starA_);
  s_.findStar(gone, kMaxFaces, starB_);
  if (starA_.size() > kMaxFaces || starB_.size() > kMaxFaces)
    return;
  if (!isWithinPart(starA_) || !isWithinPart(starB_)) {
    s_.isDue[a] = s_.isDue[b] = 1; // where borders have moved
    return;
  }
  if (!keepsTopology(keep, gone))
    return;
  newFaces_.clear();
  worstShape_ = 1;
  const bool keepMoves = !s_.isFixed[keep];
  addNewFaces(gone, starB_, keep);
  if (keepMoves)
    addNewFaces(keep, starA_, gone);
  carried_.clear();
  // What is most likely lost comes first.
  for (const std::uint32_t v : {keep, gone})
    if (!s_.isCarried[v] && (v == gone || keepMoves))
      carried_.push_back(v);
  for (const std::uint32_t face : shared_)
    addCarried(face);
  for (const NewFace& changed : newFaces_)
    addCarried(changed.face);

  Vec3d place = s_.points[keep];
  if (keepMoves)
    place = bestPlace(times(plus(place, s_.points[gone]), 0.5));
  if (isGoodAt(place) && keepsCarried() && isInEnvelope(keep, gone, place))
    collapse(keep, gone, place);
}

// The link condition of Dey, Edelsbrunner, Guha and Nekhayev (Topology preserving edge contraction,
// 1999), and no face over the points of another.
bool SimplifyPart::keepsTopology(std::uint32_t keep, std::uint32_t gone) {
  shared_.clear();
  for (const std::uint32_t face : starB_)
    if (std::find(starA_.begin(), starA_.end(), face) != starA_.end())
      shared_.push_back(face);
  if (shared_.size() != 2 || s_.inputOf(shared_[0]) != s_.inputOf(shared_[1]))
    return false;
  findNeighbours(keep, starA_, neighboursA_);
  findNeighbours(gone, starB_, neighboursB_);
  std::size_t common = 0;
  for (const std::uint32_t v : neighboursB_)
    common += std::find(neighboursA_.begin(), neighboursA_.end(), v) != neighboursA_.end();
  if (common != 2)
    return false;
  std::array<std::uint32_t, 2> wings{};
  for (std::size_t i = 0; i < 2; ++i)
    for (const std::uint32_t v : s_.faces[shared_[i]])
      if (v != keep && v != gone)
        wings[i] = v;
  // A face of the removed point over both wings would come to lie on one that stays.
  const auto hasWings = [&](std::uint32_t face) {
    const auto& f = s_.faces[face];
    return std::find(f.begin(), f.end(), wings[0]) != f.end() &&
           std::find(f.begin(), f.end(), wings[1]) != f.end();
  };
  return wings[0] != wings[1] && !(std::any_of(starA_.begin(), starA_.end(), hasWings) &&
                                   std::any_of(starB_.begin(), starB_.end(), hasWings));
}

void SimplifyPart::addNewFaces(std::uint32_t point, const std::vector<std::uint32_t>& star,
                               std::uint32_t other) {
  for (const std::uint32_t face : star) {
    const auto& f = s_.faces[face];
    NewFace changed;
    changed.face = face;
    changed.moving = 0;
    changed.depth = 0;
    bool isShared = false;
    for (std::size_t k = 0; k < 3; ++k) {
      changed.at[k] = s_.points[f[k]];
      if (f[k] == point)
        changed.moving = k;
      isShared = isShared || f[k] == other;
    }
    changed.normal = normalOf(changed.at);
    changed.shape = shapeOf(changed.at, changed.normal);
    worstShape_ = std::min(worstShape_, changed.shape);
    if (!isShared)
      newFaces_.push_back(changed);
  }
}

// Minimizes the sum of squared distances to the faces' planes, weighted by squared areas (Garland
// and Heckbert, Surface Simplification Using Quadric Error Metrics, 1997), of the faces as they are
// now (Lindstrom and Turk, Fast and Memory Efficient Polygonal Simplification, 1998). Where the
// planes leave it open, near the midpoint.
Vec3d SimplifyPart::bestPlace(const Vec3d& midpoint) const {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3d sum{0, 0, 0};
  double scale = 0;
  for (const NewFace& changed : newFaces_)
    scale = std::max(scale, dot(changed.normal, changed.normal));
  if (!(scale > 0))
    return roundToGrain(midpoint, s_.grain);
  for (const NewFace& changed : newFaces_) {
    const Vec3d n = times(changed.normal, 1 / std::sqrt(scale));
    const double height = dot(n, minus(changed.at[0], midpoint));
    xx += n[0] * n[0];
    xy += n[0] * n[1];
    xz += n[0] * n[2];
    yy += n[1] * n[1];
    yz += n[1] * n[2];
    zz += n[2] * n[2];
    sum = plus(sum, times(n, height));
  }
  const double hold = kHold * (xx + yy + zz);
  xx += hold;
  yy += hold;
  zz += hold;
  // Cramer's rule: the matrix is symmetric, and far enough from singular.
  const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
  const double determinant = xx * a + xy * b + xz * c;
  const Vec3d step{
      (a * sum[0] + b * sum[1] + c * sum[2]) / determinant,
      (b * sum[0] + (xx * zz - xz * xz) * sum[1] + (xy * xz - xx * yz) * sum[2]) / determinant,
      (c * sum[0] + (xy * xz - xx * yz) * sum[1] + (xx * yy - xy * xy) * sum[2]) / determinant};
  return roundToGrain(plus(midpoint, step), s_.grain);
}

void SimplifyPart::addCarried(std::uint32_t face) {
  for (std::uint32_t p = s_.firstCarried[face]; p != kNone; p = s_.nextCarried[p]) {
    carried_.push_back(p);
    __builtin_prefetch(&s_.carried[p]); // for keepsCarried(): points are far apart in memory
  }
}

// Moves the corner there. Whether the new faces' shapes and normals allow it.
bool SimplifyPart::isGoodAt(const Vec3d& to) {
  const double minShape = std::min(kSliver, worstShape_);
  for (NewFace& changed : newFaces_) {
    changed.at[changed.moving] = to;
    const Vec3d normal = normalOf(changed.at);
    if (!(shapeOf(changed.at, normal) >= minShape) || !(dot(normal, normal) > 0))
      return false;
    if (changed.shape > kFlat &&
        !(dot(normal, changed.normal) > kMinCosine * length(normal) * length(changed.normal)))
      return false;
  }
  return !newFaces_.empty();
}

// Whether every carried point is near one of the new faces; finds the nearest.
bool SimplifyPart::keepsCarried() {
  triangles_.clear();
  nearBoxes_.clear();
  const Vec3d reach{kBoxReach * radius_, kBoxReach * radius_, kBoxReach * radius_};
  for (const NewFace& changed : newFaces_) {
    triangles_.emplace_back(changed.at[0], changed.at[1], changed.at[2], changed.face);
    Box box;
    for (const Vec3d& corner : changed.at)
      box.add(corner);
    nearBoxes_.push_back({minus(box.low, reach), plus(box.high, reach)});
  }
  nearestOf_.clear();
  for (const std::uint32_t p : carried_) {
    const Vec3d& at = s_.carried[p];
    double minSquared = std::numeric_limits<double>::infinity();
    std::uint32_t nearest = kNone;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const Box& box = nearBoxes_[i];
      int isIn = 1; // without jumps
      for (std::size_t k = 0; k < 3; ++k)
        isIn &= int(at[k] >= box.low[k]) & int(at[k] <= box.high[k]);
      if (isIn == 0)
        continue;
      const double distance = triangles_[i].squaredDistance(at);
      if (distance < minSquared) {
        minSquared = distance;
        nearest = triangles_[i].face;
      }
    }
    if (!(minSquared <= radius_ * radius_))
      return false;
    nearestOf_.push_back(nearest);
  }
  return true;
}

// Whether the new faces are in the envelope, and how far in. Queries of the envelope take most of
// the time; where surfaces are flat, the old faces' depths suffice.
bool SimplifyPart::isInEnvelope(std::uint32_t keep, std::uint32_t gone, const Vec3d& to) {
  const bool keepMoves = !s_.isFixed[keep];
  // The moved point has a number of its own: its edges may cross those of both points.
  const std::uint32_t moved = keepMoves ? kNone : keep;
  Vec3d direction{0, 0, 0};
  before_.clear();
  after_.clear();
  const auto addOld = [&](std::uint32_t face, std::uint32_t first) {
    const auto& f = s_.faces[face];
    const auto k = static_cast<std::size_t>(std::find(f.begin(), f.end(), first) - f.begin());
    const std::array<std::uint32_t, 3> numbers{f[k], f[(k + 1) % 3], f[(k + 2) % 3]};
    before_.faces.push_back({{s_.points[numbers[0]], s_.points[numbers[1]], s_.points[numbers[2]]},
                             numbers,
                             s_.depth[face]});
    direction = plus(direction, normalOf(before_.faces.back().at));
  };
  for (const std::uint32_t face : starB_)
    addOld(face, gone);
  for (const std::uint32_t face : starA_)
    if (keepMoves && std::find(shared_.begin(), shared_.end(), face) == shared_.end())
      addOld(face, keep);
  for (const NewFace& changed : newFaces_) {
    const std::size_t k = changed.moving;
    const auto& f = s_.faces[changed.face];
    after_.faces.push_back({{changed.at[k], changed.at[(k + 1) % 3], changed.at[(k + 2) % 3]},
                            {moved, f[(k + 1) % 3], f[(k + 2) % 3]},
                            0});
  }
  before_.points.push_back(s_.points[gone]);
  for (const std::uint32_t v : neighboursB_)
    before_.edges.push_back({s_.points[gone], s_.points[v], gone, v});
  if (keepMoves) {
    before_.points.push_back(s_.points[keep]);
    after_.points.push_back(to);
    for (const std::uint32_t v : neighboursA_)
      if (v != gone)
        before_.edges.push_back({s_.points[keep], s_.points[v], keep, v});
  }
  return goRoundOnce(keepMoves ? after_ : before_, direction) ? asksEnvelope(direction)
                                                              : asksEnvelope({0, 0, 0});
}

bool SimplifyPart::asksEnvelope(const Vec3d& direction) {
  gap_.findDepths(before_, after_, direction);
  for (std::size_t i = 0; i < newFaces_.size(); ++i) {
    const auto& [a, b, c] = newFaces_[i].at;
    newFaces_[i].depth = after_.faces[i].depth;
    if (newFaces_[i].depth <= radius_)
      continue;
    newFaces_[i].depth = envelope_.depth(a, b, c, radius_);
    if (!(newFaces_[i].depth <= radius_))
      return false;
  }
  return true;
}

// Gives the new faces their depths, and the carried points of the old ones.
void SimplifyPart::dealOut() {
  for (const NewFace& changed : newFaces_) {
    s_.firstCarried[changed.face] = kNone;
    s_.depth[changed.face] = changed.depth;
  }
  for (std::size_t i = 0; i < carried_.size(); ++i)
    s_.carry(nearestOf_[i], carried_[i]);
}

void SimplifyPart::collapse(std::uint32_t keep, std::uint32_t gone, const Vec3d& to) {
  ++counts_.collapses;
  for (const std::uint32_t face : shared_) {
    s_.faces[face] = {kNone, kNone, kNone};
    s_.firstCarried[face] = kNone;
  }
  s_.firstCorner[gone] = kNone;
  for (const std::uint32_t face : starB_) {
    if (s_.isGone(face))
      continue;
    for (std::uint32_t k = 0; k < 3; ++k)
      if (s_.faces[face][k] == gone) {
        s_.faces[face][k] = keep;
        s_.link(keep, 3 * face + k);
      }
  }
  s_.points[keep] = to;
  dealOut();
  enqueueStar(keep, false);
  for (const std::uint32_t v : neighboursA_)
    s_.isDue[v] = 1;
}

void SimplifyPart::swapAt(std::uint32_t point) {
  s_.findStar(point, kMaxFaces, starA_);
  if (starA_.size() > kMaxFaces)
    return;
  for (const std::uint32_t face : std::vector<std::uint32_t>(starA_))
    for (std::size_t k = 0; k < 3; ++k)
      if (s_.faces[face][k] == point && tryToSwap(face, k))
        break;
}

// The edge from the corner to the next, if exactly two faces of one input have it, whose four
// points are of the part.
bool SimplifyPart::findSwap(std::uint32_t face, std::size_t corner, Swap& swap) {
  swap.a = s_.faces[face][corner];
  swap.b = s_.faces[face][(corner + 1) % 3];
  swap.c = s_.faces[face][(corner + 2) % 3];
  swap.d = kNone;
  s_.findStar(swap.a, kMaxFaces, starB_);
  std::size_t count = 0;
  for (const std::uint32_t other : starB_) {
    const auto& f = s_.faces[other];
    const auto at = static_cast<std::size_t>(std::find(f.begin(), f.end(), swap.b) - f.begin());
    if (at == 3)
      continue;
    ++count;
    if (other != face && f[(at + 1) % 3] == swap.a) {
      swap.across = other;
      swap.cornerAcross = (at + 1) % 3;
      swap.d = f[(at + 2) % 3];
    }
  }
  if (count != 2 || swap.d == kNone || swap.c == swap.d ||
      s_.inputOf(face) != s_.inputOf(swap.across))
    return false;
  for (const std::uint32_t v : {swap.a, swap.b, swap.c, swap.d})
    if (s_.part[v] != part_)
      return false;
  return true;
}

// Whether c and d may be joined: the faces get better, all four are almost coplanar, and there is
// no edge between c and d yet.
bool SimplifyPart::isGoodSwap(const Swap& swap, const FacePair& before, const FacePair& after,
                              std::array<Vec3d, 2>& old) {
  std::array<Vec3d, 2> made;
  double worstOld = 1, worstMade = 1;
  for (std::size_t i = 0; i < 2; ++i) {
    old[i] = normalOf(before[i]);
    made[i] = normalOf(after[i]);
    worstOld = std::min(worstOld, shapeOf(before[i], old[i]));
    worstMade = std::min(worstMade, shapeOf(after[i], made[i]));
  }
  if (!(worstMade > kBetter * worstOld) || !(worstMade > kFlat))
    return false;
  const auto areCoplanar = [](const Vec3d& u, const Vec3d& v) {
    return dot(u, v) >= kCoplanar * length(u) * length(v);
  };
  // Faces without area are coplanar with all.
  if (!areCoplanar(old[0], old[1]) || !areCoplanar(made[0], made[1]) ||
      !areCoplanar(plus(old[0], old[1]), made[0]))
    return false;
  s_.findStar(swap.c, kMaxFaces, starB_);
  findNeighbours(swap.c, starB_, neighboursB_);
  return starB_.size() <= kMaxFaces &&
         std::find(neighboursB_.begin(), neighboursB_.end(), swap.d) == neighboursB_.end();
}

bool SimplifyPart::tryToSwap(std::uint32_t face, std::size_t corner) {
  Swap swap{};
  if (!findSwap(face, corner, swap))
    return false;
  const auto [a, b, c, d, across, cornerAcross] = swap;
  const Vec3d &pa = s_.points[a], &pb = s_.points[b], &pc = s_.points[c], &pd = s_.points[d];
  const FacePair before{{{pa, pb, pc}, {pb, pa, pd}}}, after{{{pa, pd, pc}, {pb, pc, pd}}};
  std::array<Vec3d, 2> old;
  if (!isGoodSwap(swap, before, after, old))
    return false;
  newFaces_.clear();
  carried_.clear();
  for (std::size_t i = 0; i < 2; ++i) {
    const std::uint32_t number = i == 0 ? face : across;
    newFaces_.push_back({number, after[i], old[i], 0, 0, 0});
    addCarried(number);
  }
  before_.clear();
  after_.clear();
  before_.faces.push_back({before[0], {a, b, c}, s_.depth[face]});
  before_.faces.push_back({before[1], {b, a, d}, s_.depth[across]});
  after_.faces.push_back({after[0], {a, d, c}, 0});
  after_.faces.push_back({after[1], {b, c, d}, 0});
  before_.edges.push_back({pa, pb, a, b});
  if (!keepsCarried() || !asksEnvelope(plus(old[0], old[1])))
    return false;
  const auto moveCorner = [&](std::uint32_t of, std::size_t k, std::uint32_t to) {
    const auto number = static_cast<std::uint32_t>(3 * of + k);
    s_.unlink(s_.faces[of][k], number);
    s_.faces[of][k] = to;
    s_.link(to, number);
  };
  moveCorner(face, (corner + 1) % 3, d);
  moveCorner(across, cornerAcross, c);
  dealOut();
  ++counts_.swaps;
  for (const std::uint32_t v : {a, b, c, d})
    s_.isDue[v] = 1;
  return true;
}

} // namespace tetvdb
