// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "InfoTriangles.h"
#include "JobOptions.h"
#include "JsonReport.h"
#include "VolumeSignature.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/Source.h"
#include "tetvdb/pipeline/RepairJob.h"

#include <cmath>
#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Options : JobOptions {
  std::string input, output, grid;
  double simplify = 0.1;
  bool remesh = false;
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
  job.preview = options.preview;
  job.grid = options.grid;
  const MappedFile readable(options.input); // says so at once if the file is not there
  job.isVolume = signatureOf(options.input) != VolumeSignature::None;
  setSize(options, job.voxelSize, job.resolution);
  if (!std::isfinite(options.simplify) || options.simplify < 0)
    throw Error(Status::Usage, "--simplify", "must be a number of voxels, zero or more");
  job.simplify = options.simplify;
  job.remesh = options.remesh;
  setInside(options, job.solid);
  setCleaning(options, job.clean);
  job.maxMemory = memoryLimit(options);
  job.threads = threadCount(options);
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

Json repairOf(const RepairResult& result) {
  const bool isMesh = result.source != SolidSource::Volume;
  const bool hasGrid = isMesh && result.remeshed;
  return {{"source", nameOf(result.source)},
          {"remeshed", result.remeshed},
          {"cleaned", isMesh ? toJson(result.cleaned) : Json()},
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
  setDeadline(options, session.progress);
  const AllowThreads allowed(job.threads);
  const RepairResult result = run(job, session.report, session.progress);
  Json input = {{"path", options.input}, {"kind", nameOf(result.source)}};
  if (result.source != SolidSource::Volume) {
    input["format"] = formatName(result.input.format);
    input["vertices"] = result.input.vertices;
  }
  session.sections["input"] = Json::array({input});
  session.sections["repair"] = repairOf(result);
  session.sections["output"] = {{{"path", result.output.path}, {"bytes", result.output.bytes}}};
  reportPreview(result.preview, job.preview, session.sections);
  session.text = summaryOf(result);
  session.textIsSummary = true;
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
  addPreviewOption(*command, *options, "before, with defects, and after");
  command->add_option("--grid", options->grid, "Grid of a volume (default: the first solid one)")
      ->type_name("NAME")
      ->check(notEmpty());
  addSizeOptions(*command, *options);
  command->add_flag("--remesh", options->remesh, "Also if the mesh is in order already");
  addInsideOptions(*command, *options);
  addWeldOption(*command, *options);
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
