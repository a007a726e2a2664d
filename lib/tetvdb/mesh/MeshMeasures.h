// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// The box of the points with these numbers; empty if there are none. Serial.
Box boxOf(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& used);

/// The area of all faces, world units squared. Serial.
double areaOf(const TriangleMesh& mesh);

/// The signed volume of a closed mesh, world units cubed: positive where faces look outward.
/// Serial.
double volumeOf(const TriangleMesh& mesh);

} // namespace tetvdb
