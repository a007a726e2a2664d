// SPDX-License-Identifier: Apache-2.0
//
// Pictures by the program itself, from file to file: case render.
#include "Cases.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/TriangleWriter.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace tetvdb::bench {
namespace {

struct Shot {
  std::string what;
  std::string mesh;
  std::vector<std::string> options;
  double targetSeconds;
  double inputBytes; ///< of the mesh or the tree in memory
};

void takeShot(const Shot& shot, const Setup& setup, Tables& tables) {
  const std::string picture = setup.folder + "/out.png", json = setup.folder + "/out.json";
  std::vector<std::string> command = {
      setup.program, "render", shot.mesh, "-o", picture, "--threads", std::to_string(setup.threads),
      "--json",      json,     "-q"};
  command.insert(command.end(), shot.options.begin(), shot.options.end());
  Row row;
  std::size_t peak = 0;
  for (int round = 0; round < setup.rounds(5); ++round) {
    const ChildResult result = setup.launcher->run(command);
    if (result.status != 0)
      throw Error(Status::Invalid, setup.program, fmt::format("ended with {}", result.status));
    row.ours.seconds.push_back(result.seconds);
    peak = std::max(peak, result.peakBytes);
  }
  std::ifstream file(json);
  const nlohmann::json report = nlohmann::json::parse(file);
  for (const auto& stage : report["stages"])
    row.note += fmt::format("{} {}, ", stage["name"].get<std::string>(),
                            duration(stage["seconds"].get<double>()));
  row.peakBytes = static_cast<double>(peak);
  row.targetBytes = shot.targetSeconds > 0 ? 2 * shot.inputBytes : 0;
  row.note += fmt::format("memory is {:.1f} times that of the input, {}",
                          row.peakBytes / shot.inputBytes, size(shot.inputBytes));
  row.what = shot.what;
  row.peerName = "(alone)";
  row.targetSeconds = shot.targetSeconds;
  tables.add(row);
}

/// The sphere's mask; bytes of its tree.
double writeMask(const std::string& mesh, const std::string& path, int resolution,
                 const Setup& setup) {
  const std::string json = path + ".json";
  const ChildResult result = setup.launcher->run(
      {setup.program, "voxelize", mesh, "-o", path, "--mesher", "winding", "--grid", "mask",
       "--resolution", std::to_string(resolution), "--json", json, "-q"});
  if (result.status != 0)
    throw Error(Status::Invalid, setup.program, fmt::format("ended with {}", result.status));
  std::ifstream file(json);
  return nlohmann::json::parse(file)["grids"][0]["bytes"].get<double>();
}

} // namespace

void runRender(const Setup& setup, Tables& tables) {
  tables.begin("render",
               "`tetvdb render` as a process of its own, 640 x 480 pixels, from start to exit: the "
               "file (in the page cache) is read and the picture written. Stages are those of the "
               "last round.");
  Progress progress;
  const std::string stl = setup.folder + "/ball.stl", msh = setup.folder + "/ball.msh";
  double soupBytes = 0, tetBytes = 0;
  std::size_t faces = 0, tets = 0;
  {
    const TriangleMesh mesh = bumpySphere(1e6 / setup.shrink);
    faces = mesh.triangleCount();
    soupBytes = static_cast<double>(faces) * 3 * (sizeof(Vec3d) + sizeof(std::uint32_t));
    writeTriangles(stl, mesh, progress);
  }
  {
    const TetMesh mesh = ballMesh(1e6 / setup.shrink);
    tets = mesh.tetCount();
    tetBytes = floorBytes(mesh, 0);
    writeTetMesh(msh, mesh, progress);
  }
  const std::string triangles = countName(double(faces)) + " triangles, STL";
  const std::string cells = countName(double(tets)) + " tets, .msh";
  takeShot({triangles, stl, {}, 2, soupBytes}, setup, tables);
  takeShot({triangles + ", --smooth --wire", stl, {"--smooth", "--wire"}, 0, soupBytes}, setup,
           tables);
  takeShot({triangles + ", --defects", stl, {"--defects"}, 0, soupBytes}, setup, tables);
  takeShot({cells + ", --cut x=0.5 --color quality",
            msh,
            {"--cut", "x=0.5", "--color", "quality"},
            0,
            tetBytes},
           setup, tables);
  const int wide = setup.shrink > 1 ? 512 : 4096;
  const std::string mask = setup.folder + "/mask.vdb";
  const double treeBytes = writeMask(stl, mask, wide, setup);
  takeShot({fmt::format("mask tree, {}^3, .vdb", wide), mask, {}, 3, treeBytes}, setup, tables);
  tables.end();
}

} // namespace tetvdb::bench
