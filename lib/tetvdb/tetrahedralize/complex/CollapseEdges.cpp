// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/CollapseEdges.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/SheetEdge.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

// A point of high valence has many edges and each of them many tets: only the shortest are tried.
constexpr std::size_t kManyTets = 200, kFewSpokes = 16;

} // namespace

std::size_t EdgeCollapser::sweep() {
  std::vector<float> shortest(complex_.points.size(), std::numeric_limits<float>::infinity());
  for (const TetComplex::Tet& tet : complex_.tets) {
    if (!tet.exists())
      continue;
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned j = i + 1; j < 4; ++j) {
        const std::uint32_t a = tet.corners[i], b = tet.corners[j];
        const Vec3d edge = minus(complex_.at(a), complex_.at(b));
        const auto square = static_cast<float>(dot(edge, edge));
        shortest[a] = std::min(shortest[a], square);
        shortest[b] = std::min(shortest[b], square);
      }
  }
  std::vector<std::pair<float, std::uint32_t>> order;
  for (std::uint32_t p = 0; p < complex_.points.size(); ++p) {
    const TetComplex::Point& point = complex_.points[p];
    if (point.exists() && !point.fixed && (point.changed & kChanged))
      order.push_back({shortest[p], p});
  }
  std::sort(order.begin(), order.end());
  std::size_t gone = 0;
  for (const auto& [square, p] : order)
    gone += collapsePoint(p);
  return gone;
}

bool EdgeCollapser::collapsePoint(std::uint32_t from) {
  TetComplex::Point& point = complex_.points[from];
  star_.gather(complex_, from);
  order_ = star_.spokes();
  if (star_.onSurface())
    order_.erase(std::remove_if(order_.begin(), order_.end(),
                                [](const PointStar::Spoke& spoke) { return spoke.sheets == 0; }),
                 order_.end());
  if (rules_.sizes != nullptr)
    order_.erase(std::remove_if(order_.begin(), order_.end(),
                                [&](const PointStar::Spoke& spoke) {
                                  const double longest =
                                      rules_.longest *
                                      rules_.sizes->of(point, complex_.points[spoke.point]);
                                  return spoke.square > longest * longest;
                                }),
                 order_.end());
  const auto isBefore = [](const PointStar::Spoke& a, const PointStar::Spoke& b) {
    return a.square != b.square ? a.square < b.square : a.point < b.point;
  };
  std::sort(order_.begin(), order_.end(), isBefore);
  if (star_.tets().size() > kManyTets && order_.size() > kFewSpokes)
    order_.resize(kFewSpokes);
  bool final = true;
  for (const PointStar::Spoke& spoke : order_) {
    ++tried_;
    const Answer answer = mayCollapse(spoke.point);
    if (answer == Answer::Yes) {
      complex_.collapse(from, spoke.point, star_.tets());
      return true;
    }
    final = final && answer == Answer::No;
  }
  if (final)
    point.clearChanged(kChanged);
  return false;
}

EdgeCollapser::Answer EdgeCollapser::mayCollapse(std::uint32_t to) {
  if (rules_.sizes != nullptr && makesLong(to))
    return Answer::No;
  if (!isShapely(to))
    return Answer::No;
  if (!star_.onSurface())
    return Answer::Yes;
  const auto spoke = std::find_if(star_.spokes().begin(), star_.spokes().end(),
                                  [to](const PointStar::Spoke& s) { return s.point == to; });
  if (!followsCurve(to, spoke->sheets))
    return Answer::No;
  const Answer topology = keepsTopology(to);
  if (topology != Answer::Yes)
    return topology;
  return guard_.allows(complex_, star_, complex_.at(to), to) ? Answer::Yes : Answer::No;
}

bool EdgeCollapser::makesLong(std::uint32_t to) const {
  for (const PointStar::Spoke& spoke : star_.spokes()) {
    const Vec3d edge = minus(complex_.at(to), complex_.at(spoke.point));
    const double longest =
        rules_.longestNew * rules_.sizes->of(complex_.points[to], complex_.points[spoke.point]);
    if (dot(edge, edge) > longest * longest)
      return true;
  }
  return false;
}

bool EdgeCollapser::isShapely(std::uint32_t to) const {
  const EnergyLimit limit(std::max(rules_.energy, star_.worstEnergy()));
  const Vec3d& at = complex_.at(to);
  for (const PointStar::LinkFace& face : star_.faces()) {
    if (face.corners[0] == to || face.corners[1] == to || face.corners[2] == to)
      continue;
    if (!limit.allows(at, face.a, face.b, face.c, face.weight))
      return false;
  }
  return true;
}

// Edges with one tracked face are boundary edges, at edges with three and more sheets meet; both
// form curves, whose end points and branching points stay.
bool EdgeCollapser::followsCurve(std::uint32_t to, std::uint32_t toSheets) const {
  std::size_t onCurve = 0;
  std::uint32_t kind = 2, far = to;
  for (const PointStar::Spoke& spoke : star_.spokes()) {
    if (spoke.sheets == 0 || spoke.sheets == 2)
      continue;
    if (++onCurve > 2 || (kind != 2 && spoke.sheets != kind))
      return false;
    kind = spoke.sheets;
    if (spoke.point != to)
      far = spoke.point;
  }
  if (onCurve == 0)
    return !complex_.points[star_.point()].onBoundary;
  if (onCurve != 2 || toSheets != kind)
    return false;
  if (!complex_.points[star_.point()].onBoundary)
    return true;
  return kind == 1 && complex_.points[to].onBoundary && complex_.points[far].onBoundary &&
         bounds_.boundary.contains(complex_.at(to), complex_.at(far), bounds_.radius);
}

EdgeCollapser::Answer EdgeCollapser::keepsTopology(std::uint32_t to) {
  const std::uint32_t from = star_.point();
  for (const std::uint32_t t : star_.tets()) {
    const TetComplex::Tet& tet = complex_.tets[t];
    const unsigned j = tet.cornerOf(to);
    if (j == 4)
      continue;
    const unsigned i = tet.cornerOf(from);
    if (tet.tracked[j]) {
      if (tet.tracked[i])
        return Answer::No;
      if (tet.neighbours[i] >= TetComplex::kElsewhere)
        return Answer::NotHere;
    }
    // Where (from, x) and (to, x) are edges of tracked faces, (from, to, x) is one of them.
    for (unsigned k = 0; k < 4; ++k) {
      if (k == i || k == j || tet.tracked[6 - i - j - k])
        continue;
      const std::uint32_t x = tet.corners[k];
      bool isEdge = false;
      for (const PointStar::Sheet& sheet : star_.sheets())
        isEdge = isEdge || sheet.p == x || sheet.q == x;
      if (!isEdge)
        continue;
      const OnSheet other = edgeOnSheet(complex_, to, x, t);
      if (other != OnSheet::No)
        return other == OnSheet::Yes ? Answer::No : Answer::NotHere;
    }
  }
  return Answer::Yes;
}

} // namespace tetvdb
