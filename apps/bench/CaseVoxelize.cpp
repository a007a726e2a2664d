// SPDX-License-Identifier: Apache-2.0
//
// Stage `voxelize` against the paper's loop, an accessor and VTK: cases occupancy, owners, paths.
#include "Cases.h"
#include "Meshes.h"
#include "PaperLoop.h"
#include "tetvdb/io/MeshWriter.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>

namespace tetvdb::bench {
namespace {

VoxelizeOptions optionsFor(GridKind grid, int resolution) {
  VoxelizeOptions options;
  options.grids = {grid};
  options.resolution = resolution;
  return options;
}

const char* pathName(OccupancyPath path) {
  return path == OccupancyPath::Boundary ? "boundary path" : "tet path";
}

std::string partsOf(const OursResult& ours) {
  std::string text;
  for (const StagePart& part : ours.parts)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", part.name, duration(part.seconds));
  return text;
}

std::string resultOf(const OursResult& ours, std::size_t peerVoxels) {
  return fmt::format("{} ({}); voxels: ours {}, peer {}; tree {}", pathName(ours.path),
                     partsOf(ours), ours.activeVoxels, peerVoxels,
                     size(static_cast<double>(ours.bytes)));
}

struct OccupancySize {
  std::string mesh;
  TetMesh (*make)(double tets);
  double tets;
  int resolution;
  double target;
  int rounds; ///< of the loop at most
  bool accessor;
  bool shuffled;
};

void compareOccupancy(const OccupancySize& size, const Setup& setup, Tables& tables) {
  TetMesh mesh = size.make(size.tets / setup.shrink);
  if (size.shuffled)
    mesh = meshes::shuffled(mesh, 2);
  const int resolution = shrunk(size.resolution, setup);
  const VoxelizeOptions mask = optionsFor(GridKind::Mask, resolution);
  const VoxelizeOptions density = optionsFor(GridKind::Density, resolution);
  const GridTransform transform = chooseTransform(mesh, mask);
  PaperLoop<std::uint8_t> loop(mesh, transform);

  OursResult maskResult, densityResult;
  std::size_t accessorVoxels = 0;
  std::vector<Rival> rivals = {
      {"mask", [&] { return timeOurs(mesh, mask, &maskResult); }},
      {"paper's loop", [&] { return secondsOf([&] { loop.run(); }); }},
      {"density", [&] { return timeOurs(mesh, density, &densityResult); }}};
  if (size.accessor)
    rivals.push_back(
        {"accessor, 1 thread",
         [&] { return secondsOf([&] { accessorVoxels = accessorLoop(mesh, transform); }); }, 3});
  const std::vector<Times> times = interleave(rivals, setup.rounds(size.rounds), size.rounds > 3);

  const std::string what = fmt::format("{} tets, {}{}, {}^3", countName(double(mesh.tetCount())),
                                       size.mesh, size.shuffled ? ", shuffled" : "", resolution);
  Row row;
  row.what = "mask, " + what;
  row.peerName = "paper's loop";
  row.ours = times[0];
  row.peer = times[1];
  row.targetRatio = size.target;
  row.floorBytes = floorBytes(mesh, static_cast<double>(maskResult.bytes));
  row.note = resultOf(maskResult, loop.activeVoxels());
  tables.add(row);
  if (size.accessor) {
    row.peerName = "accessor, 1 thread";
    row.peer = times[3];
    row.targetRatio = 0;
    row.note.clear();
    tables.add(row);
  }
  row.what = "density, " + what;
  row.peerName = "paper's loop";
  row.ours = times[2];
  row.peer = times[1];
  row.targetRatio = size.target;
  row.floorBytes = floorBytes(mesh, static_cast<double>(densityResult.bytes));
  row.note = resultOf(densityResult, loop.activeVoxels());
  tables.add(row);
}

void compareOwnersWithVtk(const TetMesh& mesh, int resolution, const Setup& setup, Tables& tables) {
  const std::string path = setup.folder + "/owners.vtu";
  Progress progress;
  TetMesh numbered = mesh;
  numberCells(numbered);
  writeTetMesh(path, numbered, progress);
  VtkPeer vtk(path, "tet_id", setup.threads);
  if (!vtk.available()) {
    tables.note("VTK was left out: " + vtk.why());
    return;
  }
  const VoxelizeOptions options = optionsFor(GridKind::TetId, resolution);
  const GridTransform transform = chooseTransform(mesh, options);
  const VoxelBox box = voxelBox(mesh, transform);
  OursResult ours;
  const std::vector<Times> times =
      interleave({{"ours", [&] { return timeOurs(mesh, options, &ours); }},
                  {"vtk", [&] { return vtk.run(box, transform); }}},
                 setup.rounds(3), false);
  Row row;
  row.what =
      fmt::format("tet_id, {} tets, ball, {}^3", countName(double(mesh.tetCount())), resolution);
  row.peerName = "vtkResampleToImage";
  row.ours = times[0];
  row.peer = times[1];
  row.targetRatio = 20;
  row.floorBytes = floorBytes(mesh, static_cast<double>(ours.bytes));
  row.note = "VTK " + vtk.version() + "; " + resultOf(ours, vtk.activeVoxels());
  tables.add(row);
}

void compareOwnersWithLoop(const TetMesh& mesh, int resolution, double target, int rounds,
                           const Setup& setup, Tables& tables) {
  const VoxelizeOptions options = optionsFor(GridKind::TetId, resolution);
  PaperLoop<std::int32_t> loop(mesh, chooseTransform(mesh, options));
  OursResult ours;
  const std::vector<Times> times =
      interleave({{"ours", [&] { return timeOurs(mesh, options, &ours); }},
                  {"loop", [&] { return secondsOf([&] { loop.run(); }); }}},
                 setup.rounds(rounds), rounds > 3);
  Row row;
  row.what =
      fmt::format("tet_id, {} tets, ball, {}^3", countName(double(mesh.tetCount())), resolution);
  row.peerName = "paper's loop, int32";
  row.ours = times[0];
  row.peer = times[1];
  row.targetRatio = target;
  row.floorBytes = floorBytes(mesh, static_cast<double>(ours.bytes));
  row.note = resultOf(ours, loop.activeVoxels());
  tables.add(row);
}

} // namespace

void runOccupancy(const Setup& setup, Tables& tables) {
  tables.begin("occupancy",
               "Stage `voxelize`: world-space tets in memory to a finished tree, all parts of it. "
               "The loop: points to index space, dense uint8 grid cleared, all tets.");
  const OccupancySize sizes[] = {{"block", blockMesh, 1e7, 256, 8, 9, true, false},
                                 {"ball", ballMesh, 1e6, 256, 15, 9, true, false},
                                 {"ball", ballMesh, 1e6, 256, 0, 9, false, true},
                                 {"ball", ballMesh, 1e5, 256, 15, 9, true, false},
                                 {"ball", ballMesh, 1e5, 1024, 120, 3, false, false}};
  for (const OccupancySize& size : sizes)
    compareOccupancy(size, setup, tables);
  tables.end();
}

void runOwners(const Setup& setup, Tables& tables) {
  tables.begin("owners", "Stage `voxelize` with grid tet_id (int32). VTK: Update() of "
                         "vtkResampleToImage with one int32 cell array, mesh in memory.");
  const TetMesh mesh = ballMesh(1e6 / setup.shrink);
  compareOwnersWithLoop(mesh, shrunk(256, setup), 0, 7, setup, tables);
  compareOwnersWithVtk(mesh, shrunk(256, setup), setup, tables);
  compareOwnersWithLoop(mesh, shrunk(1024, setup), 5, 3, setup, tables);
  tables.end();
}

void runPaths(const Setup& setup, Tables& tables) {
  tables.begin("paths",
               "Mask at 256^3 from blocks of jittered cubes. Ours: the boundary path; peer: "
               "the tet path. The same bits; `auto` should take the faster one.");
  const auto compare = [&](const TetMesh& mesh, const std::string& name, int resolution) {
    VoxelizeOptions options = optionsFor(GridKind::Mask, resolution);
    OursResult chosen;
    timeOurs(mesh, options, &chosen);
    VoxelizeOptions boundary = options, tets = options;
    boundary.path = OccupancyPath::Boundary;
    tets.path = OccupancyPath::Tets;
    const std::vector<Times> times =
        interleave({{"boundary", [&] { return timeOurs(mesh, boundary); }},
                    {"tets", [&] { return timeOurs(mesh, tets); }}},
                   setup.rounds(5), true);
    Row row;
    row.what = fmt::format("{}; auto: {}", name, pathName(chosen.path));
    row.peerName = "tet path";
    row.ours = times[0];
    row.peer = times[1];
    tables.add(row);
  };
  const int full = shrunk(256, setup);
  for (const int n : {8, 16, 32, 64, 96, 128, 160}) {
    const int cubes = std::max(2, static_cast<int>(n / std::cbrt(double(setup.shrink))));
    const TetMesh mesh = meshes::jittered(meshes::kuhnGrid(cubes, cubes, cubes), 0.2, 1);
    compare(mesh,
            fmt::format("{} tets, cubes of {:.2g} voxels", countName(double(mesh.tetCount())),
                        double(full) / cubes),
            full);
  }
  const TetMesh fine = blockMesh(1e6 / setup.shrink);
  for (const int resolution : {16, 32, 64, 128})
    compare(fine,
            fmt::format("{} tets at {}^3", countName(double(fine.tetCount())),
                        shrunk(resolution, setup)),
            shrunk(resolution, setup));
  tables.end();
}

} // namespace tetvdb::bench
