// SPDX-License-Identifier: Apache-2.0
//
// Bowyer-Watson: the tets whose spheres hold the new point strictly inside are removed, and the
// point is joined to the faces around them.
//   Spheres are tested exactly, so that the cavity needs no repair. Let f be a face
// between a tet t whose open ball holds the new point p and a tet n whose open ball does not. All
// balls being empty so far, beyond f the ball of t lies within that of n, and in f's plane the two
// are the same disc: so p lies strictly on t's side of f. Every face around the cavity thus sees p
// strictly, a ray from p leaves the cavity once, and the new tets are positive, fill it, and leave
// all balls empty. Tets with p on their surface hold it in their open balls, so they are removed
// too. Only faces on the box's sides may lie in p's plane: p then lies on that side, and the face
// is opened.
#include "tetvdb/core/Error.h"
#include "tetvdb/core/LargeVector.h"
#include "tetvdb/tetrahedralize/complex/BackgroundMesh.h"
#include "tetvdb/tetrahedralize/complex/InSphere.h"
#include "tetvdb/tetrahedralize/complex/InsertionOrder.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <algorithm>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

using Index = std::uint32_t;
constexpr Index kNone = PlainTets::kNoTet;
constexpr std::size_t kMaxTets = std::size_t(1) << 30; // so that 4 * tet + face is an Index
constexpr std::size_t kBoxCorners = 8;

// A face of a tet, by the corner it lies opposite to, is 4 * tet + corner.
struct Tet {
  std::array<Index, 4> corners;
  std::array<Index, 4> across; // the same face of the tet beyond, kNone on the box's sides
};

// The new tets' faces by their edges away from the new point, which two tets see in opposite
// directions. Large and almost empty, so that branches are predicted well.
class EdgeTable {
public:
  // Forgets all; room for `edges`.
  void begin(std::size_t edges) {
    if (table_.size() < 4 * edges) {
      std::size_t size = 1024;
      for (shift_ = 64 - 10; size < 8 * edges; --shift_)
        size *= 2;
      table_.assign(size, {});
      now_ = 0;
    }
    ++now_;
  }
  void add(Index from, Index to, Index face) {
    std::size_t at = first(from, to);
    while (table_[at].stamp == now_)
      at = (at + 1) & (table_.size() - 1);
    table_[at] = {from, to, face, now_};
  }
  // kNone where there is none.
  Index find(Index from, Index to) const {
    for (std::size_t at = first(from, to);; at = (at + 1) & (table_.size() - 1)) {
      const Entry& entry = table_[at];
      if (entry.stamp != now_)
        return kNone;
      if (entry.from == from && entry.to == to)
        return entry.face;
    }
  }

private:
  struct Entry {
    Index from = 0, to = 0, face = 0, stamp = 0;
  };
  std::size_t first(Index from, Index to) const {
    const std::uint64_t edge = (std::uint64_t(from) << 32) | to;
    return (edge * 0x9E3779B97F4A7C15u) >> shift_;
  }

  std::vector<Entry> table_;
  int shift_ = 0;
  Index now_ = 0;
};

class Delaunay {
public:
  // The box's six tets around its diagonal.
  explicit Delaunay(LargeVector<Vec3d> points) : points_(std::move(points)) {
    tets_.reserve(7 * points_.size());
    constexpr Index kAxes[6][3] = {{1, 2, 4}, {2, 4, 1}, {4, 1, 2},
                                   {1, 4, 2}, {4, 2, 1}, {2, 1, 4}};
    for (const auto& axes : kAxes) {
      const Index tet = append();
      tets_[tet].corners = {0, axes[0], axes[0] + axes[1], 7};
      if (tet >= 3) // odd permutations
        std::swap(tets_[tet].corners[1], tets_[tet].corners[2]);
    }
    for (Index face = 0; face < 24; ++face)
      for (Index other = 0; other < 24; ++other)
        if (face / 4 != other / 4 && sortedCorners(face) == sortedCorners(other))
          tets_[face / 4].across[face % 4] = other;
  }

