// SPDX-License-Identifier: Apache-2.0
//
// The closed shells of a solid's boundary: those around it, and those around its cavities.
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The sets of a mesh's faces that are connected through points.
struct Shells {
  std::vector<std::uint32_t> ofFace; ///< by face: number of its shell, in order of first faces
  /// World units cubed, by the divergence theorem: negative for a shell that is oriented inward,
  /// around a cavity.
  std::vector<double> volumes;

  std::size_t cavities() const;
  double volume() const; ///< of the solid
};

/// Linear in the faces; sums are relative to the mesh's first point, in order of faces.
Shells findShells(const TriangleMesh& mesh);

struct FilledCavities {
  std::size_t cavities = 0; ///< or islands, whose shells were removed
  std::size_t faces = 0;    ///< removed faces, including those inside
  double volume = 0;        ///< world units cubed, by which the solid has grown
};

/// Removes components of the solid that lie in cavities and are not connected to their
/// surroundings. Otherwise as fillCavities(), with `volume` below 0.
FilledCavities dropIslands(TriangleMesh& mesh);

/// Removes the shells of cavities of less than `volume`, with their contents. `mesh` must be
/// closed, oriented and without self-intersections. Remaining faces keep their order.
FilledCavities fillCavities(TriangleMesh& mesh, double volume);

} // namespace tetvdb
