// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/insertion/TriangleInserter.h"

#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = TetComplex::kNone;
constexpr std::size_t kMaxFaces = 50000; // of one front: no model came near it
constexpr double kNoise = 4;             // tolerances: a direction over less than this is unknown
constexpr int kMaxHalvings = 6;          // of a triangle

std::uint64_t directed(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t(from) << 32 | to;
}

Vec3d unit(const Vec3d& v) {
  const double size = length(v);
  return size > 0 ? times(v, 1 / size) : v;
}

} // namespace

template <typename Work>
TriangleInserter::Result TriangleInserter::attempt(Chain chain, const Work& work) {
  edges_.begin();
  try {
    std::vector<Face> faces;
    work(faces);
    mark(std::move(faces), chain);
    return Result::In;
  } catch (const InsertStop& stop) {
    return stop.why;
  }
}

TriangleInserter::Result TriangleInserter::insert(const std::array<std::uint32_t, 3>& corners,
                                                  Chain chain, unsigned through) {
  flat_.clear();
  return attempt(chain, [&](std::vector<Face>& faces) {
    for (unsigned i = 0; i < 3; ++i)
      if (through == 3 || i != (through + 1) % 3)
        edges_.insert(corners[i], corners[(i + 1) % 3]);
    if (through < 3)
      joinPaths(corners[(through + 1) % 3], corners[through], corners[(through + 2) % 3]);
    cover({known_.path(corners[0], corners[1]), known_.path(corners[1], corners[2]),
           known_.path(corners[2], corners[0])},
          kMaxHalvings, faces);
  });
}

// Makes the path of edge a-b, where there is none, from the paths of its corners to the apex.
void TriangleInserter::joinPaths(std::uint32_t a, std::uint32_t apex, std::uint32_t b) {
  if (a > b)
    std::swap(a, b);
  if (known_.paths.count(edgeKey(a, b)) != 0)
    return;
  Path joined = known_.path(a, apex);
  const Path rest = known_.path(apex, b);
  joined.insert(joined.end(), rest.begin() + 1, rest.end());
  known_.paths.emplace(edgeKey(a, b), std::move(joined));
}

TriangleInserter::Result TriangleInserter::insertFlat(const std::vector<Face>& triangles,
                                                      Chain chain) {
  return attempt(chain, [&](std::vector<Face>& faces) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> around;
    for (const Face& face : triangles)
      for (unsigned i = 0; i < 3; ++i)
        if (around.erase({face[(i + 1) % 3], face[i]}) == 0)
          around.emplace(face[i], face[(i + 1) % 3]);
    border_.clear();
    for (const auto& [a, b] : around) {
      edges_.insert(a, b);
      border_.push_back({complex_.at(a), complex_.at(b)});
    }
    std::vector<Path> sides;
    sides.reserve(around.size());
    for (const auto& [a, b] : around)
      sides.push_back(known_.path(a, b));
    closeFront(sides, setFlat(triangles), faces);
  });
}

double TriangleInserter::height(const Vec3d& p) const {
  return dot(normal_, minus(p, at_[0]));
}

// How far within the triangle's edges a point is, seen along the normal; below 0 outside.
double TriangleInserter::inside(const Vec3d& p) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (flat_.empty()) {
    double depth = kInfinity;
    for (unsigned i = 0; i < 3; ++i)
      depth = std::min(depth, dot(inward_[i], minus(p, at_[i])));
    return depth;
  }
  const Vec3d on = minus(p, times(normal_, height(p)));
  double minSquared = kInfinity;
  for (const auto& [a, b] : border_)
    minSquared = std::min(minSquared, nearestOnSegment(minus(a, on), minus(b, on)).squared);
  const auto holds = [&](const std::array<Vec3d, 3>& triangle) {
    for (unsigned i = 0; i < 3; ++i)
      if (dot(normal_, cross(minus(triangle[(i + 1) % 3], triangle[i]), minus(on, triangle[i]))) <
          0)
        return false;
    return true;
  };
  const bool within = std::any_of(flat_.begin(), flat_.end(), holds);
  return within ? std::sqrt(minSquared) : -std::sqrt(minSquared);
}

// Returns twice the area that the faces may have, with a margin: faces of more area overlap.
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

