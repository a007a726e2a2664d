// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/RimWinding.h"

#include "tetvdb/geometry/Exact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace tetvdb {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kLeafEdges = 4;
// Parts of the rim with no more edges than this are never cut apart, so that they have no loose
// ends: the rim of a single triangle.
constexpr std::size_t kWholePart = 8;
// A cluster with more loose ends than this is opened instead of looked at from afar.
constexpr std::size_t kMaxLooseEnds = 16;
// What one cluster seen from afar may be wrong by, as a winding number.
constexpr double kClusterError = 1e-7;

using Vector = std::array<double, 3>;

Vector from(const LatticePoint& p, const LatticePoint& q) {
  return {q.x - p.x, q.y - p.y, q.z - p.z};
}
double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double norm(const Vector& a) {
  return std::sqrt(dot(a, a));
}
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

bool less(const LatticePoint& a, const LatticePoint& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}
bool earlier(const RimEdge& e, const RimEdge& f) {
  return std::tie(e.a.x, e.a.y, e.a.z, e.b.x, e.b.y, e.b.z, e.weight) <
         std::tie(f.a.x, f.a.y, f.a.z, f.b.x, f.b.y, f.b.z, f.weight);
}

// a.x b.y - a.y b.x, with the sign that it has once the point that both are seen from is moved by
// (e, e^2, e^3). Components are whole numbers below 2^53.
double turn(const Vector& a, const Vector& b) {
  const double left = a[0] * b[1], right = a[1] * b[0];
  const double difference = left - right;
  if (std::abs(difference) > 4.5e-16 * (std::abs(left) + std::abs(right)))
    return difference;
  const Int128 exact =
      static_cast<Int128>(static_cast<std::int64_t>(a[0])) * static_cast<std::int64_t>(b[1]) -
      static_cast<Int128>(static_cast<std::int64_t>(a[1])) * static_cast<std::int64_t>(b[0]);
  if (exact != 0)
    return static_cast<double>(exact);
  // (a.x - e)(b.y - e^2) - (a.y - e^2)(b.x - e): the terms of first order in e, then in e^2.
  const double first = a[1] - b[1];
  const double leading = first != 0 ? first : b[0] - a[0];
  return leading == 0 ? 0.0 : std::copysign(std::numeric_limits<double>::min(), leading);
}

// angleUp() for an end a straight below the point. Moved by (e, e^2, e^3) the point sees a in
// direction (-e, -e^2) from the pole: a lune from there to b.
double angleFromPole(const Vector& b) {
  const double sine = b[1] != 0 ? -b[1] : std::copysign(0.0, b[0]);
  return 2 * std::atan2(sine, -b[0]);
}

bool isZero(const Vector& a) {
  return a[0] == 0 && a[1] == 0 && a[2] == 0;
}

// Whether the point lies on the open segment between a and b.
bool isBetween(const Vector& a, const Vector& b) {
  if (dot(a, b) >= 0)
    return false;
  const auto product = [&](std::size_t i, std::size_t j) {
    return static_cast<Int128>(static_cast<std::int64_t>(a[i])) * static_cast<std::int64_t>(b[j]);
  };
  return product(0, 1) == product(1, 0) && product(1, 2) == product(2, 1) &&
         product(2, 0) == product(0, 2);
}

