// SPDX-License-Identifier: Apache-2.0
#include "SolidAngleOracle.h"
#include "TriangleMeshes.h"

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>

namespace tetvdb::meshes {

double windingNumberAt(const TriangleMesh& mesh, const Vec3d& p) {
  // The angles of complex numbers add up where these are multiplied: one arctangent serves several
  // faces, as long as the angles of eight together are less than half a turn.
  double sum = 0;
  std::complex<double> product = 1;
  int factors = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    std::array<Vec3d, 3> v;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        v[k][axis] = mesh.points[mesh.triangles[i + k]][axis] - p[axis];
    const std::complex<double> half = test::halfSolidAngle(v);
    const double scale = std::abs(half.real()) + std::abs(half.imag());
    if (std::abs(half.imag()) >= 0.4 * half.real()) { // an angle of more than 0.38
      sum += std::arg(half);
      continue;
    }
    product = {(product.real() * half.real() - product.imag() * half.imag()) / scale,
               (product.real() * half.imag() + product.imag() * half.real()) / scale};
    if (++factors == 8) {
      sum += std::arg(product);
      product = 1;
      factors = 0;
    }
  }
  return 2 * (sum + std::arg(product)) / static_cast<double>(test::kSphere);
}

} // namespace tetvdb::meshes
