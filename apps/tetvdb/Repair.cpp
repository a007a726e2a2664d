// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "InfoTriangles.h"
#include "JobOptions.h"
#include "JsonReport.h"
#include "OptionNames.h"
#include "ParseQuantities.h"
#include "ProcessLimits.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/pipeline/MeshObjects.h"
#include "tetvdb/pipeline/RepairJob.h"

#include <cmath>
#include <cstdint>
#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct RepairArguments : JobOptions {
  std::vector<std::string> inputs;
  std::string output, grid, units;
  double scale = 1;
  double simplify = 0.1;
  bool remesh = false;
  std::string error, smooth;
  std::int64_t faces = 0;
};

const char* const kRepairExamples = R"(Examples:
  tetvdb repair broken.stl -o whole.stl
      a closed, manifold surface; faces without defects are kept
  tetvdb repair scan.ply -o scan.3mf --resolution 768 --simplify 0.2
      finer voxels, and fewer triangles
  tetvdb repair cloth.obj -o cloth.stl --shell 0.4
      an open sheet as a solid, 0.4 units thick
  tetvdb repair scan.ply -o scan.3mf --smooth 0.05 --faces 20000
      no vertex moves by more than 0.05, then at most 20,000 faces; prints the largest distance
  tetvdb repair bracket.stl -o light.stl --error 1e-3d
      as few faces as possible within a thousandth of the diagonal, with sharp edges
  tetvdb repair lid.stl box.stl -o parts.3mf --units mm
      two objects, repaired separately
  tetvdb repair part.msh -o part.stl        the surface of tetrahedra
  tetvdb repair smoke.vdb -o smoke.obj      the surface of a volume: mask, fog or level set

Holes, gaps and touching edges are repaired in place. If that fails, the whole mesh is voxelized,
with the warning 'remeshed': details below a voxel are then lost, so choose --resolution or
--voxel-size by the finest relevant detail. 'tetvdb compare' measures the distance of the result
from the input. Lengths are in the input's units.)";

constexpr std::int64_t kFewestFaces = 4;