// angleUp() for a point on the edge from a to b: moved by (e, e^2, e^3) it sees the edge as half a
// great circle through the direction back, and up is at an angle to that half plane.
double angleOnEdge(const Vector& a, const Vector& b) {
  Vector t{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const double length = norm(t);
  for (double& c : t)
    c /= length;
  const bool alongX = t[1] == 0 && t[2] == 0;
  const Vector moved = alongX ? Vector{0, 1, 0} : Vector{1, 0, 0};
  Vector back{0, 0, 0}, up{0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    back[k] = dot(moved, t) * t[k] - moved[k];
    up[k] = (k == 2 ? 1.0 : 0.0) - t[2] * t[k];
  }
  return -2 * std::atan2(dot(t, cross(back, up)), dot(back, up));
}

// Solid angle of the spherical triangle of directions a, b and straight up (Van Oosterom and
// Strackee 1983, with one corner at infinity).
double angleUp(const Vector& a, const Vector& b) {
  if (isZero(a)) // seen from (e, e^2, e^3) the end lies in direction -x
    return isZero(b) ? 0.0 : angleUp({-1, 0, 0}, b);
  if (isZero(b))
    return -angleUp({-1, 0, 0}, a);
  const double sine = turn(a, b);
  if (sine == 0)
    return 0; // an edge straight up and down has no curtain
  if (a[0] == 0 && a[1] == 0)
    return a[2] < 0 ? angleFromPole(b) : 0.0;
  if (b[0] == 0 && b[1] == 0)
    return b[2] < 0 ? -angleFromPole(a) : 0.0;
  const double la = norm(a), lb = norm(b);
  const double cosine = la * lb + dot(a, b) + lb * a[2] + la * b[2];
  if (std::abs(sine) + std::abs(cosine) < 1e-9 * la * lb && isBetween(a, b))
    return angleOnEdge(a, b);
  return 2 * std::atan2(sine, cosine);
}

double distanceToBox(const LatticePoint& p, const LatticePoint& low, const LatticePoint& high) {
  const auto outside = [](double x, double a, double b) { return std::max({a - x, x - b, 0.0}); };
  return norm(
      {outside(p.x, low.x, high.x), outside(p.y, low.y, high.y), outside(p.z, low.z, high.z)});
}

double distanceToSegment(const LatticePoint& p, const LatticePoint& a, const LatticePoint& b) {
  const Vector edge = from(a, b), way = from(a, p);
  const double square = dot(edge, edge);
  const double t = square > 0 ? std::clamp(dot(edge, way) / square, 0.0, 1.0) : 0.0;
  return norm({way[0] - t * edge[0], way[1] - t * edge[1], way[2] - t * edge[2]});
}

// Parts of the rim that hang together by their points, each named by its first edge.
std::vector<std::uint32_t> connectedParts(const std::vector<RimEdge>& edges) {
  std::vector<std::uint32_t> parent(edges.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i)
      i = parent[i] = parent[parent[i]];
    return i;
  };
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
  for (std::size_t i = 1; i < ends.size(); ++i) {
    if (less(ends[i - 1].point, ends[i].point))
      continue;
    const std::uint32_t p = root(ends[i - 1].edge), q = root(ends[i].edge);
    parent[std::max(p, q)] = std::min(p, q);
  }
  for (std::uint32_t i = 0; i < edges.size(); ++i)
    parent[i] = root(i);
  return parent;
}

} // namespace

// What the tree's build moves about: an edge, or a small part of the rim as a whole.
struct RimWinding::Item {
  std::vector<std::uint32_t> edges;
  Vector middle;
};

RimWinding::RimWinding(std::vector<RimEdge> edges) {
  std::sort(edges.begin(), edges.end(), earlier);
  const std::vector<std::uint32_t> part = connectedParts(edges);
  std::vector<std::uint32_t> size(edges.size(), 0);
  for (const std::uint32_t p : part)
    ++size[p];
  std::vector<Item> items;
  std::vector<std::uint32_t> itemOf(edges.size());
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    const RimEdge& e = edges[i];
    if (size[part[i]] <= kWholePart && part[i] != i) {
      items[itemOf[part[i]]].edges.push_back(i);
      continue;
    }
    itemOf[i] = static_cast<std::uint32_t>(items.size());
    items.push_back({{i}, {(e.a.x + e.b.x) / 2, (e.a.y + e.b.y) / 2, (e.a.z + e.b.z) / 2}});
  }
  if (items.empty())
    return;
  edges_.reserve(edges.size());
  nodes_.reserve(items.size());
  build(items.data(), items.data() + items.size(), edges);
}

void RimWinding::build(Item* begin, Item* end, const std::vector<RimEdge>& edges) {
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
        edges_.push_back(edges[e]);
  } else {
    Vector low = begin->middle, high = begin->middle;
    for (const Item* item = begin; item != end; ++item)
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], item->middle[k]);
        high[k] = std::max(high[k], item->middle[k]);
      }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (high[k] - low[k] > high[axis] - low[axis])
        axis = k;
    Item* const middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end, [axis](const Item& i, const Item& j) {
      return std::tie(i.middle[axis], i.edges[0]) < std::tie(j.middle[axis], j.edges[0]);
    });
    build(begin, middle, edges);
    build(middle, end, edges);
  }
  node.end = static_cast<std::uint32_t>(edges_.size());
  fillMoments(node);
  fillLooseEnds(node);
  node.skip = static_cast<std::uint32_t>(nodes_.size());
  nodes_[index] = node;
}

