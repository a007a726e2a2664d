// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <string>

namespace tetvdb {

/// An object that a file keeps apart from others, as points of the mesh that was read of the file:
/// from `firstPoint` up to the next part's. Faces use points of one part alone.
struct MeshPart {
  std::string name; ///< empty where it has none
  std::size_t firstPoint = 0;
  std::size_t assembly = 0; ///< parts of one number are placed together
  std::string assemblyName; ///< empty where it has none
};

/// A mesh that is an object of its own.
struct NamedMesh {
  TriangleMesh mesh;
  std::string name;         ///< empty where it has none
  std::size_t assembly = 0; ///< objects of one number, one after the other, are placed together
  std::string assemblyName;
};

} // namespace tetvdb
