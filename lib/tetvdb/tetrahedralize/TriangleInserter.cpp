// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/TriangleInserter.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = TetComplex::kNone;
constexpr std::size_t kMostSteps = 100000; // along one edge, or about one front: far beyond need

std::uint64_t directed(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t(from) << 32 | to;
}

Vec3d unit(const Vec3d& v) {
  const double size = length(v);
  return size > 0 ? times(v, 1 / size) : v;
}

// The point of segment a-b nearest to p, its ends apart: between 1/1024 and 1023/1024 of the way.
Vec3d nearestWithin(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
  const Vec3d along = minus(b, a);
  const double s = dot(minus(p, a), along) / dot(along, along);
  return roundToLattice(plus(a, times(along, std::clamp(s, 1. / 1024, 1023. / 1024))));
}

} // namespace

TriangleInserter::Result TriangleInserter::insert(const std::array<std::uint32_t, 3>& corners,
                                                  Chain chain, unsigned through) {
  try {
    for (unsigned i = 0; i < 3; ++i)
      if (through == 3 || i != (through + 1) % 3)
        recover(corners[i], corners[(i + 1) % 3]);
    if (through < 3) {
      const std::uint32_t apex = corners[through];
      std::uint32_t a = corners[(through + 1) % 3], b = corners[(through + 2) % 3];
      if (a > b)
        std::swap(a, b);
      if (known_.paths.count(edgeKey(a, b)) == 0) {
        std::vector<std::uint32_t> joined = known_.path(a, apex);
        const std::vector<std::uint32_t> rest = known_.path(apex, b);
        joined.insert(joined.end(), rest.begin() + 1, rest.end());
        known_.paths.emplace(edgeKey(a, b), std::move(joined));
      }
    }
    cover(corners, chain);
    return Result::In;
  } catch (const Stop& stop) {
    return stop.why;
  }
}

std::vector<std::uint32_t> InsertedPaths::path(std::uint32_t a, std::uint32_t b) const {
  const auto found = paths.find(edgeKey(a, b));
  if (found == paths.end())
    return {};
  std::vector<std::uint32_t> whole{found->second.front()};
  // Edges still to go, the next one last.
  std::vector<std::uint32_t> ahead(found->second.rbegin(), found->second.rend() - 1);
  while (!ahead.empty()) {
    const auto middle = middles.find(edgeKey(whole.back(), ahead.back()));
    if (middle != middles.end()) {
      ahead.push_back(middle->second);
    } else {
      whole.push_back(ahead.back());
      ahead.pop_back();
    }
  }
  if (whole.front() != a)
    std::reverse(whole.begin(), whole.end());
  return whole;
}

void TriangleInserter::recover(std::uint32_t a, std::uint32_t b) {
  if (a > b)
    std::swap(a, b);
  if (known_.paths.count(edgeKey(a, b)) != 0)
    return;
  // Both parts that share an edge would make a path of their own.
  if (complex_.points[a].fixed && complex_.points[b].fixed)
    throw Stop{Result::Elsewhere};
  std::vector<std::uint32_t> made{a};
  for (std::size_t step = 0; made.back() != b; ++step) {
    if (step > kMostSteps)
      throw Stop{Result::Failed};
    made.push_back(nextOnSegment(made.back(), a, b));
  }
  known_.paths.emplace(edgeKey(a, b), std::move(made));
}