// The cone's triangles have corners 0, a, b relative to the centre and area vectors n = a x b / 2.
// Mean of y over such a triangle is (a + b) / 3, of y y^T
// (a a^T + b b^T + (a + b)(a + b)^T) / 12.
void RimWinding::fillMoments(Node& node) const {
  const double inf = std::numeric_limits<double>::infinity();
  node.boxMin = {inf, inf, inf};
  node.boxMax = {-inf, -inf, -inf};
  for (std::uint32_t i = node.begin; i != node.end; ++i)
    for (const LatticePoint& p : {edges_[i].a, edges_[i].b}) {
      node.boxMin = {std::min(node.boxMin.x, p.x), std::min(node.boxMin.y, p.y),
                     std::min(node.boxMin.z, p.z)};
      node.boxMax = {std::max(node.boxMax.x, p.x), std::max(node.boxMax.y, p.y),
                     std::max(node.boxMax.z, p.z)};
    }
  node.centre = {std::floor((node.boxMin.x + node.boxMax.x) / 2),
                 std::floor((node.boxMin.y + node.boxMax.y) / 2),
                 std::floor((node.boxMin.z + node.boxMax.z) / 2)};
  double second[3][3] = {};
  double third[3][3][3] = {};
  for (std::uint32_t i = node.begin; i != node.end; ++i) {
    const RimEdge& e = edges_[i];
    const Vector a = from(node.centre, e.a), b = from(node.centre, e.b);
    const Vector sum{a[0] + b[0], a[1] + b[1], a[2] + b[2]};
    Vector n = cross(a, b);
    node.radius = std::max({node.radius, norm(a), norm(b)});
    node.area += norm(n) / 2 * std::abs(e.weight);
    node.length += norm(from(e.a, e.b)) * std::abs(e.weight);
    for (double& c : n)
      c *= e.weight / 2.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double edge = (b[k] - a[k]) * e.weight;
      node.way[k] += edge;
      for (std::size_t l = 0; l < 3; ++l)
        node.current[3 * k + l] += edge * sum[l] / 2;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      node.dipole[k] += n[k];
      for (std::size_t l = 0; l < 3; ++l) {
        second[k][l] += n[k] * sum[l] / 3;
        for (std::size_t m = 0; m < 3; ++m)
          third[k][l][m] += n[k] * (a[l] * a[m] + b[l] * b[m] + sum[l] * sum[m]) / 12;
      }
    }
  }
  node.trace = second[0][0] + second[1][1] + second[2][2];
  node.quadrupole = {second[0][0],
                     second[1][1],
                     second[2][2],
                     second[0][1] + second[1][0],
                     second[0][2] + second[2][0],
                     second[1][2] + second[2][1]};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t l = 0; l < 3; ++l)
      node.bent[k] += 2 * third[l][l][k] + third[k][l][l];
  const auto mixed = [&](std::size_t k, std::size_t l) { // the factor of y_k^2 y_l
    return third[l][k][k] + 2 * third[k][k][l];
  };
  node.octupole = {third[0][0][0], third[1][1][1],
                   third[2][2][2], mixed(0, 1),
                   mixed(0, 2),    mixed(1, 0),
                   mixed(1, 2),    mixed(2, 0),
                   mixed(2, 1),    2 * (third[0][1][2] + third[1][0][2] + third[2][0][1])};
}

