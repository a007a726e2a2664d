// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/SplitEdges.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/InsertPoint.h"
#include "tetvdb/tetrahedralize/complex/PlacePoint.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

struct LongEdge {
  double square;
  std::uint32_t a, b, tet;

  bool operator<(const LongEdge& other) const {
    return square != other.square ? square > other.square
           : a != other.a         ? a < other.a
           : b != other.b         ? b < other.b
                                  : tet < other.tet;
  }
  bool operator==(const LongEdge& other) const { return a == other.a && b == other.b; }
};

class EdgeSplitter {
public:
  EdgeSplitter(TetComplex& complex, const EdgeSizes& sizes) : complex_(complex), sizes_(sizes) {}

  /// At the midpoint, unless a tet gets worse than `energy` and than all tets around the edge.
  bool split(const LongEdge& edge, double energy) {
    const auto& tet = complex_.tets[edge.tet];
    const bool isThere = tet.exists() && tet.cornerOf(edge.a) < 4 && tet.cornerOf(edge.b) < 4;
    if (!gather(edge.a, edge.b, isThere ? edge.tet : TetComplex::kNone))
      return false;
    constexpr double kMaxWorse = 1.5;
    const double worst = worstAround();
    const Vec3d at = midpoint();
    const EnergyLimit limit(std::max(energy, kMaxWorse * worst));
    for (const PointStar::LinkFace& face : faces_)
      if (!limit.allows(at, face.a, face.b, face.c, face.weight))
        return false;
    put(at);
    return true;
  }

  /// The tet's edge whose split improves the worst tet most, if any improves it enough.
  bool splitBest(std::uint32_t t) {
    constexpr double kGain = 0.9;
    const auto corners = complex_.tets[t].corners;
    double best = 1;
    std::uint32_t bestA = TetComplex::kNone, bestB = TetComplex::kNone;
    Vec3d bestAt{0, 0, 0};
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned j = i + 1; j < 4; ++j) {
        if (!gather(corners[i], corners[j], t))
          continue;
        Vec3d at = midpoint();
        const double worst = worstAround();
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        double sum = sumOfCubes(faces_, at, kInfinity);
        if (sheets_ == 0 && sum < kInfinity)
          sum = descend(faces_, kInfinity, sum, at, [](Vec3d&) {});
        if (!(sum < kInfinity))
          continue;
        double now = 0;
        for (const PointStar::LinkFace& face : faces_)
          now = std::max(now, face.weight * energyCube(at, face.a, face.b, face.c));
        const double gain = std::cbrt(now) / worst;
        if (gain < best) {
          best = gain;
          bestA = corners[i];
          bestB = corners[j];
          bestAt = at;
        }
      }
    if (best > kGain)
      return false;
    gather(bestA, bestB, t);
    put(bestAt);
    return true;
  }

private:
  // What is around the edge; false where it is not all here.
  bool gather(std::uint32_t a, std::uint32_t b, std::uint32_t first) {
    if (!complex_.ring(a, b, around_, ring_, first)) {
      if (!around_.empty())
        for (const std::uint32_t point : {a, b})
          complex_.points[point].setChanged(kSplitChanged);
      return false;
    }
    a_ = a;
    b_ = b;
    faces_.clear();
    sheets_ = 0;
    for (const std::uint32_t t : around_) {
      const TetComplex::Tet& tet = complex_.tets[t];
      for (const unsigned localFace : {tet.cornerOf(a), tet.cornerOf(b)})
        faces_.push_back(PointStar::linkFace(complex_, tet, localFace));
      for (unsigned k = 0; k < 4; ++k)
        sheets_ += tet.tracked[k] && tet.corners[k] != a && tet.corners[k] != b;
    }
    return true;
  }

  double worstAround() {
    double worst = 0;
    for (const std::uint32_t around : around_)
      worst = std::max(worst, static_cast<double>(energyOf(complex_, around)));
    return worst;
  }

  Vec3d midpoint() const {
    return roundToLattice(times(plus(complex_.at(a_), complex_.at(b_)), 0.5));
  }

  void put(const Vec3d& at) {
    fresh_.clear();
    addEdgeHalves(complex_, around_, a_, b_, fresh_);
    TetComplex::Point point;
    const auto &a = complex_.points[a_], &b = complex_.points[b_];
    point.at = at;
    point.fineness = sizes_.finenessOf(sizes_.of(a, b)); // sizes grow linearly along an edge
    point.onBoundary =
        a.onBoundary && b.onBoundary && sheets_ == 2; // both tets of the only tracked face
    complex_.points.push_back(point);
    complex_.replace(around_, fresh_);
  }

  TetComplex& complex_;
  const EdgeSizes& sizes_;
  std::vector<std::uint32_t> around_, ring_;
  std::vector<TetComplex::NewTet> fresh_;
  std::vector<PointStar::LinkFace> faces_; // around the new point
  std::uint32_t a_ = 0, b_ = 0;
  std::size_t sheets_ = 0; // tracked faces at the edge, counted from both sides
};

LongEdge longEdge(const TetComplex& complex, std::uint32_t t, unsigned i, unsigned j) {
  const auto [a, b] = std::minmax(complex.tets[t].corners[i], complex.tets[t].corners[j]);
  const Vec3d edge = minus(complex.at(a), complex.at(b));
  return {dot(edge, edge), a, b, t};
}

std::size_t splitAll(TetComplex& complex, const EdgeSizes& sizes, std::vector<LongEdge>& edges,
                     double energy) {
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  EdgeSplitter splitter(complex, sizes);
  std::size_t splits = 0;
  for (const LongEdge& edge : edges)
    splits += splitter.split(edge, energy);
  return splits;
}

} // namespace

std::size_t splitEdges(TetComplex& complex, const EdgeSizes& sizes, double share, double energy) {
  std::vector<LongEdge> edges;
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t) {
    const TetComplex::Tet& tet = complex.tets[t];
    if (!tet.exists() || tet.weight < 1)
      continue;
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned j = i + 1; j < 4; ++j) {
        const LongEdge edge = longEdge(complex, t, i, j);
        const double longest = share * sizes.of(complex.points[edge.a], complex.points[edge.b]);
        if (edge.square > longest * longest)
          edges.push_back(edge);
      }
  }
  return splitAll(complex, sizes, edges, energy);
}

std::size_t splitBadTets(TetComplex& complex, const EdgeSizes& sizes, double energy) {
  const auto order = takeChangedTets(complex, kSplitChanged, energy, 0);
  EdgeSplitter splitter(complex, sizes);
  std::size_t splits = 0;
  for (const auto& [worst, t] : order)
    if (complex.tets[t].exists() && energyOf(complex, t) == worst)
      splits += splitter.splitBest(t);
  return splits;
}

} // namespace tetvdb
