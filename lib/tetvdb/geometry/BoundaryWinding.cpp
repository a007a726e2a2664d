// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/BoundaryWinding.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/SplitAlongAxis.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace tetvdb {
namespace {

constexpr std::size_t kLeafEdges = 8;
// Components of boundary edges with no more edges than this are never cut apart, so that they have
// no open ends: the edges of a single triangle.
constexpr std::size_t kWholePart = 8;
// A cluster with more open ends than this is opened instead of approximated by its moments.
constexpr std::size_t kMaxOpenEnds = 16;
// What one cluster seen from afar may be wrong by, as a winding number.
constexpr double kClusterError = 1e-5;
// Of many boundary edges (kManyBoundaryEdges), clusters this many radii outside their ball are
// approximated by moments; all their open ends are where the ray up from the centre is this many
// radii away, elsewhere up to a few.
constexpr double kRoughDistance = 1.5;
constexpr double kRoughRayDistance = 3;
constexpr std::size_t kMaxRoughOpenEnds = 8;

bool less(const LatticePoint& a, const LatticePoint& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}
bool earlier(const BoundaryEdge& e, const BoundaryEdge& f) {
  return std::tie(e.a.x, e.a.y, e.a.z, e.b.x, e.b.y, e.b.z, e.weight) <
         std::tie(f.a.x, f.a.y, f.a.z, f.b.x, f.b.y, f.b.z, f.weight);
}

double distanceToBox(const LatticePoint& p, const LatticePoint& low, const LatticePoint& high) {
  const auto outside = [](double x, double a, double b) { return std::max({a - x, x - b, 0.0}); };
  return length(
      {outside(p.x, low.x, high.x), outside(p.y, low.y, high.y), outside(p.z, low.z, high.z)});
}

// Angles (centre, open end, up) of clusters, collected for sumAngles().
class LooseAngles {
public:
  explicit LooseAngles(const LatticePoint& p) : p_(p) {}

  void add(const LatticePoint& centre, const LatticePoint& end, double weight) {
    if (count_ == kMax)
      flush();
    ends_.set(count_++, centre, end, weight);
  }
  double sum() {
    flush();
    return sum_;
  }

private:
  static constexpr std::size_t kMax = 64;
  void flush() {
    sum_ += sumAngles(ends_.view(), 0, count_, p_);
    count_ = 0;
  }
  LatticePoint p_;
  BoundaryEdgeBlock<kMax> ends_;
  std::size_t count_ = 0;
  double sum_ = 0;
};

// Components of boundary edges that share points, each named by its first edge.
std::vector<std::uint32_t> connectedParts(const std::vector<BoundaryEdge>& edges) {
  DisjointSets parts(edges.size());
  struct End {
    LatticePoint point;
    std::uint32_t edge;
  };
  std::vector<End> ends;
  ends.reserve(2 * edges.size());
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    ends.push_back({edges[i].a, i});
    ends.push_back({edges[i].b, i});
  }
  std::sort(ends.begin(), ends.end(), [](const End& e, const End& f) {
    return std::tie(e.point.x, e.point.y, e.point.z, e.edge) <
           std::tie(f.point.x, f.point.y, f.point.z, f.edge);
  });
  for (std::size_t i = 1; i < ends.size(); ++i)
    if (!less(ends[i - 1].point, ends[i].point))
      parts.join(ends[i - 1].edge, ends[i].edge);
  std::vector<std::uint32_t> part(edges.size());
  for (std::uint32_t i = 0; i < edges.size(); ++i)
    part[i] = parts.find(i);
  return part;
}

} // namespace

// What the tree's build moves about: an edge, or a small component of edges as a whole.
struct BoundaryWinding::Item {
  std::vector<std::uint32_t> edges;
  Vec3d midpoint;
};

