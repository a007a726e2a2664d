// SPDX-License-Identifier: Apache-2.0
#include "Children.h"
#include "Commands.h"
#include "Measure.h"
#include "MeshToVolumePeer.h"
#include "PaperLoop.h"
#include "SampleMeshes.h"
#include "Table.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

namespace tetvdb::cli {
namespace {

using namespace tetvdb::bench;
using Json = nlohmann::ordered_json;

struct Options {
  std::string file;
  int resolution = 256;
  int rounds = 5;
  int threads = 0;
};

const char* const kExamples = R"(Examples:
  tetvdb bench
      about a minute: tets into voxels against the paper's loop and VTK, triangles into a level set
      against OpenVDB's meshToVolume, with meshes that it makes itself
  tetvdb bench run.vtu --resolution 512
      the same with a mesh of yours

Times are medians; rivals run in turns. VTK takes part where python3-vtk9 is installed.)";

/// One line of the table.
struct Line {
  std::string task, peer;
  Times ours, theirs;
};

/// What all tasks share.
class Bench {
public:
  Bench(const Options& options, Session& session) : options_(options), session_(session) {}

  void run() {
    threads_ = options_.threads > 0 ? options_.threads : tbb::info::default_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads_));
    setLoopThreads(threads_);
    if (options_.file.empty()) {
      tets(ballMesh(1e6), "a ball");
      owners(ballMesh(1e5), "a ball", options_.resolution / 2);
      triangles(bumpySphere(1e5), "a bumpy sphere");
    } else if (holdsTriangles(options_.file)) {
      InputInfo info;
      TriangleMesh mesh = readSoup(options_.file, &info, session_.report, session_.progress);
      cleanTriangles(mesh, {}, session_.progress);
      triangles(mesh, std::filesystem::path(options_.file).filename().string());
    } else {
      InputInfo info;
      const TetMesh mesh =
          readTets(options_.file, {}, {}, &info, session_.report, session_.progress);
      const std::string name = std::filesystem::path(options_.file).filename().string();
      tets(mesh, name);
      owners(mesh, name, options_.resolution);
    }
    print();
  }

