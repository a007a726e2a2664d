// SPDX-License-Identifier: Apache-2.0
//
// Triangles in a tree of four-wide boxes: what is near a point.
#pragma once

#include "tetvdb/core/Multiversion.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace tetvdb {

/// A triangle with what a distance to it takes: two cache lines.
struct alignas(128) NearTriangle {
  Vec3d a, ab, ac;
  double m00, m01, m11;       ///< inverse of the matrix of ab's and ac's dot products; 0 where thin
  double perAb, perAc, perBc; ///< 1 over the edges' squared lengths; 0 for those of no length
  std::uint32_t face;
  std::uint32_t thin; ///< almost collinear: all of its edges are tested

  NearTriangle() = default;
  NearTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, std::uint32_t face);

  /// The squared distance of a point to a point of the triangle: to the nearest up to rounding, and
  /// never too small by more than the rounding of coordinates.
  TETVDB_INLINE double squaredDistance(const Vec3d& p) const {
    const Vec3d ap = minus(p, a);
    const double alongAb = dot(ap, ab), alongAc = dot(ap, ac);
    const double s = m00 * alongAb - m01 * alongAc, t = m11 * alongAc - m01 * alongAb;
    if (s > 0 && t > 0 && s + t < 1) {
      const double inside = squareOf(ap, s, ab, t, ac);
      return thin ? std::min(inside, toEdges(ap, alongAb, alongAc)) : inside;
    }
    if (thin)
      return toEdges(ap, alongAb, alongAc);
    // The nearest point lies on an edge that the point is beyond; at a corner there may be two.
    double best = kFar;
    if (s <= 0)
      best = squareOf(ap, 0, ab, clamped(alongAc * perAc), ac);
    if (t <= 0)
      best = std::min(best, squareOf(ap, clamped(alongAb * perAb), ab, 0, ac));
    if (s + t >= 1)
      best = std::min(best, toBc(ap));
    return best;
  }

private:
  static constexpr double kFar = 1e300;
  static double clamped(double u) { return u > 0 ? (u < 1 ? u : 1) : 0; }
  static double squareOf(const Vec3d& p, double s, const Vec3d& u, double t, const Vec3d& v) {
    const double x = p[0] - s * u[0] - t * v[0], y = p[1] - s * u[1] - t * v[1],
                 z = p[2] - s * u[2] - t * v[2];
    return x * x + y * y + z * z;
  }
  double toBc(const Vec3d& ap) const {
    const Vec3d bp = minus(ap, ab), bc = minus(ac, ab);
    return squareOf(bp, clamped(dot(bp, bc) * perBc), bc, 0, bc);
  }
  double toEdges(const Vec3d& ap, double alongAb, double alongAc) const {
    return std::min({squareOf(ap, clamped(alongAb * perAb), ab, 0, ac),
                     squareOf(ap, 0, ab, clamped(alongAc * perAc), ac), toBc(ap)});
  }
};

/// A tree of boxes, split by the surface area heuristic (MacDonald and Booth, Heuristics for Ray
/// Tracing Using Space Subdivision, 1990). Boxes are floats, rounded outward; four of them are
/// tested at once, with vectors that every x86-64 has. The same tree for any number of threads;
/// queries are thread-safe.
class TriangleTree {
public:
  TriangleTree(const std::vector<Vec3d>& points,
               const std::vector<std::array<std::uint32_t, 3>>& faces);

  bool empty() const { return triangles_.empty(); }
  std::uint32_t size() const { return static_cast<std::uint32_t>(triangles_.size()); }
  const NearTriangle& triangle(std::uint32_t i) const { return triangles_[i]; }

  /// Calls look(i, limit) for the triangles i whose box is within a squared distance of `limit`
  /// from p, the nearer ones about first; look may lower `limit`, and ends the visit by returning
  /// true. Returns whether it did.
  template <typename Look>
  bool visit(const Vec3d& p, double limit, const Look& look) const {
    if (triangles_.empty())
      return false;
    const Point at(p);
    Stack stack;
    addChildren(at, nodes_[0], stack, limit);
    return visitStack(at, stack, limit, look);
  }