BoundaryWinding::BoundaryWinding(std::vector<BoundaryEdge> edges) {
  std::sort(edges.begin(), edges.end(), earlier);
  const std::vector<std::uint32_t> part = connectedParts(edges);
  std::vector<std::uint32_t> size(edges.size(), 0);
  for (const std::uint32_t p : part)
    ++size[p];
  std::vector<Item> items;
  std::vector<std::uint32_t> itemOf(edges.size());
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    const BoundaryEdge& e = edges[i];
    if (size[part[i]] <= kWholePart && part[i] != i) {
      items[itemOf[part[i]]].edges.push_back(i);
      continue;
    }
    itemOf[i] = static_cast<std::uint32_t>(items.size());
    items.push_back({{i}, {(e.a.x + e.b.x) / 2, (e.a.y + e.b.y) / 2, (e.a.z + e.b.z) / 2}});
  }
  if (items.empty())
    return;
  nodes_.reserve(items.size());
  build(items.data(), items.data() + items.size(), edges);
}

void BoundaryWinding::build(Item* begin, Item* end, const std::vector<BoundaryEdge>& edges) {
  const std::size_t index = nodes_.size();
  nodes_.emplace_back();
  Node node{};
  node.begin = static_cast<std::uint32_t>(edges_.size());
  std::size_t count = 0;
  for (const Item* item = begin; item != end; ++item)
    count += item->edges.size();
  node.leaf = count <= kLeafEdges || end - begin == 1;
  if (node.leaf) {
    for (const Item* item = begin; item != end; ++item)
      for (const std::uint32_t e : item->edges)
        edges_.push(edges[e].a, edges[e].b, edges[e].weight);
  } else {
    const auto position = [](const Item& item) -> const Vec3d& { return item.midpoint; };
    Item* const midpoint = begin + (end - begin) / 2;
    splitAlongAxis(longestAxis(begin, end, position), begin, midpoint, end, position,
                   [](const Item& item) { return item.edges[0]; });
    build(begin, midpoint, edges);
    build(midpoint, end, edges);
  }
  node.end = static_cast<std::uint32_t>(edges_.size());
  fillMoments(node);
  fillOpenEnds(node);
  node.skip = static_cast<std::uint32_t>(nodes_.size());
  nodes_[index] = node;
}

void BoundaryWinding::fillMoments(Node& node) const {
  const double inf = std::numeric_limits<double>::infinity();
  node.boxMin = {inf, inf, inf};
  node.boxMax = {-inf, -inf, -inf};
  for (std::uint32_t i = node.begin; i != node.end; ++i)
    for (const LatticePoint& p : {edges_.a(i), edges_.b(i)}) {
      node.boxMin = {std::min(node.boxMin.x, p.x), std::min(node.boxMin.y, p.y),
                     std::min(node.boxMin.z, p.z)};
      node.boxMax = {std::max(node.boxMax.x, p.x), std::max(node.boxMax.y, p.y),
                     std::max(node.boxMax.z, p.z)};
    }
  node.centre = {std::floor((node.boxMin.x + node.boxMax.x) / 2),
                 std::floor((node.boxMin.y + node.boxMax.y) / 2),
                 std::floor((node.boxMin.z + node.boxMax.z) / 2)};
  for (std::uint32_t i = node.begin; i != node.end; ++i) {
    const Vec3d a = from(node.centre, edges_.a(i)), b = from(node.centre, edges_.b(i));
    const double weight = edges_.weight[i];
    const Vec3d sum = plus(a, b);
    node.cone.add({0, 0, 0}, a, b, weight);
    node.radius = std::max({node.radius, length(a), length(b)});
    node.area += length(cross(a, b)) / 2 * std::abs(weight);
    node.length += length(from(edges_.a(i), edges_.b(i))) * std::abs(weight);
    for (std::size_t k = 0; k < 3; ++k) {
      const double edge = (b[k] - a[k]) * weight;
      node.way[k] += edge;
      for (std::size_t l = 0; l < 3; ++l)
        node.current[3 * k + l] += edge * sum[l] / 2;
    }
  }
}

