// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "tetvdb/volume/GridKinds.h"

#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

const char* const kGridsExamples = R"(Examples:
  tetvdb grids
      the grids that `voxelize --grid` makes of every mesh, a line a grid
  tetvdb grids --json -
      the same for programs

Every other name that --grid takes is that of an array of the mesh: `tetvdb info MESH` lists them.)";

void runGrids(Session& session) {
  Json rows = Json::array();
  const auto line = [&](auto name, auto type, auto gridClass, auto background, auto needs,
                        auto about) {
    session.text += fmt::format("{:<9} {:<6} {:<11} {:<11} {:<12} {}\n", name, type, gridClass,
                                background, needs, about);
  };
  line("grid", "type", "class", "background", "needs", "");
  for (const GridKindInfo& info : kGridKinds) {
    rows.push_back({{"name", info.name},
                    {"type", info.type},
                    {"class", info.gridClass},
                    {"background", info.background},
                    {"description", info.about},
                    {"needs_tets", info.needsTets},
                    {"needs_cubic_voxels", info.needsCubes},
                    {"on_device", info.onDevice}});
    line(info.name, info.type, info.gridClass, info.background,
         info.needsTets    ? "tets"
         : info.needsCubes ? "cubic voxels"
                           : "",
         info.about);
  }
  session.sections["grids"] = std::move(rows);
}

} // namespace

Command addGrids(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("grids", "List the grids that can be made of every mesh");
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kGridsExamples);
  result.run = [](Session& session) { runGrids(session); };
  result.files = [] { return FileNames{}; };
  return result;
}

} // namespace tetvdb::cli
