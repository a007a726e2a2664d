// SPDX-License-Identifier: Apache-2.0
//
// A surface during simplification, and the points of the input that its faces represent.
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/FeatureEdges.h"
#include "tetvdb/surface/SimplifySurface.h"
#include "tetvdb/surface/TriangleScene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace tetvdb {

/// The sum of squared distances to planes, weighted by area: a symmetric 4 x 4 matrix (Garland and
/// Heckbert 1997).
struct Quadric {
  std::array<double, 10> m{};

  void add(const Vec3d& n, double d, double weight) {
    const std::array<double, 4> v{n[0], n[1], n[2], d};
    std::size_t k = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i; j < 4; ++j)
        m[k++] += weight * v[i] * v[j];
  }
  void add(const Quadric& other) {
    for (std::size_t k = 0; k < m.size(); ++k)
      m[k] += other.m[k];
  }
  double at(const Vec3d& p) const {
    return p[0] * (m[0] * p[0] + 2 * (m[1] * p[1] + m[2] * p[2] + m[3])) +
           p[1] * (m[4] * p[1] + 2 * (m[5] * p[2] + m[6])) + p[2] * (m[7] * p[2] + 2 * m[8]) + m[9];
  }
};

/// The fraction of the tolerance that is enforced at the tested points, not between them.
constexpr double kHeldTolerance = 0.65;

/// Lengths are in units of the tolerance (without one: of a thousandth of the box's diagonal),
/// relative to the centre of the box.
struct SimplifyState {
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

  TriangleMesh mesh;                         ///< points in world units; corners change
  bool outward;                              ///< as SimplifyOptions::outward
  std::unique_ptr<TriangleScene> original;   ///< null without a tolerance
  std::vector<char> isGone;                  ///< by face
  std::vector<VertexPair> features;          ///< ascending
  double longSide = 0;                       ///< squared; longer sides are tested at more points
  double meanEdge = 0;                       ///< of the input
  std::vector<Vec3d> points;                 ///< vertices, then midpoints of edges
  std::vector<std::array<float, 3>> normals; ///< of unit length, by point
  std::vector<Quadric> quadrics;             ///< by vertex
  std::vector<char> isTested;                ///< by vertex: cannot be removed while its faces stay
  /// Points of the input that must stay close, as linked lists: each belongs to the nearest face.
  /// Vertices are added when they are removed from the surface. Midpoints of edges, numbered after
  /// the vertices, are in the lists from the beginning, since a surface can bend between its
  /// vertices.
  std::vector<std::uint32_t> firstGone; ///< by face
  std::vector<std::uint32_t> nextGone;  ///< by point

  /// `before` must outlive the state. Throws Error(Invalid) unless every edge has two faces in
  /// opposite directions.
  SimplifyState(const TriangleMesh& before, const SimplifyOptions& options);

  /// Whether a point of the new surface is close to the input.
  bool isNear(const Vec3d& p) const;
  std::size_t liveFaces() const;

private:
  Vec3d midpoint_{0, 0, 0}; ///< centre of the box
  double unit_ = 1;         ///< in world units
};

} // namespace tetvdb