void BoundaryWinding::fillOpenEnds(Node& node) {
  node.looseBegin = static_cast<std::uint32_t>(openEnds_.size());
  std::vector<OpenEnd> ends;
  for (std::uint32_t i = node.begin; i != node.end; ++i) {
    const auto weight = static_cast<std::int32_t>(edges_.weight[i]);
    ends.push_back({edges_.b(i), weight});
    ends.push_back({edges_.a(i), -weight});
  }
  std::sort(ends.begin(), ends.end(),
            [](const OpenEnd& e, const OpenEnd& f) { return less(e.point, f.point); });
  for (std::size_t i = 0; i < ends.size();) {
    OpenEnd sum{ends[i].point, 0};
    for (; i < ends.size() && !less(sum.point, ends[i].point); ++i)
      sum.weight += ends[i].weight;
    if (sum.weight == 0)
      continue;
    openEnds_.push_back(sum);
    node.ends.add(from(node.centre, sum.point), sum.weight);
  }
  node.openEnd = static_cast<std::uint32_t>(openEnds_.size());
}

// Traverses the tree: clusters for which far(node) holds are done with, the edges of the others are
// handed to near(begin, end), in as few pieces as they lie together.
template <typename Far, typename Near>
void BoundaryWinding::walk(const Far& far, const Near& near) const {
  const auto count = static_cast<std::uint32_t>(nodes_.size());
  std::uint32_t begin = 0, end = 0;
  for (std::uint32_t index = 0; index < count;) {
    const Node& node = nodes_[index];
    if (far(node)) {
      index = node.skip;
    } else if (node.leaf) {
      if (node.begin != end) {
        if (begin != end)
          near(begin, end);
        begin = node.begin;
      }
      end = node.end;
      index = node.skip;
    } else {
      ++index;
    }
  }
  if (begin != end)
    near(begin, end);
}

// How often the cluster's edges, with its open ends joined to its centre, go around p seen along
// z: signed crossings of a ray from p in direction x. p represents (p.x + e, p.y + e^2).
std::int64_t BoundaryWinding::turnsAround(const Node& cluster, const LatticePoint& p) const {
  double turns = 0;
  const auto isAbove = [&](const LatticePoint& q) { return q.y > p.y; };
  const auto cross = [&](const LatticePoint& a, const LatticePoint& b, double weight) {
    if (isAbove(a) == isAbove(b))
      return;
    const double side = turn({a.x - p.x, a.y - p.y, a.z - p.z}, {b.x - p.x, b.y - p.y, b.z - p.z});
    if (isAbove(b) ? side > 0 : side < 0)
      turns += isAbove(b) ? weight : -weight;
  };
  const auto loose = [&](const Node& node, const auto& visit) {
    for (std::uint32_t i = node.looseBegin; i != node.openEnd; ++i)
      visit(openEnds_[i]);
  };
  loose(cluster, [&](const OpenEnd& end) { cross(end.point, cluster.centre, end.weight); });
  const auto first = static_cast<std::uint32_t>(&cluster - nodes_.data());
  for (std::uint32_t index = first; index < cluster.skip;) {
    const Node& node = nodes_[index];
    if (node.boxMax.y <= p.y || node.boxMin.y > p.y || node.boxMax.x < p.x) {
      index = node.skip;
    } else if (node.boxMin.x > p.x) {
      // Every crossing counts, so that all but the open ends cancel.
      loose(node, [&](const OpenEnd& end) { turns += isAbove(end.point) ? end.weight : 0; });
      index = node.skip;
    } else if (node.leaf) {
      for (std::uint32_t i = node.begin; i != node.end; ++i)
        cross(edges_.a(i), edges_.b(i), edges_.weight[i]);
      index = node.skip;
    } else {
      ++index;
    }
  }
  return static_cast<std::int64_t>(turns);
}

