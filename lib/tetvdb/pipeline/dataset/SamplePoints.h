// SPDX-License-Identifier: Apache-2.0
//
// Generates random points on and around a surface, the same for equal seeds.
#pragma once

#include "tetvdb/core/MixBits.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The sequence of SplitMix64 from a seed.
class RandomNumbers {
public:
  explicit RandomNumbers(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() { return mixBits(state_ += kGoldenRatio); }
  /// In [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// Standard normal (Box and Muller 1958).
  double normal();
  /// Uniform on the unit sphere.
  Vec3d direction();

private:
  std::uint64_t state_;
};

struct SurfacePoints {
  std::vector<Vec3d> points, normals; ///< normals of unit length
};

/// `count` points, uniform over the area of the mesh; none where it has no area. Linear in faces
/// and points.
SurfacePoints sampleSurface(const TriangleMesh& mesh, std::size_t count, RandomNumbers& random);

/// `count` points, uniform over the length of the edges where faces meet at more than `degrees`
/// from flat or that have other than two faces; none where there are no such edges.
std::vector<Vec3d> sampleFeatureEdges(const TriangleMesh& mesh, double degrees, std::size_t count,
                                      RandomNumbers& random);

/// Moves every point by normal deviates of that standard deviation along each axis.
void scatter(std::vector<Vec3d>& points, double deviation, RandomNumbers& random);

} // namespace tetvdb
