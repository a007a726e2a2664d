// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/FillHoles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>

namespace tetvdb {
namespace {

// Maximum number of points in one search for a short loop, and in all searches per edge.
constexpr std::size_t kSearchPoints = 2048;
constexpr std::size_t kSearchPointsAnEdge = 256;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

auto placeOf(const LatticePoint& p) {
  return std::tie(p.x, p.y, p.z);
}
bool less(const LatticePoint& p, const LatticePoint& q) {
  return placeOf(p) < placeOf(q);
}

// Directed edges with weights, by the positions of their points.
class BoundaryGraph {
public:
  explicit BoundaryGraph(const std::vector<BoundaryEdge>& edges) {
    points_.reserve(2 * edges.size());
    for (const BoundaryEdge& e : edges) {
      points_.push_back(e.a);
      points_.push_back(e.b);
    }
    std::sort(points_.begin(), points_.end(), less);
    points_.erase(
        std::unique(points_.begin(), points_.end(),
                    [](const auto& p, const auto& q) { return placeOf(p) == placeOf(q); }),
        points_.end());
    sumEdges(edges);
    reached_.assign(points_.size(), 0);
    from_.resize(points_.size());
    onPath_.assign(points_.size(), kNone);
  }

  std::size_t edgeCount() const { return to_.size(); }
  const LatticePoint& point(std::uint32_t i) const { return points_[i]; }

  // Calls visit(loop, weight) for loops of points that sum to the edges.
  template <typename Visit>
  void forLoops(const Visit& visit) {
    for (std::uint32_t e = 0; e < to_.size(); ++e)
      while (left_[e] > 0)
        if (!findShortLoop(e, visit))
          walkLoops(e, visit);
  }

private:
  void sumEdges(const std::vector<BoundaryEdge>& edges) {
    struct Sum {
      std::uint32_t a, b;
      std::int64_t weight;
    };
    std::vector<Sum> sums;
    sums.reserve(edges.size());
    for (const BoundaryEdge& e : edges) {
      const std::uint32_t a = indexOf(e.a), b = indexOf(e.b);
      if (a != b)
        sums.push_back(a < b ? Sum{a, b, e.weight} : Sum{b, a, -std::int64_t(e.weight)});
    }
    std::sort(sums.begin(), sums.end(),
              [](const Sum& s, const Sum& t) { return std::tie(s.a, s.b) < std::tie(t.a, t.b); });
    std::vector<Sum> directed;
    for (std::size_t i = 0; i < sums.size();) {
      Sum sum{sums[i].a, sums[i].b, 0};
      for (; i < sums.size() && sums[i].a == sum.a && sums[i].b == sum.b; ++i)
        sum.weight += sums[i].weight;
      if (sum.weight > 0)
        directed.push_back(sum);
      else if (sum.weight < 0)
        directed.push_back({sum.b, sum.a, -sum.weight});
    }
    std::sort(directed.begin(), directed.end(),
              [](const Sum& s, const Sum& t) { return std::tie(s.a, s.b) < std::tie(t.a, t.b); });
    first_.assign(points_.size() + 1, 0);
    for (const Sum& s : directed) {
      ++first_[s.a + 1];
      start_.push_back(s.a);
      to_.push_back(s.b);
      left_.push_back(s.weight);
    }
    for (std::size_t i = 0; i < points_.size(); ++i)
      first_[i + 1] += first_[i];
  }

  std::uint32_t indexOf(const LatticePoint& p) const {
    return static_cast<std::uint32_t>(std::lower_bound(points_.begin(), points_.end(), p, less) -
                                      points_.begin());
  }

  // The loop of fewest edges through edge `e`, breadth first from its second point back to its
  // first; returns false if it is not close.
  template <typename Visit>
  bool findShortLoop(std::uint32_t e, const Visit& visit) {
    if (searched_ > kSearchPointsAnEdge * edgeCount())
      return false;
    ++search_;
    const std::uint32_t goal = start_[e];
    queue_.assign(1, to_[e]);
    reached_[to_[e]] = search_;
    from_[to_[e]] = e;
    bool found = false;
    for (std::size_t i = 0; i < queue_.size() && !found && queue_.size() < kSearchPoints; ++i)
      for (std::uint32_t f = first_[queue_[i]]; f != first_[queue_[i] + 1] && !found; ++f) {
        const std::uint32_t next = to_[f];
        if (left_[f] == 0 || reached_[next] == search_)
          continue;
        reached_[next] = search_;
        from_[next] = f;
        queue_.push_back(next);
        found = next == goal;
      }
    searched_ += queue_.size();
    if (!found)
      return false;
    loopEdges_.clear();
    std::uint32_t p = goal;
    do {
      loopEdges_.push_back(from_[p]);
      p = start_[from_[p]];
    } while (p != goal);
    std::reverse(loopEdges_.begin(), loopEdges_.end());
    takeLoop(loopEdges_.begin(), loopEdges_.end(), visit);
    return true;
  }