// How a cluster looks from points within `reach` of one that sees its centre at r.
BoundaryWinding::View BoundaryWinding::viewOf(const Node& node, const Vec3d& r,
                                              double reach) const {
  const double away = length(r), distance = away - node.radius - reach;
  if (!(distance > 0))
    return View::Edges;
  const std::size_t loose = node.openEnd - node.looseBegin;
  if (rough()) {
    if (!(distance > kRoughDistance * node.radius))
      return View::Edges;
    const double ray = (r[2] < 0 ? length({r[0], r[1], 0}) : away) - reach;
    if (loose == 0 || ray > kRoughRayDistance * node.radius)
      return View::Moments;
    return loose <= kMaxRoughOpenEnds ? View::OpenEnds : View::Edges;
  }
  // The remainder: third derivatives of r / |r|^3 are at most 24 / |r|^5; over 3! and 4 pi.
  const double cube = node.radius * node.radius * node.radius, square = distance * distance;
  const bool small = node.area * cube < kClusterError * kPi * square * square * distance;
  return small && loose <= kMaxOpenEnds ? View::OpenEnds : View::Edges;
}

// A cluster's angles fall short of 4 pi where its cone passes straight below the point.
double BoundaryWinding::at(const LatticePoint& p) const {
  double angle = 0;
  LooseAngles loose(p);
  walk(
      [&](const Node& node) {
        const Vec3d r = from(p, node.centre);
        const View view = viewOf(node, r, 0);
        if (view == View::Edges)
          return false;
        const bool above = p.x >= node.boxMin.x && p.x <= node.boxMax.x && p.y >= node.boxMin.y &&
                           p.y <= node.boxMax.y && p.z >= node.boxMin.z;
        if (above)
          angle += 4 * kPi * static_cast<double>(turnsAround(node, p));
        angle += node.cone.angle(r);
        if (view == View::Moments)
          angle += node.ends.angle(r);
        else
          for (std::uint32_t i = node.looseBegin; i != node.openEnd; ++i)
            loose.add(node.centre, openEnds_[i].point, openEnds_[i].weight);
        return true;
      },
      [&](std::uint32_t begin, std::uint32_t end) {
        angle += sumAngles(edges_.view(), begin, end, p);
      });
  return (angle + loose.sum()) / (4 * kPi);
}

template <typename Moments>
TETVDB_INLINE void BoundaryWinding::addMoments(const LatticePoint& centre, const Moments& moments,
                                               BoundaryPoints& points) {
  const std::size_t n = points.size();
  const double *x = points.x.data(), *y = points.y.data(), *z = points.z.data();
  double* sum = points.sum.data();
  for (std::size_t i = 0; i < n; ++i)
    sum[i] += moments.angle({centre.x - x[i], centre.y - y[i], centre.z - z[i]});
}

TETVDB_MULTIVERSION
void BoundaryWinding::addCone(const Node& node, BoundaryPoints& points) {
  addMoments(node.centre, node.cone, points);
}

TETVDB_MULTIVERSION
void BoundaryWinding::addEnds(const Node& node, BoundaryPoints& points) {
  addMoments(node.centre, node.ends, points);
}

void BoundaryWinding::at(const LatticePoint& centre, double reach, BoundaryPoints& points) const {
  points.sum.assign(points.size(), 0);
  std::vector<double> scratch(points.size());
  double turns = 0;
  walk(
      [&](const Node& node) {
        const View view = viewOf(node, from(centre, node.centre), reach);
        if (view == View::Edges)
          return false;
        const bool above = centre.x + reach >= node.boxMin.x && centre.x - reach <= node.boxMax.x &&
                           centre.y + reach >= node.boxMin.y && centre.y - reach <= node.boxMax.y &&
                           centre.z + reach >= node.boxMin.z;
        if (above)
          for (std::size_t i = 0; i < points.size(); ++i) {
            const bool sameColumn =
                i > 0 && points.x[i] == points.x[i - 1] && points.y[i] == points.y[i - 1];
            if (!sameColumn)
              turns =
                  4 * kPi *
                  static_cast<double>(turnsAround(node, {points.x[i], points.y[i], points.z[i]}));
            points.sum[i] += turns;
          }
        addCone(node, points);
        if (view == View::Moments)
          addEnds(node, points);
        else
          for (std::uint32_t i = node.looseBegin; i != node.openEnd; ++i)
            addAngles(node.centre, openEnds_[i].point, openEnds_[i].weight, points, scratch);
        return true;
      },
      [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i != end; ++i)
          addAngles(edges_.a(i), edges_.b(i), edges_.weight[i], points, scratch);
      });
  for (double& sum : points.sum)
    sum /= 4 * kPi;
}