RepairJob makeJob(const RepairArguments& options, const CLI::App& command) {
  RepairJob job;
  job.input = options.inputs.front();
  job.more.assign(options.inputs.begin() + 1, options.inputs.end());
  job.output = options.output;
  job.preview = options.preview;
  job.grid = options.grid;
  for (const std::string& input : options.inputs) {
    const MappedFile readable(input); // says so at once if the file is not there
    job.isVolume = isVolumeFile(input);
    if (job.isVolume && options.inputs.size() > 1)
      throw Error(Status::Usage, input, "is a volume; several inputs must be meshes",
                  "repair it by itself");
  }
  job.units = options.units;
  if (!options.units.empty() && !(metresOf(options.units) > 0))
    throw Error(Status::Usage, "--units", "'" + options.units + "' is not a known unit",
                "choose from um, mm, cm, m, in and ft");
  if (!std::isfinite(options.scale) || !(options.scale > 0))
    throw Error(Status::Usage, "--scale", "must be a number above zero");
  job.scale = options.scale;
  setSize(options, job.voxelSize, job.resolution);
  if (command.count("--resolution") == 0)
    job.resolution = 0;
  if (!std::isfinite(options.simplify) || options.simplify < 0)
    throw Error(Status::Usage, "--simplify", "must be a number of voxels, zero or more");
  job.simplify = options.simplify;
  job.remesh = options.remesh;
  if (command.count("--faces") > 0 && options.faces < kFewestFaces)
    throw Error(Status::Usage, "--faces", "must be 4 or more: a closed surface has no fewer");
  job.finish.faces = static_cast<std::size_t>(options.faces);
  if (!options.error.empty())
    job.finish.error = parseRelativeLength("--error", options.error, Voxels::None);
  if (!options.smooth.empty())
    job.finish.smooth = parseRelativeLength("--smooth", options.smooth, Voxels::None);
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

std::string changesText(const RepairResult& result) {
  const MeshChanges& changes = *result.changes;
  std::string text = fmt::format("  faces: {} kept, {} added, {} removed\n", changes.kept,
                                 changes.added, changes.removed);
  if (result.distance)
    text += fmt::format("  largest distance: {:.4g} from the input, {:.4g} to it\n",
                        result.distance->aToB.largest, result.distance->bToA.largest);
  if (!result.local || !result.local->succeeded)
    return text;
  const LocalRepair& local = *result.local;
  if (!local.holes.empty()) {
    constexpr std::size_t kMaxNamed = 8;
    text += fmt::format("  holes filled: {}, of", local.holes.size());
    for (std::size_t i = 0; i < local.holes.size() && i < kMaxNamed; ++i)
      text += fmt::format("{} {}", i > 0 ? "," : "", local.holes[i].edges);
    text += local.holes.size() > kMaxNamed ? ", ... edges\n" : " edges\n";
  }
  if (local.doubleFaces > 0)
    text += fmt::format("  duplicated faces removed: {}\n", local.doubleFaces);
  const std::size_t moved =
      local.stitched.joinedPoints + local.separatedPoints + local.alignedPoints;
  if (moved > 0)
    text += fmt::format("  vertices moved: {}, up to {:.4g}\n", moved, local.largestMove);
  if (local.roundsToFloats)
    text += "  coordinates rounded to 32-bit floats\n";
  if (local.crossings.cutFaces + local.crossings.removedFaces > 0)
    text += fmt::format("  faces cut along others: {}; within the solid and removed: {}\n",
                        local.crossings.cutFaces, local.crossings.removedFaces);
  if (local.stitched.splitFaces > 0)
    text +=
        fmt::format("  faces split at vertices on their edges: {}\n", local.stitched.splitFaces);
  return text;
}

std::string finishedText(const FinishResult& finished) {
  std::string text;
  if (finished.smoothed)
    text +=
        fmt::format("  smoothed: {} vertices moved, up to {:.4g}; {} on sharp edges stayed\n",
                    finished.smoothed->moved, finished.smoothed->largest, finished.smoothed->held);
  if (finished.simplified)
    text += fmt::format("  simplified from {} triangles\n", finished.facesBefore);
  return text + fmt::format("  largest distance by that, both ways: {:.4g}\n", finished.distance);
}

std::string roundedText(const FloatRounding& rounded) {
  if (rounded.crossingFaces == 0)
    return "";
  return fmt::format(
      "  rounded to 32-bit floats: {} faces crossed by it; for them {} edges flipped, {} "
      "contracted, {} vertices moved, up to {:.4g}\n",
      rounded.crossingFaces, rounded.flippedEdges, rounded.contractedEdges, rounded.movedPoints,
      rounded.largestMove);
}

std::string summaryOf(const RepairResult& result) {
  std::string text;
  if (!result.objects.empty()) {
    text = fmt::format("{}: {} objects, {} triangles, volume {:.6g}\n", oneLine(result.output.path),
                       result.objects.size(), result.triangles, result.volumeAfter);
    for (const RepairResult& object : result.objects)
      text +=
          fmt::format("  {}: {} triangles, volume {:.6g}{}\n",
                      object.name.empty() ? std::string("(no name)") : oneLine(object.name),
                      object.triangles, object.volumeAfter, object.remeshed ? ", remeshed" : "");
    return text + (result.changes ? changesText(result) : std::string());
  }
  if (result.before)
    text += fmt::format("{}: {} triangles, {}\n", oneLine(result.input.path),
                        result.before->triangles, withOptionNames(verdict(*result.before)));
  text += fmt::format("{}: {} triangles, volume {:.6g}", oneLine(result.output.path),
                      result.triangles, result.volumeAfter);
  if (result.source == SolidSource::Volume)
    text += fmt::format(", simplified from {}\n", result.extracted);
  else if (result.remeshed)
    text += fmt::format(", remeshed with voxels of {:.6g}, simplified from {}\n",
                        result.transform.voxelSize[0], result.extracted);
  else
    text += "; no remeshing was needed\n";
  if (result.changes)
    text += changesText(result);
  if (result.finished)
    text += finishedText(*result.finished);
  if (result.rounded)
    text += roundedText(*result.rounded);
  return text;
}

Json inputsOf(const RepairArguments& options) {
  Json inputs = Json::array();
  for (const std::string& path : options.inputs)
    inputs.push_back({{"path", path}});
  return inputs;
}

void runRepair(const RepairArguments& options, const CLI::App& command, Session& session) {
  session.sections = {
      {"device", "cpu"},   {"threads", options.threads}, {"input", inputsOf(options)},
      {"repair", nullptr}, {"stages", nullptr},          {"output", Json::array()}};
  const RepairJob job = makeJob(options, command);
  refuseWhatDoesNotApply(job, command);
  session.sections["threads"] = job.threads;
  limitProcess(options, session.progress);
  const AllowThreads allowed(job.threads);
  const RepairResult result = run(job, session.report, session.progress);
  session.sections = sectionsOf(job, result, withOptionNames);
  session.text = summaryOf(result);
  session.textIsSummary = true;
}

} // namespace

Command addRepair(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "repair", "Make a closed, manifold surface of any mesh or of a volume");
  auto options = std::make_shared<RepairArguments>();
  command
      ->add_option("IN", options->inputs,
                   "A mesh of triangles or tets, or a volume; several files of triangles are "
                   "objects of one .3mf file")
      ->required()
      ->type_name("");
  command
      ->add_option("-o,--output", options->output,
                   "Mesh to write: " + endingList(FormatUse::WriteTriangles))
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
  command
      ->add_option("--faces", options->faces,
                   "At most N faces; prints the largest distance from the surface before")
      ->type_name("N");
  command
      ->add_option("--error", options->error,
                   "Merge triangles while both surfaces stay within D of each other: a length, or "
                   "1e-3d, of the diagonal")
      ->type_name("D")
      ->check(notEmpty());
  command
      ->add_option("--smooth", options->smooth,
                   "Smooth the surface; no vertex moves farther than D, sharp edges are kept")
      ->type_name("D")
      ->check(notEmpty());
  command->add_option("--scale", options->scale, "Multiply coordinates by S in the end (default 1)")
      ->type_name("S");
  command
      ->add_option("--units", options->units,
                   "Of the output: um, mm, cm, m, in or ft. Input in other units is converted; "
                   "of input that names none it says what its numbers are")
      ->type_name("U")
      ->check(notEmpty());
  addLimitOptions(*command, *options);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kRepairExamples);
  result.run = [options, command](Session& session) { runRepair(*options, *command, session); };
  result.files = [options] {
    return FileNames{options->inputs, {options->output, options->preview}};
  };
  return result;
}

} // namespace tetvdb::cli
