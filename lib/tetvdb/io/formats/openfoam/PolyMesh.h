// SPDX-License-Identifier: Apache-2.0
//
// The mesh of an OpenFOAM case: faces between an owner and a neighbour.
#pragma once

#include "tetvdb/io/formats/openfoam/FoamFile.h"
#include "tetvdb/mesh/CellMesh.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb::openfoam {

struct PolyMesh {
  std::vector<Vec3d> points;
  Faces faces; ///< seen from the neighbour, or from outside, counter-clockwise
  std::vector<std::uint32_t> owner, neighbour; ///< cells; the first faces have neighbours

  /// One more than the largest label.
  std::size_t cellCount() const;
};

/// Throws Error(Invalid) at `where` for faces with fewer than three corners, labels of points that
/// are not there, lists of other lengths, coordinates that are not finite, and cells with fewer
/// than four faces.
void check(const PolyMesh& mesh, const std::string& where);

/// Appends a checked mesh's points and cells, in order.
void append(const PolyMesh& from, CellMesh& to);

} // namespace tetvdb::openfoam
