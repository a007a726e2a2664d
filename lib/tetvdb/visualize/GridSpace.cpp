// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/GridSpace.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/visualize/EntryMap.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

Vec3d product(const std::array<Vec3d, 3>& m, const Vec3d& v) {
  return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}

} // namespace

GridSpace::GridSpace(const openvdb::math::Transform& transform) {
  if (!transform.isLinear())
    throw Error(Status::Invalid, "", "the grid's transform is not linear",
                "resample it to a linear one");
  const openvdb::Mat4d map = transform.baseMap()->getAffineMap()->getMat4();
  const openvdb::Mat4d back = map.inverse();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) { // OpenVDB's vectors are rows
      const auto r = static_cast<std::size_t>(row), c = static_cast<std::size_t>(column);
      toWorld_[r][c] = map[column][row];
      toIndex_[r][c] = back[column][row];
    }
  const openvdb::Vec3d corner = map.transform(openvdb::Vec3d(-0.5));
  origin_ = {corner[0], corner[1], corner[2]};
  const openvdb::Vec3d size = transform.voxelSize();
  voxel_ = std::min(size[0], std::min(size[1], size[2]));
}

Vec3d GridSpace::toIndex(const Vec3d& world) const {
  return product(toIndex_, minus(world, origin_));
}

Vec3d GridSpace::toWorld(const Vec3d& index) const {
  return plus(origin_, product(toWorld_, index));
}

IndexRay GridSpace::toIndex(const Ray& ray) const {
  IndexRay result;
  result.origin = toIndex(ray.origin);
  result.direction = product(toIndex_, ray.direction);
  result.tMin = ray.tMin;
  result.tMax = ray.tMax;
  return result;
}

Vec3d GridSpace::normal(const Vec3d& gradient) const {
  Vec3d n{0, 0, 0}; // gradients are rows: by the inverse's transpose
  for (std::size_t axis = 0; axis < 3; ++axis)
    n = plus(n, times(toIndex_[axis], gradient[axis]));
  const double size = length(n);
  return size > 0 ? times(n, 1 / size) : n;
}

Box GridSpace::bounds(const Vec3i& low, const Vec3i& high) const {
  Box box;
  if (low[0] > high[0])
    return box;
  for (int corner = 0; corner < 8; ++corner)
    box.add(toWorld({corner & 1 ? high[0] + 1.0 : low[0], corner & 2 ? high[1] + 1.0 : low[1],
                     corner & 4 ? high[2] + 1.0 : low[2]}));
  return box;
}

double GridSpace::support(const ActiveTree& tree, const Vec3d& direction) const {
  Vec3d inIndex{}; // a dot product in the world is one in index space, by the matrix's transpose
  for (std::size_t row = 0; row < 3; ++row)
    inIndex = plus(inIndex, times(toWorld_[row], direction[row]));
  return dot(direction, origin_) + tree.support(inIndex);
}

void GridSpace::mark(const ActiveTree& tree, EntryMap& map) const {
  const View& view = map.view();
  const std::array<Vec3d, 3> axes = {view.right, view.up, view.toEye};
  Vec3d half{0, 0, 0}; // of a voxel
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t column = 0; column < 3; ++column)
      half[a] += std::abs(toWorld_[0][column] * axes[a][0] + toWorld_[1][column] * axes[a][1] +
                          toWorld_[2][column] * axes[a][2]) /
                 2;
  tree.forCubes([&](const Vec3i& low, std::int32_t side) {
    const double toCentre = side / 2.0;
    map.add(toWorld({low[0] + toCentre, low[1] + toCentre, low[2] + toCentre}),
            times(half, side + 2.0));
  });
}

} // namespace tetvdb
