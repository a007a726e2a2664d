// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/Grids.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/volume/GridTypes.h"

#include <cmath>
#include <mutex>
#include <openvdb/io/io.h>
#include <openvdb/math/Maps.h>
#include <openvdb/util/Name.h>
#include <optional>
#include <sstream>
#include <utility>

namespace tetvdb {

Volume::Volume() : grids_(std::make_shared<GridSet>()) {}

Volume::Volume(std::shared_ptr<GridSet> grids) : grids_(std::move(grids)) {
  if (!grids_)
    grids_ = std::make_shared<GridSet>();
}

void initializeOpenVDB() {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
}

openvdb::math::Transform::Ptr makeTransform(const GridTransform& transform) {
  namespace math = openvdb::math;
  const openvdb::Vec3d size(transform.voxelSize.data()), origin(transform.origin.data());
  for (int axis = 0; axis < 3; ++axis) {
    if (!(size[axis] > 0) || !std::isfinite(size[axis]))
      throw Error(Status::Usage, "voxel size", "is not a positive finite number");
    if (!std::isfinite(origin[axis]))
      throw Error(Status::Usage, "origin", "is not a finite number");
  }
  // OpenVDB refuses a map whose determinant is below its tolerance.
  const double volume = size[0] * size[1] * size[2];
  if (!(volume > 3.0e-15) || !std::isfinite(volume))
    throw Error(Status::Usage, "voxel size",
                "a voxel's volume must be above 3e-15 cubic units and finite",
                "use a smaller unit of length, such as millimetres instead of metres");

  const bool uniform = size[0] == size[1] && size[1] == size[2];
  initializeOpenVDB(); // reading needs the registry of maps
  math::MapBase::Ptr map;
  if (origin == openvdb::Vec3d(0.0)) {
    if (uniform)
      map.reset(new math::UniformScaleMap(size[0]));
    else
      map.reset(new math::ScaleMap(size));
  } else {
    if (uniform)
      map.reset(new math::UniformScaleTranslateMap(size[0], origin));
    else
      map.reset(new math::ScaleTranslateMap(size, origin));
  }
  // Transform's constructor decomposes a map and builds it again, which rounds the sizes where
  // there is an origin. Reading, as from a file, takes the map as it is.
  std::stringstream stream;
  openvdb::io::setCurrentVersion(stream);
  openvdb::writeString(stream, map->type());
  map->write(stream);
  const auto result = std::make_shared<math::Transform>();
  result->read(stream);
  return result;
}

std::string canonicalBytes(const openvdb::math::Transform& transform) {
  std::ostringstream bytes;
  if (transform.isLinear()) {
    const openvdb::Mat4d matrix = transform.baseMap()->getAffineMap()->getConstMat4();
    for (int i = 0; i < 16; ++i) {
      const double entry = matrix.asPointer()[i] + 0.0; // -0 becomes 0
      bytes.write(reinterpret_cast<const char*>(&entry), sizeof entry);
    }
  } else {
    bytes << transform.mapType() << '\n';
    transform.baseMap()->write(bytes);
  }
  return bytes.str();
}

void openFirstTile(openvdb::GridBase& grid) {
  const bool known = withKnownGrid(grid, [](auto& typed) {
    auto& tree = typed.tree();
    if (tree.leafCount() != 0)
      return;
    std::optional<openvdb::Coord> first;
    for (auto tile = typed.cbeginValueOn(); tile; ++tile) {
      const openvdb::Coord origin = tile.getCoord();
      if (!first || origin < *first)
        first = origin;
    }
    if (first)
      tree.touchLeaf(*first);
  });
  if (!known)
    throw Error(Status::Usage, grid.getName(),
                "grids of type " + grid.type() + " are not supported");
}

} // namespace tetvdb
