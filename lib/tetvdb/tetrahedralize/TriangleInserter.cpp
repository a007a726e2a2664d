// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/TriangleInserter.h"

#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = TetComplex::kNone;
constexpr std::size_t kMostSteps = 50000; // along one edge, or about one front: far beyond need
constexpr double kNoise = 4;      // tolerances: a direction over less than this says nothing
constexpr std::size_t kHub = 100; // tets around a point
constexpr int kMostFlips = 100;   // along one edge
constexpr double kNotFlat = 100;  // tolerances: a tet higher than that can be cut again and again
constexpr int kMostParts = 6;     // halvings of a triangle

std::uint64_t directed(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t(from) << 32 | to;
}

Vec3d unit(const Vec3d& v) {
  const double size = length(v);
  return size > 0 ? times(v, 1 / size) : v;
}

std::array<std::uint32_t, 3> sortedFace(std::array<std::uint32_t, 3> face) {
  std::sort(face.begin(), face.end());
  return face;
}

// The point of segment a-b nearest to p, its ends apart.
Vec3d nearestWithin(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
  const Vec3d along = minus(b, a);
  const double s = dot(minus(p, a), along) / dot(along, along);
  return roundToLattice(plus(a, times(along, std::clamp(s, 1e-6, 1 - 1e-6))));
}

} // namespace

TriangleInserter::Result TriangleInserter::insert(const std::array<std::uint32_t, 3>& corners,
                                                  Chain chain, unsigned through) {
  faceMiddles_.clear();
  effort_ = 0;
  flat_.clear();
  mayFlip_ = true;
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
    std::vector<Face> faces;
    cover({known_.path(corners[0], corners[1]), known_.path(corners[1], corners[2]),
           known_.path(corners[2], corners[0])},
          kMostParts, faces);
    mark(std::move(faces), chain);
    return Result::In;
  } catch (const Stop& stop) {
    return stop.why;
  }
}

TriangleInserter::Result
TriangleInserter::insertFlat(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                             Chain chain) {
  faceMiddles_.clear();
  effort_ = 0;
  mayFlip_ = true;
  try {
    std::set<std::pair<std::uint32_t, std::uint32_t>> around;
    for (const Face& face : triangles)
      for (unsigned i = 0; i < 3; ++i)
        if (around.erase({face[(i + 1) % 3], face[i]}) == 0)
          around.emplace(face[i], face[(i + 1) % 3]);
    std::vector<Path> sides;
    border_.clear();
    for (const auto& [a, b] : around) {
      recover(a, b);
      border_.push_back({complex_.at(a), complex_.at(b)});
    }
    sides.reserve(around.size());
    for (const auto& [a, b] : around)
      sides.push_back(known_.path(a, b));
    std::vector<Face> faces;
    closeFront(sides, setFlat(triangles), faces);
    mark(std::move(faces), chain);
    return Result::In;
  } catch (const Stop& stop) {
    return stop.why;
  }
}

