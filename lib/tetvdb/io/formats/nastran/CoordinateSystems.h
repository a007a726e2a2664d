// SPDX-License-Identifier: Apache-2.0
//
// Nastran's coordinate systems: rectangular, cylindrical and spherical ones, each defined by three
// points in another one.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>

namespace tetvdb {

enum class CoordinateKind : std::uint8_t {
  Rectangular, ///< x, y, z
  Cylindrical, ///< r, theta in degrees, z
  Spherical    ///< r, theta from the z axis, phi around it, in degrees
};

struct CoordinateSystem {
  CoordinateKind kind = CoordinateKind::Rectangular;
  std::int64_t reference = 0; ///< the system of `points`; 0: the basic one
  /// The origin, a point on the z axis, and one in the half of the xz plane where x is positive.
  std::array<Vec3d, 3> points{};
  /// These points as GRID entries instead; 0: none.
  std::array<std::int64_t, 3> grids{};
};

class CoordinateSystems {
public:
  void add(std::int64_t number, const CoordinateSystem& system) { systems_[number] = {system, {}}; }

  /// The position of a GRID entry in the basic system; none if there is no such entry.
  using GridPosition = std::function<std::optional<Vec3d>(std::int64_t grid)>;

  /// A position in the basic system. None if the system does not exist, is defined by itself or by
  /// points that do not exist or lie on a line, or through more than 200 others.
  std::optional<Vec3d> toBasic(std::int64_t system, const Vec3d& position,
                               const GridPosition& gridPosition);

private:
  struct Frame {
    Vec3d origin{};
    std::array<Vec3d, 3> axes{};
  };
  struct Entry {
    CoordinateSystem system;
    std::optional<Frame> frame;
  };
  const Frame* frameOf(Entry& entry, const GridPosition& gridPosition);

  std::map<std::int64_t, Entry> systems_;
  int depth_ = 0; ///< systems that are being framed
};

} // namespace tetvdb
