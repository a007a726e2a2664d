// SPDX-License-Identifier: Apache-2.0
//
// The closed shells of a solid's boundary: those around it, and those around its cavities.
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// A mesh in sets of faces that are connected through points.
struct Shells {
  std::vector<std::uint32_t> ofFace; ///< number of its shell, in order of their first faces
  /// World units cubed, by the divergence theorem: below 0 for a shell that looks inward, around a
  /// cavity.
  std::vector<double> volumes;

  std::size_t cavities() const;
  double volume() const; ///< of the solid
};

/// Linear in the faces; sums go about the mesh's first point, in order of faces.
Shells findShells(const TriangleMesh& mesh);

struct FilledCavities {
  std::size_t cavities = 0; ///< or islands, whose shells went
  std::size_t faces = 0;    ///< dropped, those of what was in them included
  double volume = 0;        ///< world units cubed, by which the solid has grown
};

/// Drops components of the solid that lie within cavities and are not connected with what is around
/// them. Otherwise as fillCavities(), `volume` below 0.
FilledCavities dropIslands(TriangleMesh& mesh);

/// Drops the shells of cavities of less than `volume`, and what lies in them. `mesh` is closed,
/// oriented and without self-intersections. Faces that stay keep their order.
FilledCavities fillCavities(TriangleMesh& mesh, double volume);

} // namespace tetvdb
