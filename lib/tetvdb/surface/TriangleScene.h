// SPDX-License-Identifier: Apache-2.0
//
// Ray and closest-point queries on a triangle mesh, by Embree.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace tetvdb {

/// A search structure over the triangles of a mesh, which must outlive it. Vertices are translated
/// to the box's centre and scaled to its size before they are converted to floats, so that a mesh
/// far from the origin keeps its precision. Queries are const and thread-safe.
class TriangleScene {
public:
  explicit TriangleScene(const TriangleMesh& mesh);
  ~TriangleScene();
  TriangleScene(const TriangleScene&) = delete;
  TriangleScene& operator=(const TriangleScene&) = delete;

  struct Hit {
    double t; ///< in units of the direction, which need not be normalised
    std::uint32_t triangle;
    bool leaving; ///< the ray runs along the triangle's normal: out of the solid
  };
  /// Finds every triangle that the ray crosses at 0 <= t <= tMax, in order of (t, triangle), in
  /// floats (about 1e-7 of the box); a ray through an edge may hit one or both of its faces.
  void crossings(const Vec3d& origin, const Vec3d& direction, double tMax,
                 std::vector<Hit>& hits) const;

  struct Closest {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = 0xFFFFFFFFu;
    Vec3d point{0, 0, 0};
  };
  /// The point of the mesh closest to `p`, if it is closer than `maxDistance`, computed in doubles;
  /// of equally close triangles, the one with the lowest number.
  Closest closest(const Vec3d& p,
                  double maxDistance = std::numeric_limits<double>::infinity()) const;

  /// Whether a point of the mesh is closer to `p` than `distance`; several times faster than
  /// closest(). The triangle `first`, if given, is tried before others, and becomes the one that
  /// was found: of points that lie one beside the other, mostly the same.
  bool isWithin(const Vec3d& p, double distance, std::uint32_t* first = nullptr) const;

  /// Of unit length; 0 for a face without area.
  Vec3d normal(std::uint32_t triangle) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace tetvdb
