// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/TriangleTree.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/SplitAlongAxis.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

namespace tetvdb {
namespace {

constexpr std::size_t kBins = 16;
constexpr std::uint32_t kTrianglesPerTask = 2048;
// From here on ranges are halved, so that no input makes the tree deeper than kMaxDepth: 32 more
// levels are enough for any number of faces, each being two splits.
constexpr std::size_t kDepthOfMedians = 30;
// A triangle is thin where its area is below this part of what its edges allow: the matrix that
// finds the nearest point inside then has lost some digits.
constexpr double kThin = 1e-6;

double inverse(double square) {
  return square > 0 ? 1 / square : 0;
}

double halfArea(const Box& box) {
  const Vec3d side = minus(box.high, box.low);
  return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

} // namespace

NearTriangle::NearTriangle(const Vec3d& pa, const Vec3d& pb, const Vec3d& pc, std::uint32_t number)
    : a(pa), ab(minus(pb, pa)), ac(minus(pc, pa)), face(number) {
  const Vec3d bc = minus(pc, pb), normal = cross(ab, ac);
  const double ab2 = dot(ab, ab), ac2 = dot(ac, ac), bc2 = dot(bc, bc);
  const double determinant = dot(normal, normal), longest = std::max({ab2, ac2, bc2});
  thin = !(determinant > kThin * longest * longest);
  const double factor = determinant > 0 ? 1 / determinant : 0;
  m00 = ac2 * factor;
  m01 = dot(ab, ac) * factor;
  m11 = ab2 * factor;
  perAb = inverse(ab2);
  perAc = inverse(ac2);
  perBc = inverse(bc2);
}

struct TriangleTree::Builder {
  std::vector<Box> boxes;
  std::vector<Vec3d> doubledCentres; ///< of boxes
  std::vector<std::uint32_t> order;
  std::vector<Node> nodes; ///< a node over [first, last) lies at its first split
  float slack = 0;         ///< what boxes grow by, for the rounding of points

  Box boxOf(std::uint32_t first, std::uint32_t last) const {
    Box box;
    for (std::uint32_t i = first; i < last; ++i)
      box.add(boxes[order[i]]);
    return box;
  }

  std::uint32_t median(std::uint32_t first, std::uint32_t last, std::size_t axis) {
    const std::uint32_t half = first + (last - first) / 2;
    splitAlongAxis(
        axis, order.begin() + first, order.begin() + half, order.begin() + last,
        [&](std::uint32_t item) -> const Vec3d& { return doubledCentres[item]; },
        [](std::uint32_t item) { return item; });
    return half;
  }

  /// Splits a range of two or more into two that are not empty; returns where the second begins.
  std::uint32_t split(std::uint32_t first, std::uint32_t last, std::size_t depth) {
    Box spread;
    for (std::uint32_t i = first; i < last; ++i)
      spread.add(doubledCentres[order[i]]);
    const std::size_t axis = longestAxis(spread.low, spread.high);
    const double width = spread.high[axis] - spread.low[axis];
    if (last - first <= 4 || depth >= kDepthOfMedians || !(width > 0))
      return median(first, last, axis);
    const double scale = (kBins - 1e-3) / width;
    const auto binOf = [&](std::uint32_t item) {
      return static_cast<std::size_t>((doubledCentres[item][axis] - spread.low[axis]) * scale);
    };
    std::array<Box, kBins> inBin;
    std::array<std::uint32_t, kBins> count{};
    for (std::uint32_t i = first; i < last; ++i) {
      const std::size_t bin = binOf(order[i]);
      inBin[bin].add(boxes[order[i]]);
      ++count[bin];
    }
    std::array<double, kBins> right{};
    Box grown;
    std::uint32_t items = 0;
    for (std::size_t bin = kBins; bin-- > 1;) {
      if (count[bin] > 0)
        grown.add(inBin[bin]);
      items += count[bin];
      right[bin] = items > 0 ? halfArea(grown) * items : 0;
    }
    grown = Box();
    items = 0;
    double minCost = std::numeric_limits<double>::infinity();
    std::size_t best = 0;
    for (std::size_t bin = 1; bin < kBins; ++bin) {
      if (count[bin - 1] > 0)
        grown.add(inBin[bin - 1]);
      items += count[bin - 1];
      if (items == 0 || items == last - first)
        continue;
      const double cost = halfArea(grown) * items + right[bin];
      if (cost < minCost) {
        minCost = cost;
        best = bin;
      }
    }
    const auto second = std::partition(order.begin() + first, order.begin() + last,
                                       [&](std::uint32_t item) { return binOf(item) < best; });
    return static_cast<std::uint32_t>(second - order.begin());
  }

  using Ranges = std::array<std::pair<std::uint32_t, std::uint32_t>, 4>;

  /// Gives a node the boxes of `count` ranges of triangles, and no children yet.
  void setLanes(Node& node, const Ranges& ranges, std::size_t count) const {
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const Box box = lane < count ? boxOf(ranges[lane].first, ranges[lane].second) : Box();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        node.low[axis][lane] = static_cast<float>(box.low[axis]) - slack;
        node.high[axis][lane] = static_cast<float>(box.high[axis]) + slack;
      }
      node.child[lane] = kTriangle;
    }
  }

