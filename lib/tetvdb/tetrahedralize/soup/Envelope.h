// SPDX-License-Identifier: Apache-2.0
//
// The neighbourhood of the input that the mesh's surface must stay in.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace tetvdb {

/// All points no farther than epsilon from triangles. Triangles (a, b, b) are segments: the
/// envelope of boundary edges is made from these. Answers are conservative: yes is a proof up to
/// rounding, no may be wrong only within a small fraction of epsilon (kSlack) of the envelope's
/// border.
///   A triangle's neighbourhood is convex, so that a candidate whose corners are all near one input
/// triangle is in at once. Others are cut. A part is in where its centre's distance and its own
/// radius add up to no more than epsilon (distance is 1-Lipschitz), and out where its centre is
/// out. One query visits 20 000 parts at most, some ten milliseconds, and answers no where that is
/// not enough: a candidate over tens of thousands of triangles may be refused. Immutable once made;
/// queries are thread-safe and depend on nothing but their arguments.
class Envelope {
public:
  static constexpr double kSlack = 0.02;

  /// `epsilon` in the points' units, above 0. Keeps its own copy of what it needs. Parallel.
  Envelope(const std::vector<Vec3d>& points, const std::vector<std::array<std::uint32_t, 3>>& faces,
           double epsilon);
  ~Envelope();
  Envelope(const Envelope&) = delete;
  Envelope& operator=(const Envelope&) = delete;

  double epsilon() const;
  bool empty() const; ///< no faces: contains nothing
  /// Corners of the faces, in an order of its own; exact where they are lattice points.
  std::vector<std::array<Vec3d, 3>> faces() const;

  /// Whether a point, a segment, a triangle lies within `radius` of the faces. 0 < radius <=
  /// epsilon().
  bool contains(const Vec3d& p, double radius) const;
  bool contains(const Vec3d& p, const Vec3d& q, double radius) const;
  bool contains(const Vec3d& p, const Vec3d& q, const Vec3d& r, double radius) const;

  /// A bound on how far any point of a triangle is from the faces; infinity where the triangle is
  /// not within `radius`. Costs no more than contains().
  double depth(const Vec3d& p, const Vec3d& q, const Vec3d& r, double radius) const;

  struct Nearest {
    Vec3d point{0, 0, 0};
    double distance = 0;
    std::uint32_t face = 0; ///< of equally near ones the lowest
  };
  /// The nearest point of the faces, wherever p is. Not for an empty envelope.
  Nearest nearest(const Vec3d& p) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace tetvdb
