// SPDX-License-Identifier: Apache-2.0
//
// Collects the meshes of a scene, with repetitions, in one TriangleMesh.
#pragma once

#include "tetvdb/core/Error.h"
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
  explicit PlacedFaces(const std::string& path) : path_(path), faces_(path) {}

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
  /// A mesh of triangles, which may be one of many that a file of `fileBytes` repeats: the size of
  /// a single one is not limited. Throws as failRepeated().
  void addMesh(const Placement& placement, const std::vector<Vec3d>& points,
               const std::vector<std::uint32_t>& triangles, std::uint64_t fileBytes) {
    constexpr std::uint64_t kMaxNumbers = std::uint64_t(1) << 28; // points and corners
    const std::uint64_t numbers = points.size() + triangles.size();
    if (numbers_ > 0 && numbers_ + numbers > std::max(kMaxNumbers, fileBytes))
      failRepeated();
    numbers_ += numbers;
    beginMesh(placement, points.size());
    for (const Vec3d& p : points)
      addPoint(p);
    for (std::size_t i = 0; i < triangles.size(); i += 3)
      addPolygon(triangles.data() + i, 3);
  }
  /// To be called for every placement, nested ones counted again. Throws as failRepeated().
  void countPlacement(std::size_t depth) {
    constexpr std::size_t kMaxPlacements = std::size_t(1) << 20, kMaxDepth = 256;
    if (++placements_ > kMaxPlacements || depth > kMaxDepth)
      failRepeated();
  }
  TriangleMesh finish(Report& report) { return faces_.finish(report); }

private:
  /// Throws Error(Limit).
  [[noreturn]] void failRepeated() const {
    throw Error(Status::Limit, path_, "its parts contain one another too often or too deeply",
                "merge the parts and export it again");
  }

  std::string path_;
  FaceCollector faces_;
  Placement placement_;
  bool mirrored_ = false;
  std::size_t first_ = 0; ///< number of the mesh's first point
  std::size_t points_ = 0;
  std::vector<std::uint32_t> corners_;
  std::size_t placements_ = 0;
  std::uint64_t numbers_ = 0; ///< points and corners of addMesh()
};

} // namespace tetvdb