// Where a triangle's front does not close, because other faces lie within tolerance of it, the
// triangle is halved at the midpoint of its longest side: the halves lie closer to the paths of
// their sides.
void TriangleInserter::cover(std::array<Path, 3> sides, int depth, std::vector<Face>& faces) {
  for (Path& side : sides)
    side = known_.refined(side);
  const std::size_t before = faces.size();
  try {
    closeFront({sides.begin(), sides.end()}, setTriangle(sides), faces);
    return;
  } catch (const InsertStop& stop) {
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
  edges_.keepFaces(); // of the half that has closed
  Path& side = sides[longest];
  side = known_.refined(side);
  const Vec3d midpoint = times(plus(complex_.at(side.front()), complex_.at(side.back())), 0.5);
  if (side.size() == 2) {
    if (edges_.split(side[0], side[1], midpoint) == kNone)
      throw InsertStop{Result::Failed};
    side = known_.refined(side);
  }
  std::size_t best = 1;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k + 1 < side.size(); ++k) {
    const Vec3d offset = minus(complex_.at(side[k]), midpoint);
    if (dot(offset, offset) < nearest) {
      nearest = dot(offset, offset);
      best = k;
    }
  }
  const std::uint32_t apex = sides[(longest + 1) % 3].back(), cut = side[best];
  edges_.insert(apex, cut);
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
    taken_.insert(sortedCorners(faces.back()));
    room -=
        length(cross(minus(complex_.at(v), complex_.at(u)), minus(complex_.at(w), complex_.at(u))));
    if (room < 0 || faces.size() > kMaxFaces)
      throw InsertStop{Result::Failed};
    add(u, w);
    add(w, v);
  }
}

// An edge of the front, from u to v. Seen along it, `left` lies in the triangle's plane.
struct TriangleInserter::FrontEdge {
  std::uint32_t u, v;
  Vec3d from, left;
  double level; // of the edge over the plane, which it may leave by the tolerance

  double leftward(const Vec3d& p) const { return dot(left, minus(p, from)); }
};

bool TriangleInserter::isOpen(std::uint32_t from, std::uint32_t to) const {
  const auto found = front_.find(directed(from, to));
  return found != front_.end() && found->second > 0;
}

// Of the points around the edge that are within tolerance of the triangle, on the left, the one
// straightest ahead. Before all others a point of the loop next to the edge's line, where sides are
// noise, if both new edges meet the front there.
std::uint32_t TriangleInserter::pointWithin(const FrontEdge& edge, double tolerance) const {
  std::uint32_t best = kNone;
  double straightest = 0;
  for (const std::uint32_t p : ring_) {
    const Vec3d& at = complex_.at(p);
    const double aside = edge.leftward(at);
    const bool isLoop = std::binary_search(onLoop_.begin(), onLoop_.end(), p);
    if (!isLoop && (std::abs(height(at)) > tolerance || inside(at) < tolerance_))
      continue;
    if (isLoop && std::abs(aside) < kNoise * tolerance_ && isOpen(edge.v, p) && isOpen(p, edge.u))
      return p;
    if (aside <= 0 || taken_.count(sortedCorners({edge.u, edge.v, p})) > 0)
      continue;
    const double straight = aside / std::hypot(aside, height(at) - edge.level);
    if (straight > straightest) {
      straightest = straight;
      best = p;
    }
  }
  return best;
}

// The third point of the face that continues to the left of front edge u -> v.
std::uint32_t TriangleInserter::faceAtFront(std::uint32_t u, std::uint32_t v) {
  const bool closed = complex_.ring(u, v, tets_, ring_);
  edges_.spend(tets_.size());
  if (ring_.empty())
    throw InsertStop{Result::Elsewhere};
  const Vec3d from = complex_.at(u);
  const FrontEdge edge{u, v, from, unit(cross(normal_, minus(complex_.at(v), from))),
                       (height(from) + height(complex_.at(v))) / 2};
  const std::uint32_t within = pointWithin(edge, tolerance_);
  return within != kNone ? within : cutAtFront(edge, closed);
}