std::uint32_t TriangleInserter::nextOnSegment(std::uint32_t from, std::uint32_t a,
                                              std::uint32_t b) {
  const Vec3d start = complex_.at(a), end = complex_.at(b), here = complex_.at(from);
  complex_.star(from, tets_);
  const Vec3d along = unit(minus(end, start));
  const double now = dot(minus(here, start), along), whole = length(minus(end, start));
  // Along an edge that is there.
  std::uint32_t best = kNone;
  double farthest = now;
  for (const std::uint32_t t : tets_)
    for (const std::uint32_t q : complex_.tets[t].corners) {
      if (q == b)
        return b;
      const Vec3d offset = minus(complex_.at(q), start);
      const double s = dot(offset, along);
      if (s <= farthest || s >= whole)
        continue;
      const Vec3d aside = minus(offset, times(along, s));
      if (dot(aside, aside) <= tolerance_ * tolerance_) {
        best = q;
        farthest = s;
      }
    }
  if (best != kNone)
    return best;
  // Through the face of the star that the segment leaves by.
  const Vec3d& target = complex_.at(b);
  for (const std::uint32_t t : tets_) {
    const TetComplex::Tet& tet = complex_.tets[t];
    const unsigned slot = tet.cornerOf(from);
    std::uint32_t face[3];
    for (unsigned i = 0; i < 3; ++i)
      face[i] = tet.corners[kFaceCorners[slot][i]];
    bool within = true;
    for (unsigned i = 0; within && i < 3; ++i)
      within = latticeOrientation(here, complex_.at(face[i]), complex_.at(face[(i + 1) % 3]),
                                  target) >= 0;
    if (!within)
      continue;
    const Vec3d &p = complex_.at(face[0]), &q = complex_.at(face[1]), &r = complex_.at(face[2]);
    const double before = std::abs(orientDeterminant(p, q, r, here)),
                 after = std::abs(orientDeterminant(p, q, r, target));
    const Vec3d cut = plus(here, times(minus(target, here), before / (before + after)));
    // Close to one of its edges the edge is cut instead: no flat tets.
    double nearest = 4 * tolerance_ * tolerance_;
    unsigned edge = 3;
    for (unsigned i = 0; i < 3; ++i) {
      const Vec3d on = nearestWithin(complex_.at(face[i]), complex_.at(face[(i + 1) % 3]), cut);
      const Vec3d offset = minus(on, cut);
      const Vec3d aside = minus(minus(on, start), times(along, dot(minus(on, start), along)));
      if (dot(offset, offset) < nearest && dot(aside, aside) <= tolerance_ * tolerance_) {
        nearest = dot(offset, offset);
        edge = i;
      }
    }
    std::uint32_t made = kNone;
    if (edge < 3)
      made = splitEdge(face[edge], face[(edge + 1) % 3], cut);
    if (made == kNone) {
      if (complex_.tets[t].neighbours[slot] >= TetComplex::kElsewhere)
        throw Stop{Result::Elsewhere};
      made = insert_.intoFace(t, slot, roundToLattice(cut));
    }
    if (made == kNone)
      throw Stop{Result::Failed};
    return made;
  }
  throw Stop{complex_.points[from].fixed ? Result::Elsewhere : Result::Failed};
}

std::uint32_t TriangleInserter::splitEdge(std::uint32_t a, std::uint32_t b, const Vec3d& at) {
  const std::uint32_t made =
      insert_.intoEdge(a, b, nearestWithin(complex_.at(a), complex_.at(b), at));
  if (made != kNone)
    known_.middles.emplace(edgeKey(a, b), made);
  return made;
}

double TriangleInserter::height(const Vec3d& p) const {
  return dot(normal_, minus(p, at_[0]));
}

// In the triangle's plane, that is; with the tolerance.
bool TriangleInserter::isInside(const Vec3d& p) const {
  for (unsigned i = 0; i < 3; ++i)
    if (dot(inward_[i], minus(p, at_[i])) < -tolerance_)
      return false;
  return true;
}

void TriangleInserter::cover(const std::array<std::uint32_t, 3>& corners, Chain chain) {
  for (unsigned i = 0; i < 3; ++i)
    at_[i] = complex_.at(corners[i]);
  normal_ = unit(cross(minus(at_[1], at_[0]), minus(at_[2], at_[0])));
  for (unsigned i = 0; i < 3; ++i)
    inward_[i] = unit(cross(normal_, minus(at_[(i + 1) % 3], at_[i])));
  front_.clear();
  onLoop_.clear();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ahead;
  const auto add = [&](std::uint32_t u, std::uint32_t v) {
    const auto back = front_.find(directed(v, u));
    if (back != front_.end() && back->second > 0) {
      --back->second;
      return;
    }
    ++front_[directed(u, v)];
    ahead.emplace_back(u, v);
  };
  for (unsigned i = 0; i < 3; ++i) {
    const std::vector<std::uint32_t> side = known_.path(corners[i], corners[(i + 1) % 3]);
    for (std::size_t k = 0; k + 1 < side.size(); ++k) {
      add(side[k], side[k + 1]);
      onLoop_.push_back(side[k]);
    }
  }
  std::sort(onLoop_.begin(), onLoop_.end());
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (std::size_t step = 0; !ahead.empty(); ++step) {
    if (step > kMostSteps)
      throw Stop{Result::Failed};
    const auto [u, v] = ahead.back();
    ahead.pop_back();
    const auto open = front_.find(directed(u, v));
    if (open->second == 0)
      continue; // met by another since
    --open->second;
    const std::uint32_t w = faceAtFront(u, v);
    faces.push_back({u, v, w});
    add(u, w);
    add(w, v);
  }
  mark(faces, chain);
}