  // Follows edges from `e` on until each is part of a loop.
  template <typename Visit>
  void walkLoops(std::uint32_t e, const Visit& visit) {
    std::vector<std::uint32_t> path; // edges
    const std::uint32_t origin = start_[e];
    onPath_[origin] = 0;
    std::uint32_t at = origin;
    while (true) {
      std::uint32_t f = path.empty() ? e : first_[at];
      while (left_[f] == 0)
        ++f;
      path.push_back(f);
      at = to_[f];
      if (onPath_[at] == kNone) {
        onPath_[at] = static_cast<std::uint32_t>(path.size());
        continue;
      }
      const std::uint32_t begin = onPath_[at];
      takeLoop(path.begin() + begin, path.end(), visit);
      for (std::size_t i = begin; i < path.size(); ++i)
        if (to_[path[i]] != at)
          onPath_[to_[path[i]]] = kNone;
      path.resize(begin);
      if (path.empty())
        break;
    }
    onPath_[origin] = kNone;
  }

  template <typename Edges, typename Visit>
  void takeLoop(Edges begin, Edges end, const Visit& visit) {
    std::int64_t weight = std::numeric_limits<std::int32_t>::max();
    for (Edges f = begin; f != end; ++f)
      weight = std::min(weight, left_[*f]);
    loop_.clear();
    for (Edges f = begin; f != end; ++f) {
      left_[*f] -= weight;
      loop_.push_back(start_[*f]);
    }
    visit(loop_, static_cast<std::int32_t>(weight));
  }

  std::vector<LatticePoint> points_;      // by position
  std::vector<std::uint32_t> start_, to_; // of every edge
  std::vector<std::int64_t> left_;        // of every edge's weight
  std::vector<std::uint32_t> first_;      // edge of every point
  std::vector<std::uint32_t> reached_, from_, queue_, onPath_, loopEdges_, loop_;
  std::uint32_t search_ = 0;
  std::size_t searched_ = 0;
};

// The same point for both directions of an edge.
LatticePoint midpointOf(const LatticePoint& a, const LatticePoint& b) {
  return {std::floor((a.x + b.x) / 2), std::floor((a.y + b.y) / 2), std::floor((a.z + b.z) / 2)};
}
double extentOf(const LatticePoint& a, const LatticePoint& b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

class Fill {
public:
  Fill(const BoundaryGraph& graph, std::vector<FillTriangle>& out) : graph_(graph), out_(out) {}

  // The section of a loop from `begin` to `end`, closed by its chord.
  void halve(const std::vector<std::uint32_t>& loop, std::size_t begin, std::size_t end,
             std::int32_t weight) {
    if (end - begin < 2)
      return;
    const std::size_t midpoint = (begin + end) / 2;
    add(graph_.point(loop[begin]), graph_.point(loop[midpoint]), graph_.point(loop[end]), weight);
    halve(loop, begin, midpoint, weight);
    halve(loop, midpoint, end, weight);
  }

private:
  // Long edges are split at their midpoints, as by the adjacent triangle.
  void add(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
           std::int32_t weight) {
    const double ab = extentOf(a, b), bc = extentOf(b, c), ca = extentOf(c, a);
    if (std::max({ab, bc, ca}) <= kMaxTetExtent) {
      out_.push_back({a, b, c, weight});
      return;
    }
    const auto cut = [&](const LatticePoint& p, const LatticePoint& q, const LatticePoint& r) {
      const LatticePoint m = midpointOf(p, q);
      add(p, m, r, weight);
      add(m, q, r, weight);
    };
    if (ab >= bc && ab >= ca)
      cut(a, b, c);
    else if (bc >= ca)
      cut(b, c, a);
    else
      cut(c, a, b);
  }

  const BoundaryGraph& graph_;
  std::vector<FillTriangle>& out_;
};

} // namespace

std::vector<FillTriangle> fillHoles(const std::vector<BoundaryEdge>& edges) {
  std::vector<FillTriangle> triangles;
  BoundaryGraph graph(edges);
  Fill fill(graph, triangles);
  graph.forLoops([&](const std::vector<std::uint32_t>& loop, std::int32_t weight) {
    fill.halve(loop, 0, loop.size() - 1, weight);
  });
  return triangles;
}

} // namespace tetvdb
