// SPDX-License-Identifier: Apache-2.0
//
// Occupancy from NanoVDB grids of single columns of 4096^3 cubes, which a device makes, for a
// writer that never holds a whole tree in memory (volume/BitSource.h). Memory: one column's grid.
#pragma once

#include "tetvdb/volume/BitSource.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace tetvdb {

class NanoOccupancySource : public BitSource {
public:
  /// Returns the grid (nano::GridType::Mask) of the column of cubes (x, y), counted in cubes, which
  /// is valid until the next call.
  using MakeColumn = std::function<const unsigned char*(std::int32_t x, std::int32_t y)>;

  /// `cubes`: those of an OccupancySource of the same mesh.
  NanoOccupancySource(std::vector<RootCube> cubes, MakeColumn makeColumn);

  const std::vector<RootCube>& cubes() const override { return cubes_; }
  std::vector<int> begin(std::size_t cube) override;
  void fill(int stack, BitStack& out) override;

private:
  std::vector<RootCube> cubes_;
  MakeColumn makeColumn_;
  const unsigned char* column_ = nullptr; ///< the grid made last
  std::int32_t x_ = 0, y_ = 0;            ///< its column
  const void* upper_ = nullptr;           ///< the node of the cube begun last; null: none
};

} // namespace tetvdb
