// SPDX-License-Identifier: Apache-2.0
//
// Points of the input that the mesh's surface must stay near to.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/tetrahedralize/soup/Envelope.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// Where a surface within the envelope can still leave the input: at the input's points, and along
/// edges that are not nearly flat. (Elsewhere the envelope is a slab, and a surface that crosses it
/// stays within its thickness.) Every change is compared with the landmarks themselves, so that the
/// errors of many changes do not add up.
/// Immutable once made; queries are thread-safe.
class Landmarks {
public:
  using Face = std::array<Vec3d, 3>;

  /// Landmarks of the envelope's faces, and `more`. Along edges one every `radius`, or half a
  /// million evenly where there would be more. Parallel, n log n in faces and landmarks, about a
  /// second for a million on one thread.
  Landmarks(const Envelope& surface, double radius, const std::vector<Vec3d>& more = {});

  std::size_t size() const { return points_.size(); }

  /// Whether faces `after` may replace `before`: every landmark that was no farther than
  /// the radius from `before` is no farther than kShare of the radius from `after`, or no farther
  /// than it was.
  bool keeps(const std::vector<Face>& before, const std::vector<Face>& after) const;

  /// A margin for the points between landmarks.
  static constexpr double kShare = 0.98;

private:
  double radius_;
  BoxTree points_; ///< a box each
};

} // namespace tetvdb