  std::uint32_t build(std::uint32_t first, std::uint32_t last, std::size_t depth) {
    const std::uint32_t second = split(first, last, depth);
    Ranges parts;
    std::size_t count = 0;
    for (const auto& half : {std::make_pair(first, second), std::make_pair(second, last)}) {
      if (half.second - half.first == 1) {
        parts[count++] = half;
        continue;
      }
      const std::uint32_t cut = split(half.first, half.second, depth);
      parts[count++] = {half.first, cut};
      parts[count++] = {cut, half.second};
    }
    Node& node = nodes[second];
    const auto fill = [&](std::size_t lane) {
      const auto [from, to] = parts[lane];
      node.child[lane] = to - from == 1 ? from | kTriangle : build(from, to, depth + 1);
    };
    setLanes(node, parts, count);
    if (last - first > kTrianglesPerTask)
      tbb::parallel_for(std::size_t(0), count, fill);
    else
      for (std::size_t lane = 0; lane < count; ++lane)
        fill(lane);
    return second;
  }
};

// Appends the nodes below `root` in the order of a visit: parents before children.
void TriangleTree::addNodes(const std::vector<Node>& nodes, std::uint32_t root) {
  struct Waiting {
    std::uint32_t node, parent; // parent: the place of it
    std::size_t lane;           // of the parent; 4: the root
  };
  std::vector<Waiting> waiting{{root, 0, 4}};
  while (!waiting.empty()) {
    const auto [number, parent, laneOfParent] = waiting.back();
    const auto place = static_cast<std::uint32_t>(nodes_.size());
    if (laneOfParent < 4)
      nodes_[parent].child[laneOfParent] = place;
    waiting.pop_back();
    nodes_.push_back(nodes[number]);
    for (std::size_t lane = 4; lane-- > 0;)
      if (!(nodes[number].child[lane] & kTriangle))
        waiting.push_back({nodes[number].child[lane], place, lane});
  }
}

TriangleTree::TriangleTree(const std::vector<Vec3d>& points,
                           const std::vector<std::array<std::uint32_t, 3>>& faces) {
  const auto count = static_cast<std::uint32_t>(faces.size());
  if (count == 0)
    return;
  Builder builder;
  builder.boxes.resize(count);
  builder.doubledCentres.resize(count);
  builder.order.resize(count);
  std::iota(builder.order.begin(), builder.order.end(), 0u);
  double farthest = 0;
  for (std::uint32_t f = 0; f < count; ++f) {
    Box& box = builder.boxes[f];
    for (const std::uint32_t v : faces[f]) {
      box.add(points[v]);
      for (const double x : points[v])
        farthest = std::max(farthest, std::abs(x));
    }
    builder.doubledCentres[f] = plus(box.low, box.high);
  }
  // Points and boxes are rounded by 2^-24 of their coordinates each, and so is this sum.
  builder.slack = static_cast<float>(farthest * 0x1p-21);
  if (count == 1) {
    nodes_.emplace_back();
    builder.setLanes(nodes_[0], {{{0, 1}}}, 1);
  } else {
    builder.nodes.resize(count);
    addNodes(builder.nodes, builder.build(0, count, 0));
  }
  triangles_.resize(count);
  tbb::parallel_for(std::uint32_t(0), count, [&](std::uint32_t i) {
    const auto& f = faces[builder.order[i]];
    triangles_[i] = NearTriangle(points[f[0]], points[f[1]], points[f[2]], builder.order[i]);
  });
}

TriangleTree::Cut::Cut(const TriangleTree& tree, const Box& box, double reach) {
  if (tree.empty())
    return;
  const Vec3d grow{reach, reach, reach};
  const Point low(minus(box.low, grow)), high(plus(box.high, grow));
  // Nodes whose children are visited, the largest first; what does not fit stays a node.
  constexpr std::size_t kLanes = 4 * kCutNodes;
  struct Child {
    const Node* parent;
    std::size_t lane;
  };
  Child waiting[kLanes];
  std::size_t first = 0, last = 0, lanes = 0;
  const auto add = [&](const Child& child) {
    Node& node = nodes_[lanes / 4];
    const std::size_t lane = lanes++ % 4;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      node.low[axis][lane] = child.parent->low[axis][child.lane];
      node.high[axis][lane] = child.parent->high[axis][child.lane];
    }
    node.child[lane] = child.parent->child[child.lane];
  };
  const auto open = [&](const Node& node) {
    const Int4 meets = (node.low[0] <= high.x) & (node.low[1] <= high.y) & (node.low[2] <= high.z) &
                       (node.high[0] >= low.x) & (node.high[1] >= low.y) & (node.high[2] >= low.z);
    for (std::uint32_t mask = maskOf(meets); mask != 0; mask &= mask - 1) {
      const Child child{&node, static_cast<std::size_t>(__builtin_ctz(mask))};
      if (node.child[child.lane] & kTriangle)
        add(child);
      else
        waiting[last++ % kLanes] = child;
    }
  };
  open(tree.nodes_[0]);
  while (first < last && lanes + (last - first) + 3 <= kLanes) {
    const Child child = waiting[first++ % kLanes];
    open(tree.nodes_[child.parent->child[child.lane]]);
  }
  while (first < last)
    add(waiting[first++ % kLanes]);
  // Lanes without a child are nowhere.
  constexpr float kNowhere = std::numeric_limits<float>::infinity();
  count_ = (lanes + 3) / 4;
  for (; lanes % 4 != 0; ++lanes)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      nodes_[lanes / 4].low[axis][lanes % 4] = kNowhere;
      nodes_[lanes / 4].high[axis][lanes % 4] = -kNowhere;
    }
}

} // namespace tetvdb