private:
  std::vector<Times> compare(std::vector<Rival> rivals, bool warmUp, double step) {
    for (Rival& rival : rivals) {
      const auto work = rival.run;
      rival.run = [this, work] {
        session_.progress.check();
        return work();
      };
    }
    session_.progress.update(done_);
    done_ = std::min(1.0, done_ + step);
    return interleave(rivals, options_.rounds, warmUp);
  }

  void tets(const TetMesh& mesh, const std::string& name) {
    session_.progress.stage("tets");
    VoxelizeOptions mask;
    mask.resolution = options_.resolution;
    mask.grids = {GridKind::Mask};
    const GridTransform transform = chooseTransform(mesh, mask);
    const std::string size =
        fmt::format("{} tets ({}), {}^3", mesh.tetCount(), name, options_.resolution);
    {
      PaperLoop<std::uint8_t> loop(mesh, transform);
      const auto times = compare({{"ours", [&] { return ours(mesh, mask, GridKind::Mask); }},
                                  {"loop", [&] { return secondsOf([&] { loop.run(); }); }}},
                                 true, 0.25);
      lines_.push_back({"mask of " + size,
                        haveOpenMP() ? "the paper's loop" : "the paper's loop, 1 thread", times[0],
                        times[1]});
    }
  }

  double ours(const TetMesh& mesh, VoxelizeOptions options, GridKind kind) {
    options.grids = {kind};
    Report report;
    Progress progress;
    return secondsOf([&] { voxelize(mesh, options, report, progress); });
  }

  /// VTK takes tens of seconds for what the loop does in one: a smaller mesh, fewer rounds.
  void owners(const TetMesh& mesh, const std::string& name, int resolution) {
    session_.progress.stage("VTK");
    std::string folder = (std::filesystem::temp_directory_path() / "tetvdb-bench-XXXXXX").string();
    if (::mkdtemp(folder.data()) == nullptr) {
      session_.report.warn("no-vtk", "VTK was left out: no temporary folder can be made");
      return;
    }
    const std::string path = folder + "/owners.vtu";
    TetMesh numbered;
    numbered.points = mesh.points;
    numbered.tets = mesh.tets;
    numberCells(numbered);
    writeTetMesh(path, numbered, session_.progress);
    VtkPeer vtk(path, "tet_id", threads_);
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
    if (!vtk.available()) {
      session_.report.warn("no-vtk", "VTK was left out: " + vtk.why());
      return;
    }
    VoxelizeOptions options;
    options.resolution = resolution;
    options.grids = {GridKind::TetId};
    const GridTransform transform = chooseTransform(mesh, options);
    const bench::VoxelBox box = voxelBox(mesh, transform);
    const auto times = compare({{"ours", [&] { return ours(mesh, options, GridKind::TetId); }},
                                {"vtk", [&] { return vtk.run(box, transform); }, 1}},
                               false, 0.25);
    lines_.push_back(
        {fmt::format("tet numbers of {} tets ({}), {}^3", mesh.tetCount(), name, resolution),
         "vtkResampleToImage " + vtk.version(), times[0], times[1]});
  }

  void triangles(const TriangleMesh& mesh, const std::string& name) {
    session_.progress.stage("triangles");
    VoxelizeOptions options;
    options.resolution = 2 * options_.resolution;
    options.grids = {GridKind::Mask};
    const GridTransform transform = chooseTransform(mesh, options);
    const std::string size =
        fmt::format("{} triangles ({}), {}^3", mesh.triangleCount(), name, options.resolution);
    ShapeOptions shapes;
    shapes.grids = {ShapeGrid::Surface};
    const auto times = compare(
        {{"mask",
          [&] {
            Report report;
            Progress progress;
            return secondsOf([&] { voxelize(mesh, SolidOptions(), options, report, progress); });
          }},
         {"surface",
          [&] {
            Report report;
            Progress progress;
            return secondsOf([&] {
              Voxelization made = voxelize(mesh, SolidOptions(), options, report, progress);
              addShapeGrids(mesh, SolidOptions(), shapes, made, report, progress);
            });
          }},
         {"peer", [&] { return secondsOf([&] { meshToVolume(mesh, transform); }); }, 3}},
        true, 0.5);
    lines_.push_back({"level set of " + size, "meshToVolume", times[1], times[2]});
    lines_.push_back({"mask of " + size, "meshToVolume", times[0], times[2]});
  }

  void print() {
    std::vector<std::vector<std::string>> table = {
        {"task", "peer", "TetVDB", "peer's time", "times faster"}};
    Json rows = Json::array();
    for (const Line& line : lines_) {
      const double ratio = ratioOfMedians(line.ours, line.theirs);
      table.push_back({line.task, line.peer, duration(line.ours.median()),
                       duration(line.theirs.median()), fmt::format("{:.1f}", ratio)});
      rows.push_back({{"task", line.task},
                      {"peer", line.peer},
                      {"seconds", line.ours.seconds},
                      {"peer_seconds", line.theirs.seconds},
                      {"ratio", ratio}});
    }
    session_.sections = {{"threads", threads_}, {"rounds", options_.rounds}, {"rows", rows}};
    session_.text = markdown(table) + fmt::format("{} threads, medians of {} rounds in turns\n",
                                                  threads_, options_.rounds);
  }

  const Options& options_;
  Session& session_;
  int threads_ = 0;
  double done_ = 0;
  std::vector<Line> lines_;
};

} // namespace

Command addBench(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "bench", "How this machine does against the paper's loop, VTK and meshToVolume");
  auto options = std::make_shared<Options>();
  command->add_option("FILE", options->file, "A mesh of your own; else a ball and a bumpy sphere")
      ->check(notEmpty())
      ->type_name("");
  command
      ->add_option("--resolution", options->resolution,
                   "Voxels along the longest side of tets, twice as many of triangles")
      ->check(CLI::Range(8, 2048).description(""))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--rounds", options->rounds, "Runs of each rival, of slow ones fewer")
      ->check(CLI::Range(1, 100).description(""))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads of every rival; default all")
      ->check(CLI::Range(1, 4096).description(""))
      ->type_name("N");
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kExamples);
  result.run = [options](Session& session) { Bench(*options, session).run(); };
  result.files = [options] { return FileNames{{options->file}, {}}; };
  return result;
}

} // namespace tetvdb::cli
