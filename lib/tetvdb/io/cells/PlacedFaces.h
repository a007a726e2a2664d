// SPDX-License-Identifier: Apache-2.0
//
// Collects the meshes of a scene, with repetitions, in one TriangleMesh.
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/io/cells/FaceCollector.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

/// p -> linear part * p + last column.
struct Placement {
  std::array<std::array<double, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  Vec3d operator()(const Vec3d& p) const {
    Vec3d q{};
    for (std::size_t i = 0; i < 3; ++i)
      q[i] = rows[i][0] * p[0] + rows[i][1] * p[1] + rows[i][2] * p[2] + rows[i][3];
    return q;
  }
  /// First `inner`, then this one.
  Placement operator*(const Placement& inner) const {
    Placement product;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 4; ++j)
        product.rows[i][j] = rows[i][0] * inner.rows[0][j] + rows[i][1] * inner.rows[1][j] +
                             rows[i][2] * inner.rows[2][j] + (j == 3 ? rows[i][3] : 0);
    return product;
  }
  /// Whether it reverses orientations.
  bool mirrors() const {
    const auto& m = rows;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
           0;
  }
};

/// A mesh begins with beginMesh(); its points and polygons follow in the mesh's own coordinates and
/// numbers from 0.
class PlacedFaces {
public:
  explicit PlacedFaces(std::string path) : faces_(std::move(path)) {}

  void beginMesh(const Placement& placement, std::size_t points) {
    placement_ = placement;
    mirrored_ = placement.mirrors();
    first_ = faces_.pointCount();
    points_ = points;
  }
  std::size_t pointCount() const { return faces_.pointCount(); }
  void addPoint(const Vec3d& p) { faces_.addPoint(placement_(p)); }
  void addPolygon(const std::uint32_t* corners, std::size_t n) {
    corners_.assign(corners, corners + n);
    for (std::uint32_t& corner : corners_)
      corner =
          corner < points_ ? static_cast<std::uint32_t>(first_ + corner) : FaceCollector::kNone;
    if (mirrored_ && n > 2) // outward again, and a fan from the same corner
      std::reverse(corners_.begin() + 1, corners_.end());
    faces_.addPolygon(corners_.data(), n);
  }
  TriangleMesh finish(Report& report) { return faces_.finish(report); }

private:
  FaceCollector faces_;
  Placement placement_;
  bool mirrored_ = false;
  std::size_t first_ = 0; ///< number of the mesh's first point
  std::size_t points_ = 0;
  std::vector<std::uint32_t> corners_;
};

} // namespace tetvdb
