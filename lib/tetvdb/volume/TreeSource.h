// SPDX-License-Identifier: Apache-2.0
//
// Grids that are made box by box, in the order of a .vdb file: what a writer takes that never has
// whole trees in memory.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/NodeBox.h"
#include "tetvdb/volume/Grids.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

class TreeSource {
public:
  virtual ~TreeSource() = default;
  /// The first voxels of all 4096^3 cubes that may hold something, by x, then y, then z.
  virtual const std::vector<Vec3i>& cubes() const = 0;
  /// Before the first part of the first cube.
  virtual void begin() {}
  /// Boxes that together are the cube, each node of one before each of the next, by x, then y, then
  /// z.
  virtual std::vector<NodeBox> parts(std::size_t cube) = 0;
  /// The grids, always of the same number, names and types, with what they hold in `box` alone;
  /// with an empty box without anything. Cheapest in the order of cubes and parts.
  virtual openvdb::GridPtrVec make(const NodeBox& box, Progress& progress) = 0;
};

} // namespace tetvdb
