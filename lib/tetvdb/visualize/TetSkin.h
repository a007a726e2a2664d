// SPDX-License-Identifier: Apache-2.0
//
// The visible surface of tetrahedra: their boundary, or, with a cut, the boundary of what is kept
// and the cells that the cut meets.
//
//   tetvdb::TetSkin skin = tetvdb::tetSkin(mesh, cut, 0.85, progress);
//   tetvdb::TriangleLook look;
//   look.values = skin.values(onTets, progress);
//   auto drawable = std::make_shared<tetvdb::TriangleDrawable>(std::move(skin.mesh), look,
//   progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/visualize/CutPlane.h"
#include "tetvdb/visualize/TriangleDrawable.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace tetvdb {

struct TetSkin {
  TriangleMesh mesh;
  std::vector<std::uint32_t> tetOfFace;
  std::vector<std::uint32_t> pointOf; ///< of every point of `mesh` the tets' point
  std::size_t cutTets = 0;            ///< shown one by one

  /// Values over tets (On::Faces) or the tets' points (On::Points) as those of `mesh`.
  SurfaceValues values(const SurfaceValues& ofTets) const;
};

/// Without a cut, the faces that an odd number of tets have. With one, tets wholly on the side that
/// is cut off are left out; tets that the plane meets are shown whole, each shrunk towards its
/// centre by the factor `shrink`; of the others the boundary is shown. Only faces that are drawn
/// are made. Faces look outward. Parallel, deterministic; about 50 ns a tet and core, 8 bytes a
/// point and 60 a face drawn. Throws Error(Limit) from 2^32 / 4 cut tets on.
TetSkin tetSkin(const TetMesh& mesh, const std::optional<CutPlane>& cut, double shrink,
                Progress& progress);

/// The AMIPS energy of every tet (tetrahedralize/complex/TetEnergy.h): 3 for the regular one,
/// growing without bound; infinity for a flat one. Of inverted tets that of the reversed one.
std::vector<float> tetEnergies(const TetMesh& mesh);

} // namespace tetvdb
