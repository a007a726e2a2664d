// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/insertion/EdgeInserter.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = TetComplex::kNone;
constexpr std::size_t kMaxSteps = 50000; // along one edge: no model came near it
constexpr std::size_t kHub = 100;        // tets around a point that make its star slow to visit
constexpr int kMaxSwaps = 100;           // along one edge
constexpr double kNotFlat = 100;         // tolerances: a higher tet can be cut many times

// The point of segment a-b nearest to p, strictly between a and b.
Vec3d nearestWithin(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
  const Vec3d along = minus(b, a);
  const double s = dot(minus(p, a), along) / dot(along, along);
  return roundToLattice(plus(a, times(along, std::clamp(s, 1e-6, 1 - 1e-6))));
}

} // namespace

std::array<std::uint32_t, 3> sortedCorners(std::array<std::uint32_t, 3> face) {
  std::sort(face.begin(), face.end());
  return face;
}

std::vector<std::uint32_t> InsertedPaths::refined(const std::vector<std::uint32_t>& path) const {
  std::vector<std::uint32_t> whole{path.front()};
  std::vector<std::uint32_t> ahead(path.rbegin(), path.rend() - 1); // the next point last
  while (!ahead.empty()) {
    const auto midpoint = midpoints.find(edgeKey(whole.back(), ahead.back()));
    if (midpoint != midpoints.end()) {
      ahead.push_back(midpoint->second);
    } else {
      whole.push_back(ahead.back());
      ahead.pop_back();
    }
  }
  return whole;
}

std::vector<std::uint32_t> InsertedPaths::path(std::uint32_t a, std::uint32_t b) const {
  const auto found = paths.find(edgeKey(a, b));
  if (found == paths.end())
    return {};
  std::vector<std::uint32_t> whole = refined(found->second);
  if (whole.front() != a)
    std::reverse(whole.begin(), whole.end());
  return whole;
}

// The line of an edge of the input, from `from` on.
struct EdgeInserter::Segment {
  Vec3d from, along; // of length 1
  double whole;      // length

  Segment(const Vec3d& a, const Vec3d& b) : from(a), along(minus(b, a)), whole(length(along)) {
    if (whole > 0)
      along = times(along, 1 / whole);
  }
  double at(const Vec3d& p) const { return dot(minus(p, from), along); }
  double squaredDistance(const Vec3d& p) const {
    const Vec3d offset = minus(p, from);
    const Vec3d aside = minus(offset, times(along, dot(offset, along)));
    return dot(aside, aside);
  }
};

void EdgeInserter::begin() {
  facePoints_.clear();
  effort_ = 0;
  maySwap_ = true;
}

void EdgeInserter::spend(std::size_t tets) {
  effort_ += tets;
  if (effort_ > maxEffort_)
    throw InsertStop{InsertResult::Failed};
}

void EdgeInserter::insert(std::uint32_t a, std::uint32_t b) {
  if (a > b)
    std::swap(a, b);
  if (known_.paths.count(edgeKey(a, b)) != 0)
    return;
  // Two parts that share an edge would each make a path of their own.
  if (complex_.points[a].fixed && complex_.points[b].fixed)
    throw InsertStop{InsertResult::Elsewhere};
  swaps_ = 0;
  // Away from hubs: every step visits all tets around a point.
  const bool turn = complex_.hasMoreTets(a, kHub) && !complex_.hasMoreTets(b, kHub);
  const std::uint32_t from = turn ? b : a, to = turn ? a : b;
  std::vector<std::uint32_t> made{from};
  for (std::size_t step = 0; made.back() != to; ++step) {
    if (step > kMaxSteps)
      throw InsertStop{InsertResult::Failed};
    made.push_back(next(made.back(), from, to));
  }
  if (turn)
    std::reverse(made.begin(), made.end());
  known_.paths.emplace(edgeKey(a, b), std::move(made));
}

std::uint32_t EdgeInserter::next(std::uint32_t from, std::uint32_t a, std::uint32_t b) {
  const Segment segment(complex_.at(a), complex_.at(b));
  complex_.star(from, tets_);
  spend(tets_.size());
  const Step step = stepAlongEdge(from, b, segment);
  return step.next != kNone ? step.next : stepThroughFace(from, a, b, segment, step.detour);
}

// The shortest edge whose other point is within tolerance, so that no point is passed by.
EdgeInserter::Step EdgeInserter::stepAlongEdge(std::uint32_t from, std::uint32_t to,
                                               const Segment& segment) const {
  const double now = segment.at(complex_.at(from));
  Step step{kNone, kNone};
  bool isNeighbour = false;
  double nearest = segment.whole, minSquared = reach_ * reach_;
  for (const std::uint32_t t : tets_)
    for (const std::uint32_t q : complex_.tets[t].corners) {
      if (q == to) {
        isNeighbour = true;
        continue;
      }
      const double s = segment.at(complex_.at(q));
      if (s <= now || s >= segment.whole)
        continue;
      const double squared = segment.squaredDistance(complex_.at(q));
      if (squared <= tolerance_ * tolerance_ && s < nearest) {
        step.next = q;
        nearest = s;
      }
      if (squared < minSquared) {
        step.detour = q;
        minSquared = squared;
      }
    }
  if (step.next == kNone && isNeighbour)
    step.next = to;
  return step;
}

