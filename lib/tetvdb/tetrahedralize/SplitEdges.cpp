// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/SplitEdges.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <array>
#include <cstdint>
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
  explicit EdgeSplitter(TetComplex& complex) : complex_(complex) {}

  bool split(const LongEdge& edge) {
    const auto& tet = complex_.tets[edge.tet];
    const bool isThere = tet.exists() && tet.cornerOf(edge.a) < 4 && tet.cornerOf(edge.b) < 4;
    if (!complex_.ring(edge.a, edge.b, around_, ring_, isThere ? edge.tet : TetComplex::kNone))
      return false;
    const Vec3d middle = roundToLattice(times(plus(complex_.at(edge.a), complex_.at(edge.b)), 0.5));
    const auto newPoint = static_cast<std::uint32_t>(complex_.points.size());
    fresh_.clear();
    std::size_t sheets = 0;
    for (const std::uint32_t t : around_) {
      const TetComplex::Tet& old = complex_.tets[t];
      const unsigned i = old.cornerOf(edge.a), j = old.cornerOf(edge.b);
      for (const unsigned replaced : {i, j}) {
        TetComplex::NewTet one;
        one.corners = old.corners;
        one.corners[replaced] = newPoint;
        if (!isPositive(one.corners, newPoint, middle))
          return false;
        for (unsigned k = 0; k < 4; ++k)
          if (k != i && k != j) {
            one.chains[k] = old.chains[k];
            one.tracked[k] = old.tracked[k];
          }
        fresh_.push_back(one);
      }
      for (unsigned k = 0; k < 4; ++k)
        sheets += k != i && k != j && old.tracked[k];
    }
    TetComplex::Point point;
    const auto &a = complex_.points[edge.a], &b = complex_.points[edge.b];
    point.at = middle;
    point.spacing = (a.spacing + b.spacing) / 2;
    point.rim = a.rim && b.rim && sheets == 2; // both tets of the only tracked face
    complex_.points.push_back(point);
    complex_.replace(around_, fresh_);
    return true;
  }

private:
  bool isPositive(const std::array<std::uint32_t, 4>& corners, std::uint32_t newPoint,
                  const Vec3d& middle) const {
    std::array<Vec3d, 4> at;
    for (std::size_t i = 0; i < 4; ++i)
      at[i] = corners[i] == newPoint ? middle : complex_.at(corners[i]);
    return latticeOrientation(at[0], at[1], at[2], at[3]) > 0;
  }

  TetComplex& complex_;
  std::vector<std::uint32_t> around_, ring_;
  std::vector<TetComplex::NewTet> fresh_;
};

} // namespace

std::size_t splitEdges(TetComplex& complex, double longest) {
  std::vector<LongEdge> edges;
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t) {
    const TetComplex::Tet& tet = complex.tets[t];
    if (!tet.exists())
      continue;
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned j = i + 1; j < 4; ++j) {
        const auto [a, b] = std::minmax(tet.corners[i], tet.corners[j]);
        const Vec3d edge = minus(complex.at(a), complex.at(b));
        const double square = dot(edge, edge);
        const double most = longest / 2 * (complex.points[a].spacing + complex.points[b].spacing);
        if (square > most * most)
          edges.push_back({square, a, b, t});
      }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  EdgeSplitter splitter(complex);
  std::size_t splits = 0;
  for (const LongEdge& edge : edges)
    splits += splitter.split(edge);
  return splits;
}

} // namespace tetvdb