void RimWinding::fillLooseEnds(Node& node) {
  node.looseBegin = static_cast<std::uint32_t>(looseEnds_.size());
  std::vector<LooseEnd> ends;
  for (std::uint32_t i = node.begin; i != node.end; ++i) {
    ends.push_back({edges_[i].b, edges_[i].weight});
    ends.push_back({edges_[i].a, -edges_[i].weight});
  }
  std::sort(ends.begin(), ends.end(),
            [](const LooseEnd& e, const LooseEnd& f) { return less(e.point, f.point); });
  for (std::size_t i = 0; i < ends.size();) {
    LooseEnd sum{ends[i].point, 0};
    for (; i < ends.size() && !less(sum.point, ends[i].point); ++i)
      sum.weight += ends[i].weight;
    if (sum.weight != 0)
      looseEnds_.push_back(sum);
  }
  node.looseEnd = static_cast<std::uint32_t>(looseEnds_.size());
}

// 4 pi s of a cluster. An edge's spherical triangle (a, b, up) is the sum of (a, b, centre),
// (centre, b, up) and (a, centre, up). The first make up the cone, which looks like its
// moments: the integral of n . r / |r|^3 with r = R + y, expanded to second order in y. The others
// cancel but at loose ends. The sum is short of 4 pi where the cone passes straight below p; at()
// sees to that.
double RimWinding::fromAfar(const Node& node, const LatticePoint& p) const {
  const Vector r = from(p, node.centre);
  const double inverse = 1 / norm(r);
  const double i2 = inverse * inverse, i3 = i2 * inverse, i5 = i3 * i2;
  const double x = r[0], y = r[1], z = r[2];
  const auto& q = node.quadrupole;
  const auto& o = node.octupole;
  const double square =
      q[0] * x * x + q[1] * y * y + q[2] * z * z + q[3] * x * y + q[4] * x * z + q[5] * y * z;
  const double cube = x * x * (o[0] * x + o[3] * y + o[4] * z) +
                      y * y * (o[1] * y + o[5] * x + o[6] * z) +
                      z * z * (o[2] * z + o[7] * x + o[8] * y) + o[9] * x * y * z;
  double angle = (dot(node.dipole, r) + node.trace) * i3 -
                 (3 * square + 1.5 * dot(node.bent, r)) * i5 + 7.5 * cube * i5 * i2;
  for (std::uint32_t i = node.looseBegin; i != node.looseEnd; ++i)
    angle += looseEnds_[i].weight * angleUp(r, from(p, looseEnds_[i].point));
  return angle;
}

double RimWinding::at(const LatticePoint& p) const {
  double angle = 0;
  const auto count = static_cast<std::uint32_t>(nodes_.size());
  for (std::uint32_t index = 0; index < count;) {
    const Node& node = nodes_[index];
    const double distance = norm(from(p, node.centre)) - node.radius;
    // The remainder: third derivatives of r / |r|^3 are at most 24 / |r|^5; over 3! and 4 pi.
    const double ratio = node.radius / distance;
    const bool far = distance > 0 && node.looseEnd - node.looseBegin <= kMaxLooseEnds &&
                     node.area * ratio * ratio * ratio < kClusterError * kPi * distance * distance;
    const bool above = p.x >= node.boxMin.x && p.x <= node.boxMax.x && p.y >= node.boxMin.y &&
                       p.y <= node.boxMax.y && p.z >= node.boxMin.z;
    if (far && !above) {
      angle += fromAfar(node, p);
      index = node.skip;
    } else if (node.leaf) {
      for (std::uint32_t i = node.begin; i != node.end; ++i)
        angle += edges_[i].weight * angleUp(from(p, edges_[i].a), from(p, edges_[i].b));
      index = node.skip;
    } else {
      ++index;
    }
  }
  return angle / (4 * kPi);
}

namespace {

// Field of a straight current from a to b, seen from 0: integral of dl x r / |r|^3, negative.
Vector fieldOfEdge(const Vector& a, const Vector& b) {
  const double la = norm(a), lb = norm(b);
  const double below = la * lb * (la * lb + dot(a, b));
  Vector field = cross(a, b);
  for (double& c : field)
    c *= below > 0 ? (la + lb) / below : 0.0;
  return field;
}

} // namespace