std::vector<std::uint32_t> InsertedPaths::refined(const std::vector<std::uint32_t>& path) const {
  std::vector<std::uint32_t> whole{path.front()};
  std::vector<std::uint32_t> ahead(path.rbegin(), path.rend() - 1); // the next point last
  while (!ahead.empty()) {
    const auto middle = middles.find(edgeKey(whole.back(), ahead.back()));
    if (middle != middles.end()) {
      ahead.push_back(middle->second);
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

void TriangleInserter::spend(std::size_t tets) {
  effort_ += tets;
  if (effort_ > mostEffort_)
    throw Stop{Result::Failed};
}

void TriangleInserter::recover(std::uint32_t a, std::uint32_t b) {
  if (a > b)
    std::swap(a, b);
  if (known_.paths.count(edgeKey(a, b)) != 0)
    return;
  // Both parts that share an edge would make a path of their own.
  if (complex_.points[a].fixed && complex_.points[b].fixed)
    throw Stop{Result::Elsewhere};
  flips_ = 0;
  // Away from hubs: every step looks at all tets around a point.
  const bool turn = complex_.hasMoreTets(a, kHub) && !complex_.hasMoreTets(b, kHub);
  const std::uint32_t start = turn ? b : a, end = turn ? a : b;
  std::vector<std::uint32_t> made{start};
  for (std::size_t step = 0; made.back() != end; ++step) {
    if (step > kMostSteps)
      throw Stop{Result::Failed};
    made.push_back(nextOnSegment(made.back(), start, end));
  }
  if (turn)
    std::reverse(made.begin(), made.end());
  known_.paths.emplace(edgeKey(a, b), std::move(made));
}

std::uint32_t TriangleInserter::nextOnSegment(std::uint32_t from, std::uint32_t a,
                                              std::uint32_t b) {
  const Vec3d start = complex_.at(a), end = complex_.at(b), here = complex_.at(from);
  complex_.star(from, tets_);
  spend(tets_.size());
  const Vec3d along = unit(minus(end, start));
  const double now = dot(minus(here, start), along), whole = length(minus(end, start));
  // Along an edge that is there: the shortest within tolerance, so that no point is passed by.
  std::uint32_t best = kNone, detour = kNone;
  bool neighbour = false;
  double nearest = whole, least = reach_ * reach_;
  for (const std::uint32_t t : tets_)
    for (const std::uint32_t q : complex_.tets[t].corners) {
      const Vec3d offset = minus(complex_.at(q), start);
      const double s = dot(offset, along);
      if (q == b) {
        neighbour = true;
        continue;
      }
      if (s <= now || s >= whole)
        continue;
      const Vec3d aside = minus(offset, times(along, s));
      const double squared = dot(aside, aside);
      if (squared <= tolerance_ * tolerance_ && s < nearest) {
        best = q;
        nearest = s;
      }
      if (squared < least) {
        detour = q;
        least = squared;
      }
    }
  if (best != kNone)
    return best;
  if (neighbour)
    return b;
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
    double closest = 4 * tolerance_ * tolerance_;
    unsigned edge = 3;
    for (unsigned i = 0; i < 3; ++i) {
      const Vec3d on = nearestWithin(complex_.at(face[i]), complex_.at(face[(i + 1) % 3]), cut);
      const Vec3d offset = minus(on, cut);
      const Vec3d aside = minus(minus(on, start), times(along, dot(minus(on, start), along)));
      if (dot(offset, offset) < closest && dot(aside, aside) <= tolerance_ * tolerance_) {
        closest = dot(offset, offset);
        edge = i;
      }
    }
    std::uint32_t made = kNone;
    if (edge < 3)
      made = splitEdge(face[edge], face[(edge + 1) % 3], cut);
    // Where the face can be done without, no point is needed: those in the sides of long thin
    // triangles would be cut by all the others.
    if (made == kNone && mayFlip_ && flips_ < kMostFlips && openFace(t, slot)) {
      ++flips_;
      return nextOnSegment(from, a, b);
    }
    if (made == kNone) {
      if (complex_.tets[t].neighbours[slot] >= TetComplex::kElsewhere)
        throw Stop{Result::Elsewhere};
      made = insert_.intoFace(t, slot, roundToLattice(cut));
      if (made != kNone)
        faceMiddles_[sortedFace({face[0], face[1], face[2]})] = made;
    }
    // Tets so flat that no lattice point parts them: by way of the point least aside.
    if (made == kNone)
      made = detour;
    if (made == kNone)
      throw Stop{Result::Failed};
    return made;
  }
  throw Stop{complex_.points[from].fixed ? Result::Elsewhere : Result::Failed};
}

// Of the tet over its largest face.
double TriangleInserter::heightOf(const std::array<std::uint32_t, 4>& corners) const {
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

// Tets t and its neighbour across a face that stands for nothing give way to three about the edge
// between their far corners. False where these would be flat, or flatter than those.
bool TriangleInserter::openFace(std::uint32_t t, unsigned slot) {
  const TetComplex::Tet& tet = complex_.tets[t];
  if (tet.tracked[slot] || tet.neighbours[slot] >= TetComplex::kElsewhere)
    return false;
  const std::uint32_t across = tet.neighbours[slot], near = tet.corners[slot];
  const std::uint32_t far = complex_.tets[across].corners[complex_.slotOf(across, t)];
  std::vector<TetComplex::NewTet> fresh(3);
  for (unsigned i = 0; i < 3; ++i) {
    // The face turns counter-clockwise seen from the far corner.
    fresh[i].corners = {tet.corners[kFaceCorners[slot][i]],
                        tet.corners[kFaceCorners[slot][(i + 1) % 3]], near, far};
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

// How far within the triangle's edges a point is, seen along the normal; below 0 outside.
double TriangleInserter::inside(const Vec3d& p) const {
  double least = std::numeric_limits<double>::infinity();
  if (flat_.empty()) {
    for (unsigned i = 0; i < 3; ++i)
      least = std::min(least, dot(inward_[i], minus(p, at_[i])));
    return least;
  }
  const Vec3d on = minus(p, times(normal_, height(p)));
  for (const auto& [a, b] : border_)
    least = std::min(least, nearestOnSegment(minus(a, on), minus(b, on)).squared);
  const auto holds = [&](const std::array<Vec3d, 3>& triangle) {
    for (unsigned i = 0; i < 3; ++i)
      if (dot(normal_, cross(minus(triangle[(i + 1) % 3], triangle[i]), minus(on, triangle[i]))) <
          0)
        return false;
    return true;
  };
  const bool within = std::any_of(flat_.begin(), flat_.end(), holds);
  return within ? std::sqrt(least) : -std::sqrt(least);
}

// Returns twice the area that faces may have, with something to spare: what goes beyond lies upon
// itself.
double TriangleInserter::setTriangle(const std::array<Path, 3>& sides) {
  for (unsigned i = 0; i < 3; ++i)
    at_[i] = complex_.at(sides[i].front());
  const Vec3d area = cross(minus(at_[1], at_[0]), minus(at_[2], at_[0]));
  normal_ = unit(area);
  for (unsigned i = 0; i < 3; ++i)
    inward_[i] = unit(cross(normal_, minus(at_[(i + 1) % 3], at_[i])));
  return 1.5 * length(area) +
         2 * tolerance_ * (length(minus(at_[1], at_[0])) + length(minus(at_[2], at_[0])));
}

double TriangleInserter::setFlat(const std::vector<Face>& triangles) {
  flat_.clear();
  Vec3d sum{0, 0, 0};
  for (const Face& face : triangles) {
    flat_.push_back({complex_.at(face[0]), complex_.at(face[1]), complex_.at(face[2])});
    sum = plus(sum, cross(minus(flat_.back()[1], flat_.back()[0]),
                          minus(flat_.back()[2], flat_.back()[0])));
  }
  at_ = flat_.front();
  normal_ = unit(sum);
  return 1.5 * length(sum);
}

// A triangle whose front does not close, as happens where other faces lie within tolerance of it
// without being part of it, is parted from the middle of its longest side: the halves are flatter
// against the paths that they end at.
void TriangleInserter::cover(std::array<Path, 3> sides, int depth, std::vector<Face>& faces) {
  for (Path& side : sides)
    side = known_.refined(side);
  const std::size_t before = faces.size();
  try {
    closeFront({sides.begin(), sides.end()}, setTriangle(sides), faces);
    return;
  } catch (const Stop& stop) {
    if (stop.why != Result::Failed || depth == 0)
      throw;
  }
  faces.resize(before);
  unsigned longest = 0;
  double length2 = 0;
  for (unsigned i = 0; i < 3; ++i) {
    const Vec3d along = minus(complex_.at(sides[i].back()), complex_.at(sides[i].front()));
    if (dot(along, along) > length2) {
      length2 = dot(along, along);
      longest = i;
    }
  }
  mayFlip_ = false; // faces of the part that has closed might go
  Path& side = sides[longest];
  side = known_.refined(side);
  const Vec3d middle = times(plus(complex_.at(side.front()), complex_.at(side.back())), 0.5);
  if (side.size() == 2) {
    if (splitEdge(side[0], side[1], middle) == kNone)
      throw Stop{Result::Failed};
    side = known_.refined(side);
  }
  std::size_t best = 1;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k + 1 < side.size(); ++k) {
    const Vec3d offset = minus(complex_.at(side[k]), middle);
    if (dot(offset, offset) < nearest) {
      nearest = dot(offset, offset);
      best = k;
    }
  }
  const std::uint32_t apex = sides[(longest + 1) % 3].back(), cut = side[best];
  recover(apex, cut);
  const auto half = side.begin() + static_cast<std::ptrdiff_t>(best);
  const Path first(side.begin(), half + 1), second(half, side.end());
  cover({first, known_.path(cut, apex), sides[(longest + 2) % 3]}, depth - 1, faces);
  cover({second, sides[(longest + 1) % 3], known_.path(apex, cut)}, depth - 1, faces);
}

void TriangleInserter::closeFront(const std::vector<Path>& sides, double room,
                                  std::vector<Face>& faces) {
  onLoop_.clear();
  for (const Path& side : sides)
    onLoop_.insert(onLoop_.end(), side.begin(), side.end() - 1);
  std::sort(onLoop_.begin(), onLoop_.end());
  front_.clear();
  taken_.clear();
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
  for (const Path& side : sides)
    for (std::size_t k = 0; k + 1 < side.size(); ++k)
      add(side[k], side[k + 1]);
  while (!ahead.empty()) {
    const auto [u, v] = ahead.back();
    ahead.pop_back();
    const auto open = front_.find(directed(u, v));
    if (open->second == 0)
      continue; // met by another since
    --open->second;
    const std::uint32_t w = faceAtFront(u, v);
    faces.push_back({u, v, w});
    taken_.insert(sortedFace(faces.back()));
    room -=
        length(cross(minus(complex_.at(v), complex_.at(u)), minus(complex_.at(w), complex_.at(u))));
    if (room < 0 || faces.size() > kMostSteps)
      throw Stop{Result::Failed};
    add(u, w);
    add(w, v);
  }
}

// The third point of the face that goes on to the left of front edge u -> v.
std::uint32_t TriangleInserter::faceAtFront(std::uint32_t u, std::uint32_t v) {
  const bool closed = complex_.ring(u, v, tets_, ring_);
  spend(tets_.size());
  if (ring_.empty())
    throw Stop{Result::Elsewhere};
  // Seen along the edge: left in the triangle's plane, up out of it. The edge itself may be off the
  // plane by the tolerance.
  const Vec3d from = complex_.at(u);
  const Vec3d left = unit(cross(normal_, minus(complex_.at(v), from)));
  const double level = (height(from) + height(complex_.at(v))) / 2;
  const auto leftward = [&](const Vec3d& p) { return dot(left, minus(p, from)); };
  // A point within tolerance of the triangle, on the left: the one straightest ahead, or one beside
  // the edge's line, where sides are noise, that both new edges would meet the front with.
  const auto isOpen = [&](std::uint32_t start, std::uint32_t end) {
    const auto found = front_.find(directed(start, end));
    return found != front_.end() && found->second > 0;
  };
  const auto pointWithin = [&](double tolerance) {
    std::uint32_t best = kNone;
    double straightest = 0;
    for (const std::uint32_t p : ring_) {
      const Vec3d& at = complex_.at(p);
      const double aside = leftward(at);
      const bool isLoop = std::binary_search(onLoop_.begin(), onLoop_.end(), p);
      if (!isLoop && (std::abs(height(at)) > tolerance || inside(at) < tolerance_))
        continue;
      if (isLoop && std::abs(aside) < kNoise * tolerance_ && isOpen(v, p) && isOpen(p, u))
        return p;
      if (aside <= 0 || taken_.count(sortedFace({u, v, p})) > 0)
        continue;
      const double straight = aside / std::hypot(aside, height(at) - level);
      if (straight > straightest) {
        straightest = straight;
        best = p;
      }
    }
    return best;
  };
  if (const std::uint32_t best = pointWithin(tolerance_); best != kNone)
    return best;
  // Else the triangle runs through one of the tets, between two points of the ring. Cuts are made
  // in the plane, so that errors do not add up from edge to edge; at the edge's own level only
  // where the plane passes it by.
  const std::size_t pairs = closed ? ring_.size() : ring_.size() - 1;
  for (const double cutLevel : {0.0, level})
    for (std::size_t i = 0; i < pairs; ++i) {
      const std::uint32_t p = ring_[i], q = ring_[(i + 1) % ring_.size()];
      const double above = height(complex_.at(p)) - cutLevel;
      const double below = height(complex_.at(q)) - cutLevel;
      if ((above > 0) == (below > 0))
        continue;
      const double s = above / (above - below);
      const Vec3d cut = plus(complex_.at(p), times(minus(complex_.at(q), complex_.at(p)), s));
      if (leftward(cut) <= 0)
        continue;
      if (inside(cut) < -tolerance_)
        throw Stop{Result::Failed};
      const std::uint32_t made = splitEdge(p, q, cut);
      // Tets so flat that no lattice point parts them: by way of a point that is there.
      for (double wide = 4 * tolerance_; made == kNone && wide <= reach_; wide *= 4)
        if (const std::uint32_t best = pointWithin(wide); best != kNone)
          return best;
      if (made == kNone)
        throw Stop{complex_.ring(p, q, tets_, ring_) ? Result::Failed : Result::Elsewhere};
      return made;
    }
  throw Stop{closed ? Result::Failed : Result::Elsewhere};
}

void TriangleInserter::mark(std::vector<Face> faces, Chain chain) {
  struct Side {
    std::uint32_t tet;
    unsigned slot;
    Chain chain;
  };
  std::vector<Side> sides;
  while (!faces.empty()) {
    const Face face = faces.back();
    faces.pop_back();
    // Parts that were made later may have cut it.
    const auto [u, v, w] = face;
    if (const auto middle = known_.middles.find(edgeKey(u, v)); middle != known_.middles.end()) {
      faces.push_back({u, middle->second, w});
      faces.push_back({middle->second, v, w});
      continue;
    }
    if (known_.middles.count(edgeKey(v, w)) + known_.middles.count(edgeKey(w, u)) > 0) {
      faces.push_back({v, w, u});
      continue;
    }
    if (const auto middle = faceMiddles_.find(sortedFace(face)); middle != faceMiddles_.end()) {
      for (const Face& part :
           {Face{u, v, middle->second}, Face{v, w, middle->second}, Face{w, u, middle->second}})
        faces.push_back(part);
      continue;
    }
    complex_.ring(u, v, tets_, ring_);
    const auto found = std::find_if(tets_.begin(), tets_.end(), [&, third = w](std::uint32_t t) {
      return complex_.tets[t].cornerOf(third) < 4;
    });
    if (found == tets_.end())
      throw Stop{Result::Elsewhere};
    const TetComplex::Tet& tet = complex_.tets[*found];
    unsigned slot = 0;
    while (tet.corners[slot] == u || tet.corners[slot] == v || tet.corners[slot] == w)
      ++slot;
    if (tet.neighbours[slot] >= TetComplex::kElsewhere)
      throw Stop{Result::Elsewhere};
    // A face that turns as the tet's own does, seen from outside, looks out of it.
    const auto& corners = kFaceCorners[slot];
    const auto first = static_cast<std::size_t>(
        std::find(face.begin(), face.end(), tet.corners[corners[0]]) - face.begin());
    const bool looksOut = face[(first + 1) % 3] == tet.corners[corners[1]];
    sides.push_back({*found, slot, looksOut ? chain : -chain});
  }
  for (const auto& [t, slot, here] : sides) {
    TetComplex::Tet& tet = complex_.tets[t];
    tet.chains[slot] += here;
    tet.tracked[slot] = true;
    TetComplex::Tet& other = complex_.tets[tet.neighbours[slot]];
    const unsigned back = complex_.slotOf(tet.neighbours[slot], t);
    other.chains[back] -= here;
    other.tracked[back] = true;
  }
}

} // namespace tetvdb
