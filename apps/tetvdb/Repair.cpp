// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "InfoTriangles.h"
#include "JsonReport.h"
#include "ParseQuantities.h"
#include "VolumeSignature.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/Source.h"
#include "tetvdb/pipeline/RepairJob.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string input, output, grid;
  std::string voxelSize, inside = "winding", shell, weld;
  int resolution = 256;
  double simplify = 0.1;
  bool remesh = false;
  int threads = 0;
  std::string maxMemory, maxTime;
};

const char* const kExamples = R"(Examples:
  tetvdb repair broken.stl -o whole.stl
      a closed, manifold surface; a mesh that is in order is written as it is
  tetvdb repair scan.ply -o scan.3mf --resolution 768 --simplify 0.2
      finer voxels, and fewer triangles
  tetvdb repair cloth.obj -o cloth.stl --shell 0.4
      an open sheet as a solid, 0.4 units thick
  tetvdb repair part.msh -o part.stl        the surface of tetrahedra
  tetvdb repair smoke.vdb -o smoke.obj      the surface of a volume: mask, fog or level set

What is not in order is voxelized, so that details below a voxel are lost: choose --resolution or
--voxel-size by the finest detail that matters. 'tetvdb compare' measures how far the result is from
the input. Lengths are in the input's units.)";

RepairJob makeJob(const Options& options) {
  RepairJob job;
  job.input = options.input;
  job.output = options.output;
  job.grid = options.grid;
  const MappedFile readable(options.input); // says so at once if the file is not there
  job.isVolume = signatureOf(options.input) != VolumeSignature::None;
  if (!options.voxelSize.empty())
    job.voxelSize = parseVoxelSize("--voxel-size", options.voxelSize);
  if (options.resolution < 1)
    throw Error(Status::Usage, "--resolution",
                fmt::format("'{}' cannot be used", options.resolution),
                "give a number of voxels above zero");
  job.resolution = options.resolution;
  if (!std::isfinite(options.simplify) || options.simplify < 0)
    throw Error(Status::Usage, "--simplify", "must be a number of voxels, zero or more");
  job.simplify = options.simplify;
  job.remesh = options.remesh;
  job.solid.inside = parseInsideRule(options.inside);
  if (!options.shell.empty())
    job.solid.shell = parseLength("--shell", options.shell);
  if (!options.weld.empty())
    job.clean.weldDistance = parseLength("--weld", options.weld);
  if (!options.maxMemory.empty())
    job.maxMemory = parseBytes("--max-memory", options.maxMemory);
  job.threads = options.threads > 0 ? options.threads : tbb::this_task_arena::max_concurrency();
  return job;
}

// A volume has voxels of its own, a mesh no grids.
void refuseWhatDoesNotApply(const RepairJob& job, const CLI::App& command) {
  if (!job.isVolume) {
    if (!job.grid.empty())
      throw Error(Status::Usage, "--grid", "chooses a grid of a volume; the input is a mesh",
                  "leave it out");
    return;
  }
  for (const char* name :
       {"--resolution", "--voxel-size", "--shell", "--inside", "--weld", "--remesh"})
    if (command.count(name) > 0)
      throw Error(Status::Usage, name, "is for meshes; the input is a volume", "leave it out");
}

const char* nameOf(SolidSource source) {
  constexpr const char* kNames[] = {"triangles", "tets", "volume"};
  return kNames[static_cast<std::size_t>(source)];
}

Json cleanedOf(const CleanCounts& cleaned) {
  return {{"welded_points", cleaned.weldedPoints},
          {"unreferenced_points", cleaned.unreferencedPoints},
          {"degenerate_faces", cleaned.degenerateFaces},
          {"duplicate_faces", cleaned.duplicateFaces},
          {"flipped_faces", cleaned.flippedFaces},
          {"flipped_parts", cleaned.flippedParts},
          {"inside_out", cleaned.insideOut}};
}

Json repairOf(const RepairResult& result) {
  const bool isMesh = result.source != SolidSource::Volume;
  const bool hasGrid = isMesh && result.remeshed;
  return {{"source", nameOf(result.source)},
          {"remeshed", result.remeshed},
          {"cleaned", isMesh ? cleanedOf(result.cleaned) : Json()},
          {"verdict", isMesh ? Json(verdict(*result.before)) : Json()},
          {"defects", isMesh ? toJson(*result.before, true) : Json()},
          {"voxel_size", hasGrid ? Json(result.transform.voxelSize) : Json()},
          {"triangles_before", isMesh ? Json(result.before->triangles) : Json()},
          {"triangles_extracted", result.remeshed ? Json(result.extracted) : Json()},
          {"triangles", result.triangles},
          {"vertices", result.vertices},
          {"volume_before", isMesh ? Json(result.volumeBefore) : Json()},
          {"volume", result.volumeAfter}};
}

