// SPDX-License-Identifier: Apache-2.0
//
// What readers of meshes of cells are asked for.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

struct ReadOptions {
  /// Cell array that holds region numbers; empty: the format's own, or the first integer-valued
  /// cell array with a usual name (material, MaterialIds, region, mat_id, ... ; any case).
  std::string regionArray;
  bool attributes = true; ///< false: point and cell arrays other than regions are left out
  /// With `attributes`: names of the arrays that are wanted, those of an array's components
  /// ("u_x" of "u") being wanted with it; empty: all. Others are named in CellMesh::unread alone.
  std::vector<std::string> arrays;
  int timeStep = -1; ///< of files with several: counted from 0; -1: the last
  /// Polygons keep their corners: runs of type Flat with 3 or more nodes a cell, strips cut into
  /// triangles. For readers of formats that hold triangles too; arrays on cells are then not read.
  bool faces = false;

  /// Whether the values of the array `name` are asked for.
  bool wants(std::string_view name) const;
};

} // namespace tetvdb
