// SPDX-License-Identifier: Apache-2.0
//
// The steps from a soup to tets, within one envelope, repeated where parts of the input are lost.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"
#include "tetvdb/tetrahedralize/TwoSidedCheck.h"
#include "tetvdb/tetrahedralize/soup/Envelope.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace tetvdb {

/// Where no more than one in so many owed points is lost, it is tried again to keep them.
constexpr std::size_t kFewLost = 20;
/// Another try may have so many times the tets, and none begins when so many tets were coarsened.
constexpr std::size_t kMaxGrowth = 2;
constexpr double kMaxRepeated = 2e6;

/// World units.
struct MeshLengths {
  double diagonal, epsilon, edge;
};

/// Counts what takes long, in tets that are coarsened.
struct WorkDone {
  double tets = 0;
  double most = std::numeric_limits<double>::infinity();

  void add(std::size_t coarsened) {
    tets += static_cast<double>(coarsened);
    if (tets > most)
      throw Error(Status::Limit, "", "the triangles cut one another into very many tets",
                  "`mesher=winding` needs no tets");
  }
};

struct MeshingWork {
  const std::vector<TriangleMesh>& inputs;
  const TetrahedralizeOptions& options;
  const MeshLengths& lengths;
  const WorkingLattice& lattice;
  const LatticeSoup& soup;  ///< the inputs
  const Envelope& surface;  ///< of the soup
  const Envelope& boundary; ///< of its boundary edges
  double epsilon;           ///< world units: of lengths, or less
  double radius;            ///< of both, slightly less than epsilon; lattice units
  WorkDone& done;
  InputSurfaceTask& original;

  double toLattice(double length) const { return length / lattice.unit(); }
};

/// Tets of the inputs. Points that are lost are looked for; where they are few, the surface around
/// them is kept as it was inserted and improvement is run again, and then all is done again with
/// the surface near them as it is in the inputs. Sets all of the result but what tetrahedralize()
/// itself knows: lengths, and what InputSurface::compare() finds. Throws as tetrahedralize().
Tetrahedralization meshInputs(const MeshingWork& work, StageTimer& timer, Progress& progress);

} // namespace tetvdb
