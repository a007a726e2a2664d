// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

namespace tetvdb {

/// The area of all faces, world units squared. Serial.
double areaOf(const TriangleMesh& mesh);

/// The signed volume of a closed mesh, world units cubed: positive where faces look outward.
/// Serial.
double volumeOf(const TriangleMesh& mesh);

} // namespace tetvdb
