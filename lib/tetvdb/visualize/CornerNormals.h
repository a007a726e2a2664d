// SPDX-License-Identifier: Apache-2.0
//
// Normals for smooth shading.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// A direction in four bytes, within 0.003 degrees: its octahedron unfolded into a square. (Z. H.
/// Cigolle et al., "A survey of efficient representations for independent unit vectors", 2014.)
using PackedNormal = std::array<std::int16_t, 2>;
PackedNormal packNormal(const std::array<float, 3>& normal);
std::array<float, 3> unpackNormal(const PackedNormal& packed);

/// A normal for each corner of each face: the mean, weighted by the angle at the point, of those
/// faces at the point whose normals are within `creaseDegrees` of the face's own. Points at one
/// position count as one; flipped faces do not count, nor do those without area. Parallel, the same
/// for any number of threads; about 0.5 us a face.
std::vector<PackedNormal> cornerNormals(const TriangleMesh& mesh, double creaseDegrees,
                                        Progress& progress);

} // namespace tetvdb