// A new point in the ring's edge that the triangle runs through. Cuts are made in the plane, so
// that errors do not add up from edge to edge; at the edge's own level only where the plane misses
// all.
std::uint32_t TriangleInserter::cutAtFront(const FrontEdge& edge, bool isClosed) {
  const std::size_t pairs = isClosed ? ring_.size() : ring_.size() - 1;
  for (const double cutLevel : {0.0, edge.level})
    for (std::size_t i = 0; i < pairs; ++i) {
      const std::uint32_t p = ring_[i], q = ring_[(i + 1) % ring_.size()];
      const double above = height(complex_.at(p)) - cutLevel;
      const double below = height(complex_.at(q)) - cutLevel;
      if ((above > 0) == (below > 0))
        continue;
      const double s = above / (above - below);
      const Vec3d cut = plus(complex_.at(p), times(minus(complex_.at(q), complex_.at(p)), s));
      if (edge.leftward(cut) <= 0)
        continue;
      if (inside(cut) < -tolerance_)
        throw InsertStop{Result::Failed};
      const std::uint32_t made = edges_.split(p, q, cut);
      // Tets so flat that no lattice point cuts them: by way of a point that exists.
      for (double wide = 4 * tolerance_; made == kNone && wide <= reach_; wide *= 4)
        if (const std::uint32_t best = pointWithin(edge, wide); best != kNone)
          return best;
      if (made == kNone)
        throw InsertStop{complex_.ring(p, q, tets_, ring_) ? Result::Failed : Result::Elsewhere};
      return made;
    }
  throw InsertStop{isClosed ? Result::Failed : Result::Elsewhere};
}

// Adds to `faces` what a face has been cut into since it was found. False where it is whole.
bool TriangleInserter::addHalves(const Face& face, std::vector<Face>& faces) const {
  const auto [u, v, w] = face;
  const auto& midpoints = known_.midpoints;
  if (const auto midpoint = midpoints.find(edgeKey(u, v)); midpoint != midpoints.end()) {
    faces.push_back({u, midpoint->second, w});
    faces.push_back({midpoint->second, v, w});
    return true;
  }
  if (midpoints.count(edgeKey(v, w)) + midpoints.count(edgeKey(w, u)) > 0) {
    faces.push_back({v, w, u});
    return true;
  }
  const auto point = edges_.facePoints().find(sortedCorners(face));
  if (point == edges_.facePoints().end())
    return false;
  const std::uint32_t p = point->second;
  for (const Face& third : {Face{u, v, p}, Face{v, w, p}, Face{w, u, p}})
    faces.push_back(third);
  return true;
}

// The tet behind a face on one of its sides, and the chain that the face has in it.
TriangleInserter::Side TriangleInserter::sideOf(const Face& face, Chain chain) {
  complex_.ring(face[0], face[1], tets_, ring_);
  const auto found = std::find_if(tets_.begin(), tets_.end(), [&](std::uint32_t t) {
    return complex_.tets[t].cornerOf(face[2]) < 4;
  });
  if (found == tets_.end())
    throw InsertStop{Result::Elsewhere};
  const TetComplex::Tet& tet = complex_.tets[*found];
  const unsigned localFace =
      6 - tet.cornerOf(face[0]) - tet.cornerOf(face[1]) - tet.cornerOf(face[2]);
  if (tet.neighbours[localFace] >= TetComplex::kElsewhere)
    throw InsertStop{Result::Elsewhere};
  // A face that turns as the tet's own does, seen from outside, looks out of it.
  const auto& corners = kFaceCorners[localFace];
  const auto first = static_cast<std::size_t>(
      std::find(face.begin(), face.end(), tet.corners[corners[0]]) - face.begin());
  const bool looksOut = face[(first + 1) % 3] == tet.corners[corners[1]];
  return {*found, localFace, looksOut ? chain : -chain};
}

void TriangleInserter::mark(std::vector<Face> faces, Chain chain) {
  std::vector<Side> sides;
  while (!faces.empty()) {
    const Face face = faces.back();
    faces.pop_back();
    if (!addHalves(face, faces))
      sides.push_back(sideOf(face, chain));
  }
  for (const auto& [t, localFace, here] : sides) {
    TetComplex::Tet& tet = complex_.tets[t];
    tet.chains[localFace] += here;
    tet.tracked[localFace] = true;
    TetComplex::Tet& other = complex_.tets[tet.neighbours[localFace]];
    const unsigned back = complex_.localFaceOf(tet.neighbours[localFace], t);
    other.chains[back] -= here;
    other.tracked[back] = true;
  }
}

} // namespace tetvdb
