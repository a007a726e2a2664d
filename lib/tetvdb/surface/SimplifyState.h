// SPDX-License-Identifier: Apache-2.0
//
// A surface on its way to fewer triangles, and what its vertices and faces represent.
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

/// Sum over planes of the squared distance, weighted by area: a symmetric 4 x 4 matrix (Garland and
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

/// The share of the tolerance that is held at the points looked at; between them lies the rest.
constexpr double kHeldTolerance = 0.65;

/// Lengths are in tolerances (where there is none: in thousandths of the box's diagonal), relative
/// to the middle of the box.
struct SimplifyState {
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

  TriangleMesh mesh;                         ///< points as they are, in world units; corners change
  std::unique_ptr<TriangleScene> original;   ///< null without a tolerance
  std::vector<char> isGone;                  ///< of a face
  std::vector<VertexPair> features;          ///< ascending
  double longSide = 0;                       ///< squared: a side that is looked at more closely
  double meanEdge = 0;                       ///< of the old surface
  std::vector<Vec3d> points;                 ///< vertices, then middles of edges
  std::vector<std::array<float, 3>> normals; ///< of unit length, at points
  std::vector<Quadric> quadrics;             ///< at vertices
  /// Points of the old surface that have to stay near, as lists: each belongs to the face next to
  /// it. Vertices come in once they are gone, middles of edges, numbered after them, from the
  /// start: between its vertices a surface can be bent more than the tolerance.
  std::vector<std::uint32_t> firstGone; ///< of a face
  std::vector<std::uint32_t> nextGone;  ///< of a point

  /// `before` must outlive the state. Throws Error(Invalid) unless every edge has two faces that
  /// run along it in opposite directions.
  SimplifyState(const TriangleMesh& before, const SimplifyOptions& options);

  /// Whether a place of the new surface is near the old one.
  bool isNear(const Vec3d& p) const;
  std::size_t liveFaces() const;

private:
  Vec3d midpoint_{0, 0, 0}; ///< of the box
  double unit_ = 1;         ///< in world units
};

} // namespace tetvdb
