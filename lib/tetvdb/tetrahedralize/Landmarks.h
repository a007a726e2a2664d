// SPDX-License-Identifier: Apache-2.0
//
// Points of the input that the mesh's surface must stay near to.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/tetrahedralize/Envelope.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Where a surface that stays in the envelope can all the same go away from the input: at its
/// points, and along edges that are not nearly flat. (Elsewhere the envelope is a slab: what
/// crosses it stays within its thickness.) Changes are compared with these themselves and not with
/// what they were changed to before, so that small errors of many changes do not add up.
/// Immutable once made; queries are thread-safe.
class Landmarks {
public:
  using Face = std::array<Vec3d, 3>;

  /// Of the envelope's faces; along edges one every `radius`, or half a million evenly where these
  /// would be more. n log n in faces and landmarks, about a second for a million.
  /// `more` are points to be kept besides.
  Landmarks(const Envelope& surface, double radius, const std::vector<Vec3d>& more = {});

  std::size_t size() const { return points_.size(); }

  /// Whether faces `after` may take the place of `before`: every landmark that was no farther than
  /// the radius from `before` is no farther than kShare of the radius from `after`, or no farther
  /// than it was.
  bool keeps(const std::vector<Face>& before, const std::vector<Face>& after) const;

  /// What is between landmarks may be a little farther away than these.
  static constexpr double kShare = 0.98;

private:
  struct Node {
    Vec3d low, high;
    std::uint32_t begin, end; ///< of points
    std::uint32_t second;     ///< child, the first one follows its parent; 0: a leaf
  };

  std::uint32_t addNode(std::uint32_t begin, std::uint32_t end);
  bool keeps(const Vec3d& p, const std::vector<Face>& before, const std::vector<Face>& after) const;

  double radius_;
  std::vector<Vec3d> points_;
  std::vector<Node> nodes_;
};

} // namespace tetvdb
