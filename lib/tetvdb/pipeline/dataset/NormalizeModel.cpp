// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/dataset/NormalizeModel.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/voxelize/ChooseTransform.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

using Matrix3 = std::array<Vec3d, 3>; // rows

Matrix3 product(const Matrix3& a, const Matrix3& b) {
  Matrix3 c{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  return c;
}

Vec3d product(const Matrix3& a, const Vec3d& p) {
  return {dot(a[0], p), dot(a[1], p), dot(a[2], p)};
}

// A rotation about z, or a uniform one (Shoemake, Uniform Random Rotations, 1992).
Matrix3 randomTurn(bool any, RandomNumbers& random) {
  if (!any) {
    const double angle = 2 * kPi * random.uniform();
    return {
        {{std::cos(angle), -std::sin(angle), 0}, {std::sin(angle), std::cos(angle), 0}, {0, 0, 1}}};
  }
  const double u = random.uniform(), a = 2 * kPi * random.uniform(), b = 2 * kPi * random.uniform();
  const double r = std::sqrt(1 - u), s = std::sqrt(u);
  const double x = r * std::sin(a), y = r * std::cos(a), z = s * std::sin(b), w = s * std::cos(b);
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
}

double lengthOf(const TriangleMesh& mesh, const WorldBox& box, const Vec3d& centre,
                NormalLength normalize) {
  const Vec3d size = minus(box.max, box.min);
  if (normalize == NormalLength::Diagonal)
    return length(size);
  if (normalize != NormalLength::Sphere)
    return std::max({size[0], size[1], size[2]});
  double radius = 0;
  for (const std::uint32_t corner : mesh.triangles)
    radius = std::max(radius, length(minus(mesh.points[corner], centre)));
  return 2 * radius;
}

} // namespace

NormalModel normalizeModel(TriangleMesh& mesh, const DatasetOptions& options, int variant,
                           RandomNumbers& random) {
  Matrix3 turn{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  if (options.yUp)
    turn = {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
  if (variant > 0)
    turn = product(randomTurn(options.turnAny, random), turn);
  for (Vec3d& point : mesh.points)
    point = product(turn, point);

  const WorldBox box = boxOfUsed(mesh.points, mesh.triangles);
  const Vec3d middle = plus(times(box.min, 0.5), times(box.max, 0.5));
  const double model = lengthOf(mesh, box, middle, options.normalize);
  if (!(model > 0) || !std::isfinite(model) || !std::isfinite(1 / model))
    throw Error(Status::Invalid, "", "the model has no extent");

  const bool keeps = options.normalize == NormalLength::None;
  double scale = keeps ? 1 : 1 / model;
  Vec3d move{0, 0, 0};
  if (variant > 0) {
    scale *= 1 - options.scaleJitter * random.uniform();
    for (double& along : move)
      along = options.moveJitter * (2 * random.uniform() - 1) * (keeps ? model : 1);
  }
  NormalModel normal;
  normal.centre = keeps ? middle : Vec3d{0, 0, 0};
  normal.side = (1 + options.padding) * (keeps ? model : 1);
  // Turned about the centre of the box, which becomes the centre of the cube.
  const Vec3d to = plus(normal.centre, move);
  for (Vec3d& point : mesh.points)
    point = plus(times(minus(point, middle), scale), to);
  const Vec3d offset = minus(to, times(middle, scale));
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      normal.transform[4 * i + j] = scale * turn[i][j];
    normal.transform[4 * i + 3] = offset[i];
  }
  normal.transform[15] = 1;
  return normal;
}

} // namespace tetvdb