// Through the face of the star that the segment leaves by.
std::uint32_t EdgeInserter::stepThroughFace(std::uint32_t from, std::uint32_t a, std::uint32_t b,
                                            const Segment& segment, std::uint32_t detour) {
  const Vec3d here = complex_.at(from), target = complex_.at(b);
  for (const std::uint32_t t : tets_) {
    const TetComplex::Tet& tet = complex_.tets[t];
    const unsigned localFace = tet.cornerOf(from);
    Face face;
    for (unsigned i = 0; i < 3; ++i)
      face[i] = tet.corners[kFaceCorners[localFace][i]];
    const Vec3d p = complex_.at(face[0]), q = complex_.at(face[1]), r = complex_.at(face[2]);
    if (latticeOrientation(here, p, q, target) < 0 || latticeOrientation(here, q, r, target) < 0 ||
        latticeOrientation(here, r, p, target) < 0)
      continue;
    const double before = std::abs(orientDeterminant(p, q, r, here)),
                 after = std::abs(orientDeterminant(p, q, r, target));
    const Vec3d cut = plus(here, times(minus(target, here), before / (before + after)));
    std::uint32_t made = splitNearEdge(face, cut, segment);
    // A swap needs no point: points in the sides of long thin triangles would be cut by all others.
    if (made == kNone && maySwap_ && swaps_ < kMaxSwaps && swapFace(t, localFace)) {
      ++swaps_;
      return next(from, a, b);
    }
    if (made == kNone)
      made = splitFace(t, localFace, cut);
    // Tets so flat that no lattice point cuts them: by way of the point nearest to the segment.
    if (made == kNone)
      made = detour;
    if (made == kNone)
      throw InsertStop{InsertResult::Failed};
    return made;
  }
  throw InsertStop{complex_.points[from].fixed ? InsertResult::Elsewhere : InsertResult::Failed};
}

// Close to one of the face's edges the edge is split instead of the face, which would leave flat
// tets.
std::uint32_t EdgeInserter::splitNearEdge(const Face& face, const Vec3d& cut,
                                          const Segment& segment) {
  double closest = 4 * tolerance_ * tolerance_;
  unsigned edge = 3;
  for (unsigned i = 0; i < 3; ++i) {
    const Vec3d on = nearestWithin(complex_.at(face[i]), complex_.at(face[(i + 1) % 3]), cut);
    const Vec3d offset = minus(on, cut);
    if (dot(offset, offset) < closest && segment.squaredDistance(on) <= tolerance_ * tolerance_) {
      closest = dot(offset, offset);
      edge = i;
    }
  }
  return edge < 3 ? split(face[edge], face[(edge + 1) % 3], cut) : kNone;
}

std::uint32_t EdgeInserter::splitFace(std::uint32_t t, unsigned localFace, const Vec3d& cut) {
  const TetComplex::Tet& tet = complex_.tets[t];
  if (tet.neighbours[localFace] >= TetComplex::kElsewhere)
    throw InsertStop{InsertResult::Elsewhere};
  const auto& at = kFaceCorners[localFace];
  const Face face = sortedCorners({tet.corners[at[0]], tet.corners[at[1]], tet.corners[at[2]]});
  const std::uint32_t made = insert_.intoFace(t, localFace, roundToLattice(cut));
  if (made != kNone)
    facePoints_[face] = made;
  return made;
}

// The height of a tet over its largest face.
double EdgeInserter::heightOf(const std::array<std::uint32_t, 4>& corners) const {
  double largest = 0;
  for (const auto& face : kFaceCorners) {
    const Vec3d& base = complex_.at(corners[face[0]]);
    largest = std::max(largest, length(cross(minus(complex_.at(corners[face[1]]), base),
                                             minus(complex_.at(corners[face[2]]), base))));
  }
  return exactDeterminant(complex_.at(corners[0]), complex_.at(corners[1]), complex_.at(corners[2]),
                          complex_.at(corners[3])) /
         largest;
}

// Replaces tet t and its neighbour across a face that is not tracked by three tets around the edge
// between their opposite corners. False where these would be flat, or flatter than the two.
bool EdgeInserter::swapFace(std::uint32_t t, unsigned localFace) {
  const TetComplex::Tet& tet = complex_.tets[t];
  if (tet.tracked[localFace] || tet.neighbours[localFace] >= TetComplex::kElsewhere)
    return false;
  const std::uint32_t across = tet.neighbours[localFace], near = tet.corners[localFace];
  const std::uint32_t far = complex_.tets[across].corners[complex_.localFaceOf(across, t)];
  std::vector<TetComplex::NewTet> fresh(3);
  for (unsigned i = 0; i < 3; ++i) {
    // The face turns counter-clockwise seen from the far corner.
    fresh[i].corners = {tet.corners[kFaceCorners[localFace][i]],
                        tet.corners[kFaceCorners[localFace][(i + 1) % 3]], near, far};
    if (!complex_.isPositive(fresh[i].corners))
      return false;
  }
  const double flattest = std::min(heightOf(tet.corners), heightOf(complex_.tets[across].corners));
  for (const TetComplex::NewTet& made : fresh)
    if (heightOf(made.corners) < std::min(flattest, kNotFlat * tolerance_))
      return false;
  complex_.replace({t, across}, fresh);
  return true;
}

std::uint32_t EdgeInserter::split(std::uint32_t a, std::uint32_t b, const Vec3d& at) {
  const std::uint32_t made =
      insert_.intoEdge(a, b, nearestWithin(complex_.at(a), complex_.at(b), at));
  if (made != kNone)
    known_.midpoints.emplace(edgeKey(a, b), made);
  return made;
}

} // namespace tetvdb