std::string summaryOf(const RepairResult& result) {
  std::string text;
  if (result.before)
    text += fmt::format("{}: {} triangles, {}\n", oneLine(result.input.path),
                        result.before->triangles, verdict(*result.before));
  text += fmt::format("{}: {} triangles, volume {:.6g}", oneLine(result.output.path),
                      result.triangles, result.volumeAfter);
  if (!result.remeshed)
    text += "; no remeshing was needed\n";
  else if (result.source == SolidSource::Volume)
    text += fmt::format(", simplified from {}\n", result.extracted);
  else
    text += fmt::format(", remeshed with voxels of {:.6g}, simplified from {}\n",
                        result.transform.voxelSize[0], result.extracted);
  return text;
}

void runRepair(const Options& options, const CLI::App& command, Session& session) {
  session.sections = {
      {"device", "cpu"},   {"threads", options.threads}, {"input", {{{"path", options.input}}}},
      {"repair", nullptr}, {"stages", nullptr},          {"output", Json::array()}};
  const RepairJob job = makeJob(options);
  refuseWhatDoesNotApply(job, command);
  session.sections["threads"] = job.threads;
  if (!options.maxTime.empty()) {
    // A year is as good as for ever, and fits the clock.
    const double seconds = std::min(parseSeconds("--max-time", options.maxTime), 3.2e7);
    session.progress.setDeadline(Progress::Clock::now() +
                                 std::chrono::duration_cast<Progress::Clock::duration>(
                                     std::chrono::duration<double>(seconds)));
  }
  // Embree makes oneTBB complain on stderr about more threads than cores unless they are allowed.
  const tbb::global_control allowed(
      tbb::global_control::max_allowed_parallelism,
      std::max(static_cast<std::size_t>(job.threads),
               tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)));
  const RepairResult result = run(job, session.report, session.progress);
  Json input = {{"path", options.input}, {"kind", nameOf(result.source)}};
  if (result.source != SolidSource::Volume) {
    input["format"] = formatName(result.input.format);
    input["vertices"] = result.input.vertices;
  }
  session.sections["input"] = Json::array({input});
  session.sections["repair"] = repairOf(result);
  session.sections["output"] = {{{"path", result.output.path}, {"bytes", result.output.bytes}}};
  session.text = summaryOf(result);
  session.textIsSummary = true;
}

void addMeshOptions(CLI::App& command, Options& options) {
  CLI::Option* size =
      command.add_option("--voxel-size", options.voxelSize, "A voxel's side, or one for each axis")
          ->type_name("H|HX,HY,HZ")
          ->check(notEmpty());
  command
      .add_option("--resolution", options.resolution,
                  "Voxels along the longest side of the mesh (default 256)")
      ->type_name("N")
      ->excludes(size);
  command.add_flag("--remesh", options.remesh, "Also if the mesh is in order already");
  command
      .add_option("--inside", options.inside,
                  "What is inside: winding number above 0.5 (default), of any sign (nonzero), odd "
                  "(parity), or not reached from outside (flood)")
      ->check(CLI::IsMember({"winding", "nonzero", "parity", "flood"}).description(""))
      ->type_name("RULE");
  command
      .add_option("--shell", options.shell,
                  "No solid but a shell of thickness T around the triangles, for open sheets")
      ->type_name("T")
      ->check(notEmpty());
  command.add_option("--weld", options.weld, "Join points nearer than D (default: equal ones)")
      ->type_name("D")
      ->check(notEmpty());
}

void addLimitOptions(CLI::App& command, Options& options) {
  command.add_option("--threads", options.threads, "Threads (default: one a core)")
      ->check(CLI::Range(1, 4096).description(""))
      ->type_name("N");
  command
      .add_option("--max-memory", options.maxMemory,
                  "Refuse what needs more, such as 500M or 4G (default: what is free)")
      ->type_name("BYTES")
      ->check(notEmpty());
  command.add_option("--max-time", options.maxTime, "Stop after so many seconds, without output")
      ->type_name("SECONDS")
      ->check(notEmpty());
}

} // namespace

Command addRepair(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "repair", "Make a closed, manifold surface of any mesh or of a volume");
  auto options = std::make_shared<Options>();
  command->add_option("IN", options->input, "A mesh of triangles or tets, or a volume")
      ->required()
      ->type_name("");
  command
      ->add_option("-o,--output", options->output, "Mesh to write: .stl, .obj, .ply, .off or .3mf")
      ->required()
      ->type_name("FILE")
      ->check(notEmpty());
  command->add_option("--grid", options->grid, "Grid of a volume (default: the first solid one)")
      ->type_name("NAME")
      ->check(notEmpty());
  addMeshOptions(*command, *options);
  command
      ->add_option("--simplify", options->simplify,
                   "Merge triangles while the surface moves no more than E voxels (default 0.1; 0: "
                   "keep all)")
      ->type_name("E");
  addLimitOptions(*command, *options);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kExamples);
  result.run = [options, command](Session& session) { runRepair(*options, *command, session); };
  return result;
}

} // namespace tetvdb::cli
