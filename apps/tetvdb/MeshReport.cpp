// SPDX-License-Identifier: Apache-2.0
#include "MeshReport.h"

#include <fmt/format.h>

namespace tetvdb::cli {

std::string textOf(const MeshSummary& mesh) {
  const Tetrahedralization& made = mesh.made;
  std::string asked = fmt::format("asked: {:.3g}", made.epsilonAsked);
  if (made.epsilonUsed < made.epsilonAsked)
    asked += fmt::format("; made within {:.3g}, since parts were lost", made.epsilonUsed);
  return fmt::format("  {} tets, {} vertices, {} boundary faces, volume {:.6g}\n"
                     "  within {:.3g} of the input ({}), worst energy {:.3g}, mean {:.3g}\n",
                     mesh.tets, mesh.vertices, made.boundaryFaces, mesh.statistics.volume,
                     made.check.outToIn, asked, made.worstEnergy, made.meanEnergy);
}

} // namespace tetvdb::cli
