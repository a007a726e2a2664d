// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/TetWeights.h"

#include "tetvdb/voxelize/Ownership.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

// Cross products and the determinant round by at most 2^-48 size^3 in doubles: above this share of
// size^3 a weight is good to 2^-30.
constexpr double kLeastDeterminant = 0x1p-18;

bool isBefore(const LatticePoint& a, const LatticePoint& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

} // namespace

TetWeights::TetWeights(const SnappedMesh& mesh, std::size_t tet) {
  const std::uint32_t* v = mesh.tets + 4 * tet;
  corners_ = {0, 1, 2, 3};
  for (std::size_t i = 0; i < 4; ++i)
    points_[i] = mesh.points[v[i]];
  const auto order = [&](std::size_t a, std::size_t b) {
    if (!isBefore(points_[b], points_[a]))
      return;
    std::swap(points_[a], points_[b]);
    std::swap(corners_[a], corners_[b]);
  };
  order(0, 1);
  order(2, 3);
  order(0, 2);
  order(1, 3);
  order(1, 2);

  double e[3][3]; // differences of lattice points are exact
  double size = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    e[i][0] = points_[i + 1].x - points_[0].x;
    e[i][1] = points_[i + 1].y - points_[0].y;
    e[i][2] = points_[i + 1].z - points_[0].z;
    for (const double c : e[i])
      size = std::max(size, std::abs(c));
  }
  const auto cross = [&](std::size_t a, std::size_t b, double(&n)[3]) {
    n[0] = e[a][1] * e[b][2] - e[a][2] * e[b][1];
    n[1] = e[a][2] * e[b][0] - e[a][0] * e[b][2];
    n[2] = e[a][0] * e[b][1] - e[a][1] * e[b][0];
  };
  cross(1, 2, gradients_[0]);
  cross(2, 0, gradients_[1]);
  cross(0, 1, gradients_[2]);
  const double determinant =
      e[0][0] * gradients_[0][0] + e[0][1] * gradients_[0][1] + e[0][2] * gradients_[0][2];
  exact_ = !(std::abs(determinant) > kLeastDeterminant * size * size * size);
  for (auto& gradient : gradients_)
    for (double& g : gradient)
      g /= determinant;
}

// By Cramer's rule: the weight of a corner is the volume with the centre in its place.
std::array<double, 3> TetWeights::exactAt(const double (&d)[3]) const {
  const LatticePoint centre{points_[0].x + d[0], points_[0].y + d[1], points_[0].z + d[2]};
  const auto volume = [&](int replaced) {
    std::array<LatticePoint, 4> p = points_;
    if (replaced > 0)
      p[static_cast<std::size_t>(replaced)] = centre;
    return static_cast<double>(orientation(p[0], p[1], p[2], p[3]));
  };
  const double whole = volume(0);
  return {volume(1) / whole, volume(2) / whole, volume(3) / whole};
}

} // namespace tetvdb