  void insert(Index point) {
    const Vec3d p = points_[point];
    openCavity(locate(p), p);
    fill(point);
  }

  // With the numbers that the points have outside.
  PlainTets take(const std::vector<Index>& names) const {
    std::vector<Index> places(tets_.size(), 0);
    for (const Index tet : free_)
      places[tet] = kNone;
    Index count = 0;
    for (Index& place : places)
      if (place != kNone)
        place = count++;
    PlainTets made;
    made.tets.resize(count);
    made.neighbours.resize(count);
    tbb::parallel_for(std::size_t(0), tets_.size(), [&](std::size_t tet) {
      if (places[tet] == kNone)
        return;
      for (std::size_t i = 0; i < 4; ++i) {
        const Index across = tets_[tet].across[i];
        made.tets[places[tet]][i] = names[tets_[tet].corners[i]];
        made.neighbours[places[tet]][i] = across == kNone ? kNone : places[across / 4];
      }
    });
    return made;
  }

private:
  struct CavityFace {
    std::array<Index, 4> corners; // of the tet within the cavity, the new point in its place
    Index corner;                 // that place
    Index across;
    Index tet; // the new one
  };
  // Of the face opposite a corner: its corners, each with the edge from the next to the one after,
  // all turning one way as seen from the corner whichever it is.
  static constexpr Index kTurns[4][3][3] = {{{1, 2, 3}, {2, 3, 1}, {3, 1, 2}},
                                            {{0, 3, 2}, {3, 2, 0}, {2, 0, 3}},
                                            {{0, 1, 3}, {1, 3, 0}, {3, 0, 1}},
                                            {{0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};

  std::array<Index, 3> sortedCorners(Index face) const {
    std::array<Index, 3> corners{};
    for (Index i = 1; i < 4; ++i)
      corners[i - 1] = tets_[face / 4].corners[(face + i) % 4];
    std::sort(corners.begin(), corners.end());
    return corners;
  }

  Index append() {
    if (tets_.size() == kMaxTets)
      throw Error(Status::Limit, "", "too many points for one mesh", "simplify the input");
    tets_.push_back({{}, {kNone, kNone, kNone, kNone}});
    marks_.push_back(0);
    return static_cast<Index>(tets_.size() - 1);
  }

  // Which side of the tet's face opposite `corner` p lies on: 1 is the tet's.
  int side(const Tet& tet, std::size_t corner, const Vec3d& p) const {
    std::array<const Vec3d*, 4> at{};
    for (std::size_t i = 0; i < 4; ++i)
      at[i] = &points_[tet.corners[i]];
    at[corner] = &p;
    return latticeOrientation(*at[0], *at[1], *at[2], *at[3]);
  }

  // A tet that holds p, from the last one on through faces that have p beyond them. Where spheres
  // are tied such a walk can cycle; a random choice among faces prevents this (Devillers,
  // Pion, Teillaud, "Walking in a triangulation", 2002).
  Index locate(const Vec3d& p) {
    Index tet = last_, from = kNone;
    for (;;) {
      random_ ^= random_ << 13; // Marsaglia, "Xorshift RNGs", 2003
      random_ ^= random_ >> 17;
      random_ ^= random_ << 5;
      Index next = kNone;
      int zeros = 0;
      for (Index i = 0; i < 4; ++i) {
        const Index corner = (random_ + i) % 4;
        if (corner == from)
          continue;
        const int sign = side(tets_[tet], corner, p);
        if (sign < 0) {
          next = tets_[tet].across[corner];
          break;
        }
        zeros += sign == 0;
      }
      if (next == kNone) {
        if (zeros == 3)
          throw Error(Status::Invalid, "", "a point to mesh is repeated");
        return tet;
      }
      tet = next / 4;
      from = next % 4;
    }
  }

  // Finds the tets that are removed, and the faces around them.
  void openCavity(Index seed, const Vec3d& p) {
    in_ += 2; // a mark is in_ where the tet is removed, in_ + 1 where it stays
    const Index stays = in_ + 1;
    cavity_.assign(1, seed);
    cavityFaces_.clear();
    marks_[seed] = in_;
    for (std::size_t k = 0; k < cavity_.size(); ++k) {
      const Tet& tet = tets_[cavity_[k]];
      for (Index corner = 0; corner < 4; ++corner) {
        const Index across = tet.across[corner];
        if (across == kNone) {
          if (side(tet, corner, p) == 0)
            continue;
        } else {
          Index& mark = marks_[across / 4];
          if (mark != in_ && mark != stays) {
            const auto& c = tets_[across / 4].corners;
            const bool goes =
                liesInSphere(points_[c[0]], points_[c[1]], points_[c[2]], points_[c[3]], p);
            mark = goes ? in_ : stays;
            if (goes)
              cavity_.push_back(across / 4);
          }
          if (mark == in_)
            continue;
        }
        cavityFaces_.push_back({tet.corners, corner, across, kNone});
      }
    }
  }

  // Joins the point to the faces around the cavity.
  void fill(Index point) {
    edges_.begin(3 * cavityFaces_.size());
    std::size_t reused = 0;
    for (CavityFace& face : cavityFaces_) {
      const Index tet = reused < cavity_.size() ? cavity_[reused++] : unusedTet();
      face.tet = tet;
      face.corners[face.corner] = point;
      tets_[tet].corners = face.corners;
      tets_[tet].across[face.corner] = face.across;
      if (face.across != kNone)
        tets_[face.across / 4].across[face.across % 4] = 4 * tet + face.corner;
      for (const auto& turn : kTurns[face.corner])
        edges_.add(face.corners[turn[1]], face.corners[turn[2]], 4 * tet + turn[0]);
    }
    for (const CavityFace& face : cavityFaces_)
      for (const auto& turn : kTurns[face.corner])
        tets_[face.tet].across[turn[0]] = edges_.find(face.corners[turn[2]], face.corners[turn[1]]);
    last_ = cavityFaces_.back().tet;
    free_.insert(free_.end(), cavity_.begin() + static_cast<std::ptrdiff_t>(reused), cavity_.end());
  }

  Index unusedTet() {
    if (free_.empty())
      return append();
    const Index tet = free_.back();
    free_.pop_back();
    return tet;
  }

  LargeVector<Vec3d> points_;
  LargeVector<Tet> tets_;
  LargeVector<Index> marks_; // of every tet
  std::vector<Index> free_;
  std::vector<Index> cavity_;
  std::vector<CavityFace> cavityFaces_;
  EdgeTable edges_;
  Index in_ = 0, last_ = 0, random_ = 0x2545F491u;
};

} // namespace

PlainTets delaunayTets(const std::vector<Vec3d>& points, double grain, Progress& progress) {
  if (points.size() > kMaxTets)
    throw Error(Status::Limit, "", "too many points for one mesh", "simplify the input");
  // Points are renamed in the order they go in, so that neighbours lie near in memory.
  std::vector<Index> names = {0, 1, 2, 3, 4, 5, 6, 7};
  const std::vector<Index> order =
      insertionOrder(points, kBoxCorners, Box{points.at(0), points.at(kBoxCorners - 1)});
  names.insert(names.end(), order.begin(), order.end());
  LargeVector<Vec3d> renamed(points.size());
  for (std::size_t i = 0; i < names.size(); ++i)
    renamed[i] = {points[names[i]][0] / grain, points[names[i]][1] / grain,
                  points[names[i]][2] / grain};

  Delaunay delaunay(std::move(renamed));
  constexpr std::size_t kPointsPerCheck = 4096;
  for (std::size_t i = kBoxCorners; i < points.size(); ++i) {
    if (i % kPointsPerCheck == 0)
      progress.check();
    delaunay.insert(static_cast<Index>(i));
  }
  return delaunay.take(names);
}

} // namespace tetvdb
