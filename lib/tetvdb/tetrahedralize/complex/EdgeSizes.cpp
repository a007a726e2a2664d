// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/EdgeSizes.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

struct Edge {
  std::uint32_t a, b;
  bool operator<(const Edge& other) const { return a != other.a ? a < other.a : b < other.b; }
  bool operator==(const Edge& other) const { return a == other.a && b == other.b; }
};

double lengthOf(const TetComplex& complex, std::uint32_t a, std::uint32_t b) {
  return length(minus(complex.at(a), complex.at(b)));
}

// About how many tets of weight 1 edges of these sizes lead to, none below `floor`: regular ones,
// whose edges are a tenth shorter than asked for.
double tetsOf(const TetComplex& complex, const std::vector<double>& sizes, double floor) {
  constexpr double kTetsACube = 6 * 1.41421356 * 1.1 * 1.1 * 1.1;
  double sum = 0;
  for (const TetComplex::Tet& tet : complex.tets) {
    if (!tet.exists() || tet.weight < 1)
      continue;
    const auto& [a, b, c, d] = tet.corners;
    const Vec3d& at = complex.at(a);
    const double volume = std::abs(dot(minus(complex.at(b), at),
                                       cross(minus(complex.at(c), at), minus(complex.at(d), at)))) /
                          6;
    double size = 0;
    for (const std::uint32_t corner : tet.corners)
      size += std::max(floor, sizes[corner]) / 4;
    sum += std::max(1.0, kTetsACube * volume / (size * size * size));
  }
  return sum;
}

} // namespace

EdgeSizes::EdgeSizes(double longest) : lengths_{} {
  constexpr double kStepsAnOctave = 12;
  for (std::size_t i = 0; i < lengths_.size(); ++i)
    lengths_[i] = longest * std::exp2(-static_cast<double>(i) / kStepsAnOctave);
}

std::uint8_t EdgeSizes::finenessOf(double length) const {
  const auto found = std::lower_bound(lengths_.begin(), lengths_.end() - 1, length,
                                      [](double a, double b) { return a > b; });
  return static_cast<std::uint8_t>(found - lengths_.begin());
}

void EdgeSizes::followSurface(TetComplex& complex, double share, double growth,
                              double mostTets) const {
  std::vector<Edge> edges; // in both directions
  for (const TetComplex::Tet& tet : complex.tets) {
    if (!tet.exists() || tet.weight < 1)
      continue;
    for (unsigned i = 0; i < 4; ++i)
      for (unsigned j = 0; j < 4; ++j) {
        if (i == j)
          continue;
        const auto [k, l] = kEdgeOthers[i][j];
        if (tet.tracked[k] || tet.tracked[l])
          edges.push_back({tet.corners[i], tet.corners[j]});
      }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<double> sizes(complex.points.size(), longest());
  for (std::size_t i = 0, next; i < edges.size(); i = next) {
    double sum = 0;
    for (next = i; next < edges.size() && edges[next].a == edges[i].a; ++next)
      sum += lengthOf(complex, edges[next].a, edges[next].b);
    sizes[edges[i].a] = std::min(longest(), share * sum / static_cast<double>(next - i));
  }
  spread(complex, sizes, growth);
  double floor = 0;
  if (tetsOf(complex, sizes, floor) > mostTets)
    floor = *(std::partition_point(
                  lengths_.begin(), lengths_.end(),
                  [&](double length) { return tetsOf(complex, sizes, length) <= mostTets; }) -
              1);
  for (double& size : sizes)
    size = std::max(size, floor);
  assign(complex, sizes);
}

bool EdgeSizes::refine(TetComplex& complex, double energy, double share, double growth,
                       double shortest, double mostTets) const {
  std::vector<double> sizes(complex.points.size(), longest());
  for (std::size_t p = 0; p < sizes.size(); ++p)
    sizes[p] = at(complex.points[p]);
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t) {
    const TetComplex::Tet& tet = complex.tets[t];
    if (!tet.exists() || tet.weight < 1 || energyOf(complex, t) <= energy)
      continue;
    double sum = 0;
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned j = i + 1; j < 4; ++j)
        sum += lengthOf(complex, tet.corners[i], tet.corners[j]);
    for (const std::uint32_t corner : tet.corners)
      sizes[corner] = std::min(sizes[corner], std::max(shortest, share * sum / 6));
  }
  spread(complex, sizes, growth);
  if (tetsOf(complex, sizes, 0) > mostTets)
    return false;
  assign(complex, sizes);
  return true;
}

void EdgeSizes::spread(const TetComplex& complex, std::vector<double>& sizes, double growth) const {
  using Item = std::pair<double, std::uint32_t>;
  std::priority_queue<Item, std::vector<Item>, std::greater<Item>> open;
  for (std::uint32_t p = 0; p < sizes.size(); ++p)
    if (complex.points[p].exists() && sizes[p] < longest())
      open.push({sizes[p], p});
  std::vector<std::uint32_t> star;
  while (!open.empty()) {
    const auto [size, p] = open.top();
    open.pop();
    if (size > sizes[p])
      continue;
    complex.star(p, star);
    for (const std::uint32_t t : star) {
      if (complex.tets[t].weight < 1)
        continue;
      for (const std::uint32_t q : complex.tets[t].corners) {
        const double next = size + growth * lengthOf(complex, p, q);
        if (next < sizes[q]) {
          sizes[q] = next;
          open.push({next, q});
        }
      }
    }
  }
}

void EdgeSizes::assign(TetComplex& complex, const std::vector<double>& sizes) const {
  for (std::size_t p = 0; p < sizes.size(); ++p) {
    TetComplex::Point& point = complex.points[p];
    const std::uint8_t fineness = finenessOf(sizes[p]);
    if (point.fineness != fineness)
      point.changed = 0xFF;
    point.fineness = fineness;
  }
}

} // namespace tetvdb