// The third point of the face that goes on to the left of front edge u -> v.
std::uint32_t TriangleInserter::faceAtFront(std::uint32_t u, std::uint32_t v) {
  const bool closed = complex_.ring(u, v, tets_, ring_);
  if (ring_.empty())
    throw Stop{Result::Elsewhere};
  const Vec3d from = complex_.at(u);
  const Vec3d left = unit(cross(normal_, minus(complex_.at(v), from)));
  const auto leftward = [&](std::uint32_t p) { return dot(left, minus(complex_.at(p), from)); };
  // A point within tolerance of the triangle, on the left: the one straightest ahead.
  std::uint32_t best = kNone;
  double straightest = 0;
  for (const std::uint32_t p : ring_) {
    const Vec3d& at = complex_.at(p);
    const double aside = leftward(p), up = height(at);
    const bool isLoop = std::binary_search(onLoop_.begin(), onLoop_.end(), p);
    if (aside <= 0 || (!isLoop && (std::abs(up) > tolerance_ || !isInside(at))) ||
        std::abs(up) > 2 * tolerance_)
      continue;
    const double straight = aside / std::hypot(aside, up);
    if (straight > straightest) {
      straightest = straight;
      best = p;
    }
  }
  if (best != kNone)
    return best;
  // Else the triangle runs through one of the tets, between two points of the ring.
  const std::size_t pairs = closed ? ring_.size() : ring_.size() - 1;
  for (std::size_t i = 0; i < pairs; ++i) {
    const std::uint32_t p = ring_[i], q = ring_[(i + 1) % ring_.size()];
    const double up = height(complex_.at(p)), down = height(complex_.at(q));
    if ((up > 0) == (down > 0))
      continue;
    const double s = up / (up - down);
    const Vec3d cut = plus(complex_.at(p), times(minus(complex_.at(q), complex_.at(p)), s));
    if (dot(left, minus(cut, from)) <= 0)
      continue;
    if (!isInside(cut))
      throw Stop{Result::Failed};
    const std::uint32_t made = splitEdge(p, q, cut);
    if (made == kNone)
      throw Stop{complex_.ring(p, q, tets_, ring_) ? Result::Failed : Result::Elsewhere};
    return made;
  }
  throw Stop{closed ? Result::Failed : Result::Elsewhere};
}

void TriangleInserter::mark(const std::vector<std::array<std::uint32_t, 3>>& faces, Chain chain) {
  struct Side {
    std::uint32_t tet;
    unsigned slot;
  };
  std::vector<Side> sides;
  for (const auto& [u, v, w] : faces) {
    complex_.ring(u, v, tets_, ring_);
    std::size_t found = tets_.size();
    for (std::size_t i = 0; i < tets_.size() && found == tets_.size(); ++i)
      if (complex_.tets[tets_[i]].cornerOf(w) < 4)
        found = i;
    if (found == tets_.size())
      throw Stop{Result::Elsewhere};
    const std::uint32_t t = tets_[found];
    const TetComplex::Tet& tet = complex_.tets[t];
    unsigned slot = 0;
    while (tet.corners[slot] == u || tet.corners[slot] == v || tet.corners[slot] == w)
      ++slot;
    if (tet.neighbours[slot] >= TetComplex::kElsewhere)
      throw Stop{Result::Elsewhere};
    sides.push_back({t, slot});
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto [t, slot] = sides[i];
    TetComplex::Tet& tet = complex_.tets[t];
    // A face that turns as the tet's own does, seen from outside, looks out of it.
    const auto& corners = kFaceCorners[slot];
    const auto first =
        std::find(faces[i].begin(), faces[i].end(), tet.corners[corners[0]]) - faces[i].begin();
    const bool looksOut =
        faces[i][static_cast<std::size_t>(first + 1) % 3] == tet.corners[corners[1]];
    const Chain here = looksOut ? chain : -chain;
    tet.chains[slot] += here;
    tet.tracked[slot] = true;
    TetComplex::Tet& other = complex_.tets[tet.neighbours[slot]];
    const unsigned back = complex_.slotOf(tet.neighbours[slot], t);
    other.chains[back] -= here;
    other.tracked[back] = true;
  }
}

} // namespace tetvdb