// To first order in the edges' places within the cluster, r = R + y: the integral of
// r x dl / |r|^3 = R x way / R^3 + sum over j of (d/dR_j (R / R^3)) x (sum of dl y_j).
Vector RimWinding::fieldFromAfar(const Node& node, const Vector& r) {
  const double inverse = 1 / norm(r);
  const double i2 = inverse * inverse, i3 = i2 * inverse;
  Vector field = cross(r, node.way);
  for (double& c : field)
    c *= i3;
  for (std::size_t j = 0; j < 3; ++j) {
    Vector change{0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k)
      change[k] = ((k == j ? 1.0 : 0.0) - 3 * r[j] * r[k] * i2) * i3;
    const Vector part = cross(change, {node.current[j], node.current[3 + j], node.current[6 + j]});
    for (std::size_t k = 0; k < 3; ++k)
      field[k] += part[k];
  }
  return field;
}

RimWinding::Slope RimWinding::slope(const LatticePoint& centre, double reach) const {
  Slope slope;
  const auto count = static_cast<std::uint32_t>(nodes_.size());
  // |d/dr (r / |r|^3)| is 2 / |r|^3; over an endless straight line that sums up to 4 / d^2.
  for (std::uint32_t index = 0; index < count;) {
    const Node& node = nodes_[index];
    const double distance = distanceToBox(centre, node.boxMin, node.boxMax) - reach;
    if (distance > 3 * node.radius) {
      slope.bend += 2 * node.length / (distance * distance * distance);
      index = node.skip;
    } else if (node.leaf) {
      for (std::uint32_t i = node.begin; i != node.end; ++i) {
        const RimEdge& e = edges_[i];
        const double d = distanceToSegment(centre, e.a, e.b) - reach;
        if (d <= 0) {
          slope.bend = std::numeric_limits<double>::infinity();
          return slope;
        }
        slope.bend +=
            std::abs(e.weight) * std::min(2 * norm(from(e.a, e.b)) / (d * d * d), 4 / (d * d));
      }
      index = node.skip;
    } else {
      ++index;
    }
  }
  slope.bend /= 4 * kPi;

  const auto add = [&](const Vector& field, double weight) {
    for (std::size_t k = 0; k < 3; ++k)
      slope.gradient[k] += weight * field[k] / (4 * kPi);
  };
  for (std::uint32_t index = 0; index < count;) {
    const Node& node = nodes_[index];
    const Vector r = from(centre, node.centre);
    const double distance = norm(r) - node.radius;
    // Second derivatives of r / |r|^3 are at most 6 / |r|^4, over 2!.
    const double error = distance > 0 ? 3 * node.length * node.radius * node.radius /
                                            (distance * distance * distance * distance)
                                      : std::numeric_limits<double>::infinity();
    if (error < 1e-3 * slope.bend * reach) {
      add(fieldFromAfar(node, r), 1);
      slope.error += error / (4 * kPi);
      index = node.skip;
    } else if (node.leaf) {
      for (std::uint32_t i = node.begin; i != node.end; ++i)
        add(fieldOfEdge(from(centre, edges_[i].a), from(centre, edges_[i].b)), edges_[i].weight);
      index = node.skip;
    } else {
      ++index;
    }
  }
  return slope;
}

bool RimWinding::mayJump(const LatticePoint& centre, double reach) const {
  const auto over = [&](const LatticePoint& low, const LatticePoint& high) {
    return low.x <= centre.x + reach && high.x >= centre.x - reach && low.y <= centre.y + reach &&
           high.y >= centre.y - reach && low.z <= centre.z + reach;
  };
  const auto count = static_cast<std::uint32_t>(nodes_.size());
  for (std::uint32_t index = 0; index < count;) {
    const Node& node = nodes_[index];
    if (!over(node.boxMin, node.boxMax)) {
      index = node.skip;
      continue;
    }
    if (node.leaf)
      for (std::uint32_t i = node.begin; i != node.end; ++i) {
        const LatticePoint &a = edges_[i].a, &b = edges_[i].b;
        if (over({std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)},
                 {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}))
          return true;
      }
    ++index;
  }
  return false;
}

RimWinding::Ball RimWinding::reach() const {
  if (nodes_.empty())
    return {{0, 0, 0}, 0};
  // The cone's solid angle from outside its ball is at most area / distance^2.
  const Node& root = nodes_.front();
  return {root.centre, root.radius + std::sqrt(root.area / (4 * kPi * 0.45))};
}

} // namespace tetvdb
