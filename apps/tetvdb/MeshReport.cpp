// SPDX-License-Identifier: Apache-2.0
#include "MeshReport.h"

#include <fmt/format.h>

namespace tetvdb::cli {

nlohmann::ordered_json toJson(const MeshSummary& mesh) {
  const Tetrahedralization& made = mesh.made;
  const TwoSidedCheck& check = made.check;
  return {{"tets", mesh.tets},
          {"vertices", mesh.vertices},
          {"boundary_faces", made.boundaryFaces},
          {"volume", mesh.statistics.volume},
          {"epsilon_asked", made.epsilonAsked},
          {"epsilon_reached", check.outToIn},
          {"edge_length", made.edgeLength},
          {"quality",
           {{"worst_energy", made.worstEnergy},
            {"mean_energy", made.meanEnergy},
            {"box_over_volume", mesh.boxOverVolume()}}},
          {"passes", made.passes},
          {"simplified_faces", made.simplifiedFaces},
          {"inserted_faces", made.insertedFaces},
          {"not_inserted", made.notInserted},
          {"check",
           {{"out_to_in", check.outToIn},
            {"in_to_out", check.inToOut},
            {"owed_points", check.owedPoints},
            {"lost_points", check.lostPoints},
            {"volume", check.volume},
            {"winding_volume", check.windingVolume}}}};
}

std::string textOf(const MeshSummary& mesh) {
  const Tetrahedralization& made = mesh.made;
  return fmt::format("  {} tets, {} vertices, {} boundary faces, volume {:.6g}\n"
                     "  within {:.3g} of the input (asked: {:.3g}), worst energy {:.3g}, mean "
                     "{:.3g}\n",
                     mesh.tets, mesh.vertices, made.boundaryFaces, mesh.statistics.volume,
                     made.check.outToIn, made.epsilonAsked, made.worstEnergy, made.meanEnergy);
}

} // namespace tetvdb::cli