// To first order in the edges' places within the cluster, r = R + y: the integral of
// r x dl / |r|^3 = R x way / R^3 + sum over j of (d/dR_j (R / R^3)) x (sum of dl y_j).
Vec3d BoundaryWinding::fieldFromAfar(const Node& node, const Vec3d& r) {
  const double inverse = 1 / length(r);
  const double i2 = inverse * inverse, i3 = i2 * inverse;
  Vec3d field = cross(r, node.way);
  for (double& c : field)
    c *= i3;
  for (std::size_t j = 0; j < 3; ++j) {
    Vec3d change{0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k)
      change[k] = ((k == j ? 1.0 : 0.0) - 3 * r[j] * r[k] * i2) * i3;
    const Vec3d part = cross(change, {node.current[j], node.current[3 + j], node.current[6 + j]});
    for (std::size_t k = 0; k < 3; ++k)
      field[k] += part[k];
  }
  return field;
}

// The edges of such a soup run in all directions: their shares add up like errors, not like sizes.
double BoundaryWinding::bend(const LatticePoint& centre, double reach) const {
  double sum = 0, squares = 0;
  const auto add = [&](double share) {
    sum += share;
    squares += share * share;
  };
  walk(
      [&](const Node& node) {
        const double distance = distanceToBox(centre, node.boxMin, node.boxMax) - reach;
        if (!(distance > 3 * node.radius))
          return !std::isfinite(sum);
        add(2 * node.length / (distance * distance * distance));
        return true;
      },
      [&](std::uint32_t begin, std::uint32_t end) {
        add(sumBend(edges_.view(), begin, end, centre, reach));
      });
  return (rough() ? std::sqrt(squares) : sum) / (4 * kPi);
}

BoundaryWinding::Slope BoundaryWinding::slope(const LatticePoint& centre, double reach) const {
  Slope slope;
  slope.bend = bend(centre, reach);
  if (!std::isfinite(slope.bend))
    return slope;
  const auto add = [&](const Vec3d& field) {
    for (std::size_t k = 0; k < 3; ++k)
      slope.gradient[k] += field[k] / (4 * kPi);
  };
  walk(
      [&](const Node& node) {
        const Vec3d r = from(centre, node.centre);
        const double distance = length(r) - node.radius;
        // Second derivatives of r / |r|^3 are at most 6 / |r|^4, over 2!.
        const double square = distance * distance;
        const double error =
            3 * node.length * node.radius * node.radius / (square * square) / (4 * kPi);
        // Small beside what the bend leaves open.
        if (!(distance > 0 && error < 0.02 * slope.bend * reach))
          return false;
        add(fieldFromAfar(node, r));
        slope.error += error;
        return true;
      },
      [&](std::uint32_t begin, std::uint32_t end) {
        add(sumField(edges_.view(), begin, end, centre));
      });
  return slope;
}

double halfCrossing(double from, double to) {
  to += std::round(from - to);
  const double half = std::round((from + to) / 2 - 0.5) + 0.5;
  return from == to ? 0.5 : std::clamp((half - from) / (to - from), 0.0, 1.0);
}

} // namespace tetvdb
