// SPDX-License-Identifier: Apache-2.0
//
// Options for readers of meshes of cells.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

struct ReadOptions {
  /// Cell array with region numbers; empty: that of the format, or the first integer-valued cell
  /// array with a usual name (material, MaterialIds, region, mat_id, ... ; any case).
  std::string regionArray;
  bool attributes = true; ///< false: omits point and cell arrays other than regions
  /// With `attributes`: names of the requested arrays, where "u" includes its components ("u_x");
  /// empty: all. Other arrays are only named in CellMesh::unread.
  std::vector<std::string> arrays;
  int timeStep = -1; ///< of files with several: counted from 0; -1: the last
  /// Keeps polygons: runs of type Flat with 3 or more nodes per cell, with strips split into
  /// triangles. For readers of formats that also hold triangles; cell arrays are then not read.
  bool faces = false;

  /// Whether the values of the array `name` are requested.
  bool wants(std::string_view name) const;
};

} // namespace tetvdb
