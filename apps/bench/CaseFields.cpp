// SPDX-License-Identifier: Apache-2.0
//
// Arrays of a mesh into a file, the whole program, against VTK's filter alone: case fields.
#include "Cases.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/MeshWriter.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

namespace tetvdb::bench {
namespace {

// A ball with two numbers at the points and a vector at the cells.
TetMesh simulation(double tets) {
  TetMesh mesh = ballMesh(tets);
  std::vector<double> temperature, pressure;
  for (const Vec3d& p : mesh.points) {
    temperature.push_back(std::sin(3 * p[0]) * std::cos(2 * p[1]) + p[2]);
    pressure.push_back(p[0] * p[1]);
  }
  std::vector<float> velocity;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    const Vec3d& p = mesh.points[mesh.tets[4 * t]];
    velocity.insert(velocity.end(), {static_cast<float>(-p[1]), static_cast<float>(p[0]), 0.5f});
  }
  mesh.attributes.push_back({"T", Attribute::On::Points, 1, std::move(temperature)});
  mesh.attributes.push_back({"p", Attribute::On::Points, 1, std::move(pressure)});
  mesh.attributes.push_back({"vel", Attribute::On::Cells, 3, std::move(velocity)});
  return mesh;
}

} // namespace

void runFields(const Setup& setup, Tables& tables) {
  tables.begin("fields",
               "Ours: `tetvdb voxelize ball.vtu -o ball.vdb --grid T,p,vel` as a process of its "
               "own, from start to exit, the file written and synced. VTK: Update() of "
               "vtkResampleToImage alone, the same three arrays, mesh in memory; its file would "
               "still have to be read and written.");
  const std::string path = setup.folder + "/ball.vtu", volume = setup.folder + "/ball.vdb",
                    json = setup.folder + "/ball.json";
  const int resolution = shrunk(256, setup);
  double low[3], high[3];
  {
    const TetMesh mesh = simulation(1e6 / setup.shrink);
    Progress progress;
    writeTetMesh(path, mesh, progress);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [min, max] =
          std::minmax_element(mesh.points.begin(), mesh.points.end(),
                              [k](const Vec3d& a, const Vec3d& b) { return a[k] < b[k]; });
      low[k] = (*min)[k];
      high[k] = (*max)[k];
    }
  }
  VtkPeer vtk(path, "vel", setup.threads);
  if (!vtk.available())
    tables.note("VTK was left out: " + vtk.why());
  const int count[3] = {resolution, resolution, resolution};
  std::size_t peak = 0;
  nlohmann::json report;
  const auto ours = [&] {
    const ChildResult result = setup.launcher->run(
        {setup.program, "voxelize", path, "-o", volume, "--resolution", std::to_string(resolution),
         "--grid", "T,p,vel", "--threads", std::to_string(setup.threads), "--json", json, "-q"});
    if (result.status != 0)
      throw Error(Status::Invalid, setup.program, fmt::format("ended with {}", result.status));
    peak = std::max(peak, result.peakBytes);
    return result.seconds;
  };
  std::vector<Rival> rivals = {{"ours", ours}};
  if (vtk.available())
    rivals.push_back({"vtk", [&] { return vtk.run(count, low, high); }});
  const std::vector<Times> times = interleave(rivals, setup.rounds(3), false);
  std::ifstream file(json);
  report = nlohmann::json::parse(file);
  Row row;
  row.what = fmt::format("T, p, vel, {} tets, ball, {}^3, whole program",
                         countName(1e6 / setup.shrink), resolution);
  row.ours = times[0];
  row.targetRatio = 12;
  std::string parts;
  for (const auto& stage : report["stages"])
    parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", stage["name"].get<std::string>(),
                         duration(stage["seconds"].get<double>()));
  row.note = "last run: " + parts;
  row.peerName = "(alone)";
  row.peakBytes = static_cast<double>(peak);
  if (vtk.available()) {
    row.peerName = "vtkResampleToImage";
    row.peer = times[1];
    row.peerPeakBytes = static_cast<double>(vtk.peakBytes());
    row.targetLessBytes = 4;
    row.note +=
        fmt::format("; VTK {}; {} voxels, VTK {}", vtk.version(),
                    report["grids"][0]["active_voxels"].get<std::uint64_t>(), vtk.activeVoxels());
  }
  tables.add(row);
  tables.end();
  for (const std::string& name : {path, volume, json})
    std::remove(name.c_str());
}

} // namespace tetvdb::bench
