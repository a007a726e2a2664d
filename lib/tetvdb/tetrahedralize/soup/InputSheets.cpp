// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/InputSheets.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Triangles over a candidate: of more, cutting the candidate is about as quick.
constexpr std::size_t kMaxTriangles = 64;
// Triangles at an edge: more are not paired.
constexpr std::size_t kMaxAtEdge = 8;
// A point is on an edge where it is nearer than this share of lengths: above the rounding.
constexpr double kOnEdge = 1e-12;

// Two axes across a direction and one along it, of unit length.
struct Frame {
  Vec3d origin, x, y, z;

  Frame(const Vec3d& from, const Vec3d& unit) : origin(from), z(unit) {
    Vec3d away{0, 0, 0};
    away[std::abs(z[0]) < 0.6 ? 0 : 1] = 1;
    x = cross(away, z);
    x = times(x, 1 / length(x));
    y = cross(z, x);
  }
  Vec3d of(const Vec3d& p) const {
    const Vec3d q = minus(p, origin);
    return {dot(q, x), dot(q, y), dot(q, z)};
  }
};

double side(const Vec3d& u, const Vec3d& v, double x, double y) {
  return (v[0] - u[0]) * (y - u[1]) - (v[1] - u[1]) * (x - u[0]);
}

// A candidate from above: counter-clockwise, at height 0.
struct Outline {
  std::array<Vec3d, 3> at;

  // Positive on the inner side of the edge from corner k to the next.
  double inward(std::size_t k, const Vec3d& p) const {
    return side(at[k], at[(k + 1) % 3], p[0], p[1]);
  }
};

enum class Cover { No, Yes, OnEdge };

// A triangle of the tree from above.
struct Seen {
  std::array<Vec3d, 3> at;
  std::array<std::array<double, 3>, 3> inward; ///< of corner i, from the outline's edge k
  bool isOver = true;                          ///< no edge of the outline has it on its outer side
  bool isWithin = true;                        ///< all edges have it on their inner sides

  Seen(const std::array<Vec3d, 3>& corners, const Outline& outline) : at(corners), inward{} {
    for (std::size_t k = 0; k < 3; ++k) {
      bool isIn = false;
      for (std::size_t i = 0; i < 3; ++i) {
        inward[i][k] = outline.inward(k, at[i]);
        isIn = isIn || inward[i][k] > 0;
        isWithin = isWithin && inward[i][k] > 0;
      }
      isOver = isOver && isIn;
    }
  }

  // Whether the edge from corner i to the next is over the inside of the outline: neither an edge
  // of the outline nor this one is between the two.
  bool hasOver(std::size_t i, const Outline& outline) const {
    const std::size_t next = (i + 1) % 3;
    const auto &u = inward[i], &v = inward[next];
    if ((u[0] <= 0 && v[0] <= 0) || (u[1] <= 0 && v[1] <= 0) || (u[2] <= 0 && v[2] <= 0))
      return false;
    bool isLeft = false, isRight = false;
    for (const Vec3d& p : outline.at) {
      const double here = side(at[i], at[next], p[0], p[1]);
      isLeft = isLeft || here > 0;
      isRight = isRight || here < 0;
    }
    return isLeft && isRight;
  }

  Cover covers(double x, double y) const {
    double low = kInfinity, high = -kInfinity, square = x * x + y * y;
    for (std::size_t i = 0; i < 3; ++i) {
      const double here = side(at[i], at[(i + 1) % 3], x, y);
      low = std::min(low, here);
      high = std::max(high, here);
      square = std::max(square, dot(at[i], at[i]));
    }
    const double margin = kOnEdge * square;
    if (low > margin || high < -margin)
      return Cover::Yes;
    return low < -margin && high > margin ? Cover::No : Cover::OnEdge;
  }

  // The greatest of its corners, up or down.
  double height() const {
    return std::max({std::abs(at[0][2]), std::abs(at[1][2]), std::abs(at[2][2])});
  }

  // Of what is left of the triangle within the outline, a point of the greatest height, up or down
  // (Sutherland and Hodgman, Reentrant Polygon Clipping, 1974).
  Vec3d farthest(const Outline& outline) const {
    // A cut adds half as many corners as there are at most, where rounding makes sides alternate.
    std::array<Vec3d, 9> polygon{at[0], at[1], at[2]}, cut;
    std::size_t count = 3;
    for (std::size_t k = 0; k < 3 && !isWithin; ++k) {
      std::size_t left = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3d &u = polygon[i], &v = polygon[i + 1 < count ? i + 1 : 0];
        const double ofU = outline.inward(k, u), ofV = outline.inward(k, v);
        if (ofU >= 0)
          cut[left++] = u;
        if ((ofU < 0) != (ofV < 0))
          cut[left++] = plus(u, times(minus(v, u), ofU / (ofU - ofV)));
      }
      std::swap(polygon, cut);
      count = left;
    }
    Vec3d farthest{0, 0, 0};
    for (std::size_t i = 0; i < count; ++i)
      if (std::abs(polygon[i][2]) > std::abs(farthest[2]))
        farthest = polygon[i];
    return farthest;
  }
};

} // namespace