  class Cut;
  /// As above, of the triangles of a cut.
  template <typename Look>
  bool visit(const Cut& cut, const Vec3d& p, double limit, const Look& look) const;

private:
  using Float4 = float __attribute__((vector_size(16)));
  using Int4 = std::int32_t __attribute__((vector_size(16)));
  static constexpr std::uint32_t kTriangle = 0x80000000u;
  static constexpr std::size_t kMaxDepth = 64;
  static constexpr std::size_t kCutNodes = 16;

  struct Point {
    Float4 x, y, z; ///< each four times
    explicit Point(const Vec3d& p) : x(four(p[0])), y(four(p[1])), z(four(p[2])) {}
    static Float4 four(double value) {
      const auto v = static_cast<float>(value);
      return Float4{v, v, v, v};
    }
  };

  // Of a squared distance of floats: the roundings of differences, products and sums, and that of a
  // point far outside of all boxes.
  static float roundedUp(double square) { return static_cast<float>(square * (1 + 2e-6)); }

  static std::uint32_t maskOf(const Int4& lanes) {
#ifdef __SSE2__
    return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(lanes)));
#else
    std::uint32_t mask = 0;
    for (std::uint32_t lane = 0; lane < 4; ++lane)
      mask |= (lanes[lane] != 0 ? 1u : 0u) << lane;
    return mask;
#endif
  }

  struct alignas(128) Node {
    Float4 low[3], high[3];
    std::uint32_t child[4]; ///< nodes, or triangles with kTriangle

    Float4 squaredDistances(const Point& p) const {
      return square(p.x, low[0], high[0]) + square(p.y, low[1], high[1]) +
             square(p.z, low[2], high[2]);
    }
    static Float4 square(const Float4& at, const Float4& low, const Float4& high) {
      const Float4 below = low - at, above = at - high;
      Float4 out = below > above ? below : above;
      out = out > Float4{} ? out : Float4{};
      return out * out;
    }
  };

  struct Entry {
    float square;
    std::uint32_t child;
  };
  struct Stack {
    Entry entries[kMaxDepth * 3 + 4 + 4 * kCutNodes];
    std::size_t depth = 0;
  };

  // Puts those of a node's children that are near onto the stack, the nearest on top.
  static void addChildren(const Point& at, const Node& node, Stack& stack, double limit,
                          std::size_t bottom) {
    const Float4 squares = node.squaredDistances(at);
    const float max = roundedUp(limit);
    for (std::uint32_t mask = maskOf(squares <= Float4{max, max, max, max}); mask != 0;
         mask &= mask - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(mask));
      const float square = squares[lane];
      std::size_t place = stack.depth++;
      for (; place > bottom && stack.entries[place - 1].square < square; --place)
        stack.entries[place] = stack.entries[place - 1];
      stack.entries[place] = {square, node.child[lane]};
    }
  }
  static void addChildren(const Point& at, const Node& node, Stack& stack, double limit) {
    addChildren(at, node, stack, limit, stack.depth);
  }

  template <typename Look>
  bool visitStack(const Point& at, Stack& stack, double& limit, const Look& look) const {
    while (stack.depth > 0) {
      const Entry entry = stack.entries[--stack.depth];
      if (!(entry.square <= roundedUp(limit)))
        continue;
      if (!(entry.child & kTriangle))
        addChildren(at, nodes_[entry.child], stack, limit);
      else if (look(entry.child & ~kTriangle, limit))
        return true;
    }
    return false;
  }

  struct Builder;
  void addNodes(const std::vector<Node>& nodes, std::uint32_t root);

  std::vector<Node> nodes_; ///< the root first
  std::vector<NearTriangle> triangles_;
};

/// The part of a tree that meets a box: its triangles, or nodes where these are many. Visits that
/// stay within `reach` of the box begin here instead of at the root.
class TriangleTree::Cut {
public:
  Cut(const TriangleTree& tree, const Box& box, double reach);

private:
  friend class TriangleTree;
  std::size_t count_ = 0;
  Node nodes_[kCutNodes];
};

template <typename Look>
bool TriangleTree::visit(const Cut& cut, const Vec3d& p, double limit, const Look& look) const {
  const Point at(p);
  Stack stack;
  for (std::size_t i = 0; i < cut.count_; ++i)
    addChildren(at, cut.nodes_[i], stack, limit, 0);
  return visitStack(at, stack, limit, look);
}

} // namespace tetvdb
