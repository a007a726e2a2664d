// SPDX-License-Identifier: Apache-2.0
//
// The whole program on grids far larger than memory would hold densely: cases large and huge.
#include "Cases.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/MeshWriter.h"

#include <cstdio>
#include <fmt/format.h>
#include <fstream>

namespace tetvdb::bench {
namespace {

struct Large {
  const char* grid;
  int resolution;
  double targetSeconds;
  double targetBytes;
  int rounds;
};

double stageSeconds(const nlohmann::json& report, const std::string& stage) {
  double seconds = 0;
  for (const auto& entry : report["stages"])
    if (entry["name"] == stage)
      seconds += entry["seconds"].get<double>();
  return seconds;
}

void runProgram(const Large& large, const std::string& mesh, const Setup& setup, Tables& tables) {
  const std::string volume = setup.folder + "/large.vdb", json = setup.folder + "/large.json";
  Times whole, voxelize, write;
  std::size_t peak = 0;
  nlohmann::json report;
  for (int round = 0; round < setup.rounds(large.rounds); ++round) {
    const ChildResult result =
        setup.launcher->run({setup.program, "voxelize", mesh, "-o", volume, "--resolution",
                             std::to_string(large.resolution), "--grid", large.grid, "--threads",
                             std::to_string(setup.threads), "--json", json, "-q"});
    if (result.status != 0)
      throw Error(Status::Invalid, setup.program, fmt::format("ended with {}", result.status));
    std::ifstream file(json);
    report = nlohmann::json::parse(file);
    whole.seconds.push_back(result.seconds);
    voxelize.seconds.push_back(stageSeconds(report, "voxelize"));
    write.seconds.push_back(stageSeconds(report, "write"));
    peak = std::max(peak, result.peakBytes);
    std::remove(volume.c_str());
  }
  std::remove(json.c_str());
  const auto& grid = report["grids"][0];
  Row row;
  row.what = fmt::format("{}, 10^5 tets, ball, {}^3, whole program", large.grid, large.resolution);
  row.peerName = "(alone)";
  row.ours = whole;
  row.targetSeconds = large.targetSeconds;
  // The tree is made and read again to be written, and the file is written.
  const double tree = grid["bytes"].get<double>();
  const double file = report["output"][0]["bytes"].get<double>();
  row.floorBytes = 2 * tree + file;
  row.peakBytes = static_cast<double>(peak);
  row.targetBytes = large.targetBytes;
  row.note = fmt::format("voxelize {}, write {}; {} active voxels, {} leaves, tree {}, file {}",
                         duration(voxelize.median()), duration(write.median()),
                         grid["active_voxels"].get<std::uint64_t>(),
                         grid["leaves"].get<std::uint64_t>(), size(tree), size(file));
  tables.add(row);
}

std::string writeBall(const Setup& setup) {
  std::string path = setup.folder + "/ball.msh";
  Progress progress;
  writeTetMesh(path, ballMesh(1e5), progress);
  return path;
}

} // namespace

void runLarge(const Setup& setup, Tables& tables) {
  tables.begin("large",
               "`tetvdb voxelize ball.msh -o large.vdb` as a process of its own, from start "
               "to exit, the file written and synced.");
  const std::string mesh = writeBall(setup);
  const int shrink = setup.shrink > 1 ? 4 : 1;
  runProgram({"mask", 4096 / shrink, 2, 1.5e9, 5}, mesh, setup, tables);
  runProgram({"density", 4096 / shrink, 8, 5e9, 3}, mesh, setup, tables);
  tables.end();
}

void runHuge(const Setup& setup, Tables& tables) {
  tables.begin("huge", "As `large`, at 16384^3.");
  const std::string mesh = writeBall(setup);
  runProgram({"mask", 16384 / (setup.shrink > 1 ? 4 : 1), 30, 12e9, 2}, mesh, setup, tables);
  tables.end();
}

} // namespace tetvdb::bench
