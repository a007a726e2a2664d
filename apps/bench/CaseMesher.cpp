// SPDX-License-Identifier: Apache-2.0
//
// The envelope mesher as a whole program, and TetGen where it is installed: cases mesher and
// models.
#include "Cases.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/TriangleWriter.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace tetvdb::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxSeconds = 120; ///< for one mesh with --stop-energy 10

/// One run of `tetvdb tetrahedralize`.
struct Meshed {
  double seconds = 0;
  std::size_t peakBytes = 0;
  int status = 0;
  nlohmann::json report;
};

Meshed tetrahedralize(const std::string& surface, int threads,
                      const std::vector<std::string>& options, const Setup& setup) {
  const std::string tets = setup.folder + "/out.msh", json = setup.folder + "/out.json";
  std::vector<std::string> command = {setup.program, "tetrahedralize",        surface,  "-o", tets,
                                      "--threads",   std::to_string(threads), "--json", json, "-q"};
  command.insert(command.end(), options.begin(), options.end());
  const ChildResult result = setup.launcher->run(command);
  std::ifstream file(json);
  Meshed meshed{result.seconds, result.peakBytes, result.status,
                nlohmann::json::parse(file, nullptr, false)};
  fs::remove(tets);
  fs::remove(json);
  if (meshed.report.is_discarded())
    throw Error(Status::Invalid, setup.program, fmt::format("ended with {}", result.status));
  return meshed;
}

std::size_t tetsOf(const Meshed& meshed) {
  return meshed.report["mesh"].value("tets", std::size_t(0));
}

/// TetGen writes beside its input; here into a folder of its own.
Rival tetgen(const std::string& surface, const Setup& setup, std::size_t& peak) {
  return {"TetGen -pq",
          [&setup, &peak, surface] {
            const fs::path folder = fs::path(setup.folder) / "tetgen";
            fs::remove_all(folder);
            fs::create_directory(folder);
            fs::copy_file(surface, folder / "sphere.off");
            const ChildResult result =
                setup.launcher->run({"tetgen", "-pqQ", (folder / "sphere.off").string()});
            fs::remove_all(folder);
            if (result.status != 0)
              throw Error(Status::Invalid, "tetgen", fmt::format("ended with {}", result.status));
            peak = std::max(peak, result.peakBytes);
            return result.seconds;
          },
          3};
}

void compare(double faces, bool peerToo, const Setup& setup, Tables& tables) {
  const std::string surface = setup.folder + "/sphere.off";
  const TriangleMesh mesh = bumpySphere(faces / setup.shrink);
  Progress progress;
  writeTriangles(surface, mesh, progress);
  std::size_t peak = 0, peerPeak = 0;
  Meshed last;
  std::vector<Rival> rivals = {{"ours", [&] {
                                  last = tetrahedralize(surface, setup.threads, {}, setup);
                                  peak = std::max(peak, last.peakBytes);
                                  return last.seconds;
                                }}};
  if (peerToo)
    rivals.push_back(tetgen(surface, setup, peerPeak));
  const std::vector<Times> times = interleave(rivals, setup.rounds(faces > 3e5 ? 1 : 3), false);
  Row row;
  row.what = countName(static_cast<double>(mesh.triangleCount())) + " triangles";
  row.curve = "TetVDB";
  row.at = static_cast<double>(mesh.triangleCount());
  row.ours = times[0];
  row.peakBytes = static_cast<double>(peak);
  row.peerName = "(alone)";
  if (peerToo) {
    row.peerName = row.peerCurve = rivals[1].name;
    row.peer = times[1];
    row.peerPeakBytes = static_cast<double>(peerPeak);
  }
  row.note =
      fmt::format("{} tets, {:.0f} us a triangle", tetsOf(last), 1e6 * row.ours.median() / row.at);
  tables.add(row);
  fs::remove(surface);
}

/// By one thread and by all, and to the energy that the published mesher stops at.
void meshModel(const std::string& path, const Setup& setup, Tables& tables) {
  std::size_t peak = 0;
  Meshed last;
  const std::vector<Times> times =
      interleave({{"ours",
                   [&] {
                     last = tetrahedralize(path, setup.threads, {}, setup);
                     peak = std::max(peak, last.peakBytes);
                     return last.seconds;
                   }},
                  {"one thread", [&] { return tetrahedralize(path, 1, {}, setup).seconds; }}},
                 setup.rounds(3), false);
  Row row;
  const std::string name = fs::path(path).stem().string();
  row.what = fmt::format("{}, {} triangles", name,
                         last.report["input"][0]["triangles"].get<std::size_t>());
  row.peerName = "one thread";
  row.ours = times[0];
  row.peer = times[1];
  row.peakBytes = static_cast<double>(peak);
  row.targetRatio = setup.threads == 2 ? 1.6 : 0;
  row.note = fmt::format("{} tets, status {}", tetsOf(last), last.status);
  tables.add(row);

  const Meshed fine =
      tetrahedralize(path, setup.threads,
                     {"--stop-energy", "10", "--max-time", std::to_string(kMaxSeconds)}, setup);
  row = {};
  row.what = name + ", --stop-energy 10";
  row.peerName = "(alone)";
  row.ours = {{fine.seconds}};
  row.peakBytes = static_cast<double>(fine.peakBytes);
  row.note = fine.status > 1 ? fmt::format("status {}: {}", fine.status,
                                           fine.report.value("error", "no reason given"))
                             : fmt::format("{} tets, status {}", tetsOf(fine), fine.status);
  tables.add(row);
}

} // namespace

void runMesher(const Setup& setup, Tables& tables) {
  tables.begin("mesher",
               "`tetvdb tetrahedralize sphere.off -o sphere.msh` as a process of its own, from "
               "start to exit, beside `tetgen -pq` on the same file. The model, a sphere with "
               "bumps, is one that TetGen can take: closed and free of crossings. Ours replaces "
               "the surface by one within epsilon (a thousandth of the diagonal), TetGen keeps "
               "every triangle: the two meshes differ in size.",
               "triangles");
  const bool peer = setup.launcher->run({"sh", "-c", "command -v tetgen"}).status == 0;
  if (!peer)
    tables.note("TetGen was left out: it is not installed");
  for (const double faces : {1e3, 4e3, 1.6e4, 6.4e4, 2.5e5, 1e6})
    compare(faces, peer && faces < 3e5, setup, tables);
  tables.end();
}

void runModels(const Setup& setup, Tables& tables) {
  tables.begin("models",
               "`tetvdb tetrahedralize MODEL -o OUT.msh` as a process of its own, from start to "
               "exit, default options, by all threads and by one, and once by all with "
               "--stop-energy 10, two minutes at most.");
  if (setup.meshes.empty())
    throw Error(Status::Usage, "models", "has no files", "name some with --mesh");
  for (const std::string& mesh : setup.meshes)
    meshModel(mesh, setup, tables);
  tables.end();
}

} // namespace tetvdb::bench