InputSheets::InputSheets(const TriangleTree& tree,
                         const std::vector<std::array<std::uint32_t, 3>>& faces, std::size_t points)
    : tree_(tree), across_(tree.size(), {kNone, kNone, kNone}) {
  // Edges, as 3 * triangle + corner, by their lower point.
  const auto ends = [&](std::uint32_t edge) {
    const auto& face = faces[tree.triangle(edge / 3).face];
    const std::uint32_t from = face[edge % 3], to = face[(edge % 3 + 1) % 3];
    return std::make_pair(std::min(from, to), std::max(from, to));
  };
  std::vector<std::size_t> begin(points + 1, 0);
  for (const auto& face : faces)
    for (std::size_t k = 0; k < 3; ++k)
      ++begin[std::min(face[k], face[(k + 1) % 3]) + 1];
  for (std::size_t p = 0; p < points; ++p)
    begin[p + 1] += begin[p];
  struct Edge {
    std::uint32_t high, number;
  };
  std::vector<Edge> edges(3 * faces.size());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::uint32_t number = 0; number < edges.size(); ++number) {
    const auto [low, high] = ends(number);
    edges[next[low]++] = {high, number};
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points, 1024), [&](const auto& range) {
    std::vector<std::uint32_t> together;
    for (std::size_t p = range.begin(); p < range.end(); ++p) {
      const auto first = edges.begin() + static_cast<std::ptrdiff_t>(begin[p]),
                 last = edges.begin() + static_cast<std::ptrdiff_t>(begin[p + 1]);
      std::sort(first, last, [](const Edge& a, const Edge& b) {
        return a.high != b.high ? a.high < b.high : a.number < b.number;
      });
      for (auto edge = first; edge != last;) {
        together.clear();
        for (const std::uint32_t high = edge->high; edge != last && edge->high == high; ++edge)
          together.push_back(edge->number);
        pair(together);
      }
    }
  });
}

// The flattest first. `edges` are one edge of several triangles.
void InputSheets::pair(std::vector<std::uint32_t>& edges) {
  if (edges.size() > kMaxAtEdge)
    return;
  // Away from the edge, of unit length.
  const auto out = [&](std::uint32_t edge) {
    const NearTriangle& triangle = tree_.triangle(edge / 3);
    const std::array<Vec3d, 3> at{Vec3d{0, 0, 0}, triangle.ab, triangle.ac};
    const Vec3d &from = at[edge % 3], along = minus(at[(edge % 3 + 1) % 3], from);
    const Vec3d to = minus(at[(edge % 3 + 2) % 3], from);
    const double square = dot(along, along);
    const Vec3d across = square > 0 ? minus(to, times(along, dot(to, along) / square)) : to;
    const double size = length(across);
    return size > 0 ? times(across, 1 / size) : across;
  };
  while (edges.size() > 1) {
    std::size_t one = 0, other = 1;
    double flattest = kInfinity;
    for (std::size_t i = 1; i < edges.size() && edges.size() > 2; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const double cosine = dot(out(edges[i]), out(edges[j]));
        if (cosine < flattest) {
          flattest = cosine;
          one = j;
          other = i;
        }
      }
    across_[edges[one] / 3][edges[one] % 3] = edges[other] / 3;
    across_[edges[other] / 3][edges[other] % 3] = edges[one] / 3;
    edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(other));
    edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(one));
  }
}

InputSheets::Gap InputSheets::gap(const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                  std::uint32_t start, double most, double enough) const {
  const Gap unknown{kInfinity, false, {}};
  const Vec3d normal = cross(minus(b, a), minus(c, a));
  const double size = length(normal);
  if (!(size > 0))
    return unknown;
  const Frame frame(a, times(normal, 1 / size));
  const Outline outline{{Vec3d{0, 0, 0}, frame.of(b), frame.of(c)}};
  const double x = (outline.at[1][0] + outline.at[2][0]) / 3,
               y = (outline.at[1][1] + outline.at[2][1]) / 3;

  std::array<std::uint32_t, kMaxTriangles> found{start};
  std::size_t count = 1;
  double highest = 0;
  bool isOdd = false; // the number of triangles over the centre
  for (std::size_t next = 0; next < count; ++next) {
    const NearTriangle& triangle = tree_.triangle(found[next]);
    const Seen seen({frame.of(triangle.a), frame.of(plus(triangle.a, triangle.ab)),
                     frame.of(plus(triangle.a, triangle.ac))},
                    outline);
    if (!seen.isOver)
      continue;
    if (const double height = seen.height(); height > highest) {
      if (height <= enough) {
        highest = height;
      } else {
        const Vec3d far = seen.farthest(outline);
        highest = std::max(highest, std::abs(far[2]));
        if (!(highest <= most))
          return {kInfinity, true, plus(a, plus(times(frame.x, far[0]), times(frame.y, far[1])))};
      }
    }
    const Cover cover = seen.covers(x, y);
    if (cover == Cover::OnEdge)
      return unknown;
    isOdd ^= cover == Cover::Yes;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!seen.hasOver(i, outline))
        continue;
      const std::uint32_t other = across_[found[next]][i];
      if (other == kNone)
        return unknown;
      const auto end = found.begin() + static_cast<std::ptrdiff_t>(count);
      if (std::find(found.begin(), end, other) != end)
        continue;
      if (count == kMaxTriangles)
        return unknown;
      found[count++] = other;
    }
  }
  return isOdd ? Gap{highest, false, {}} : unknown;
}

} // namespace tetvdb
