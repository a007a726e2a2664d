// SPDX-License-Identifier: Apache-2.0
//
// Collects points and polygons of a file in a TriangleMesh.
//
//   tetvdb::FaceCollector faces(source.path);
//   faces.addPoint({x, y, z});
//   faces.addPolygon(corners.data(), corners.size());
//   return faces.finish(report);
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

/// Points may be added before or after the polygons that use them. A polygon with a point that does
/// not exist or is not finite, or with fewer than three corners, is omitted and counted.
class FaceCollector {
public:
  static constexpr std::uint32_t kNone = UINT32_MAX; ///< a corner that is not a point

  explicit FaceCollector(std::string path) : path_(std::move(path)) {}

  void reserve(std::size_t points, std::size_t triangles) {
    mesh_.points.reserve(points);
    mesh_.triangles.reserve(3 * triangles);
  }
  std::size_t pointCount() const { return mesh_.points.size(); }
  /// Number of added faces, including invalid ones.
  std::size_t faceCount() const { return facesSeen_; }

  /// Whether the end of the file may have truncated this number: whether a longer one would also be
  /// a valid point.
  bool mayBeCut(std::uint32_t corner) const {
    return corner > 0 && std::uint64_t(corner) * 10 < pointCount();
  }

  /// A point that is not finite is replaced by (0, 0, 0).
  void addPoint(const Vec3d& p) {
    if (mesh_.points.size() >= kNone)
      failTooManyPoints();
    if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) {
      mesh_.points.push_back(p);
      return;
    }
    badPoints_.push_back(static_cast<std::uint32_t>(mesh_.points.size()));
    mesh_.points.push_back({0, 0, 0});
  }
  /// Adds a point whose coordinates cannot be read.
  void addUnreadablePoint() { addPoint({NAN, NAN, NAN}); }

  /// Adds a polygon as a fan from its first corner.
  void addPolygon(const std::uint32_t* corners, std::size_t n) {
    ++facesSeen_;
    if (n < 3) {
      noteBadFace(facesSeen_);
      return;
    }
    const bool sure = badPoints_.empty() && std::all_of(corners, corners + n, [&](auto corner) {
                        return corner < mesh_.points.size();
                      });
    if (!sure)
      suspects_.push_back({mesh_.triangles.size(), n - 2, facesSeen_});
    for (std::size_t k = 1; k + 1 < n; ++k)
      mesh_.triangles.insert(mesh_.triangles.end(), {corners[0], corners[k], corners[k + 1]});
  }
  /// Adds a face that cannot be read.
  void addUnreadableFace() { noteBadFace(++facesSeen_); }

  /// Removes invalid faces, with the warnings `bad-faces` (and report.partial) and `bad-vertices`.
  /// Throws Error(Invalid) if no face is left.
  TriangleMesh finish(Report& report);

private:
  /// Triangles from `first` on that may use a bad point.
  struct Suspect {
    std::size_t first, count, face;
  };
  bool isBad(std::uint32_t point) const {
    return point >= mesh_.points.size() ||
           std::binary_search(badPoints_.begin(), badPoints_.end(), point);
  }
  void noteBadFace(std::size_t number) {
    firstBadFace_ = badFaces_ == 0 ? number : std::min(firstBadFace_, number);
    ++badFaces_;
  }
  void removeBadSuspects();
  [[noreturn]] void failTooManyPoints() const;

  std::string path_;
  TriangleMesh mesh_;
  std::vector<std::uint32_t> badPoints_; ///< ascending
  std::vector<Suspect> suspects_;        ///< ascending
  std::size_t facesSeen_ = 0;
  std::size_t badFaces_ = 0;
  std::size_t firstBadFace_ = 0;
};

/// "1 face was left out: WHY" or "7 faces were left out: WHY", as the warning `bad-faces`, with
/// report.partial set.
void warnOfBadFaces(Report& report, std::size_t count, const std::string& why);

} // namespace tetvdb
