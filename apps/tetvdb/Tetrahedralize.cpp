// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "JobOptions.h"
#include "JsonReport.h"
#include "MeshReport.h"
#include "NumberText.h"
#include "ParseQuantities.h"
#include "ProcessLimits.h"
#include "ProgressDisplay.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/PlannedStages.h"
#include "tetvdb/pipeline/TetrahedralizeJob.h"

#include <cmath>
#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct TetrahedralizeArguments : JobOptions {
  std::vector<std::string> inputs;
  std::string output, edgeLength, boolean;
  double stopEnergy = 0;
  int maxPasses = TetrahedralizeOptions().maxPasses;
  bool keepOutside = false;
};

const char* const kTetrahedralizeExamples = R"(Examples:
  tetvdb tetrahedralize broken.stl -o solid.msh
      tets within a thousandth of the diagonal, as few as that takes
  tetvdb tetrahedralize part.stl -o part.vtu --epsilon 0.05 --stop-energy 10
      within 0.05 units, improved until every tet is well shaped, for simulation
  tetvdb tetrahedralize part.stl -o fine.msh --epsilon 2e-4d --edge-length 0.5
      within 2e-4 of the diagonal, edges of about half a unit
  tetvdb tetrahedralize housing.stl shaft.stl -o both.msh
      two materials, regions "housing" and "shaft"; where they overlap it is the housing's
  tetvdb tetrahedralize block.stl drill.stl -o rest.msh --boolean difference
      the block without what the drill takes

Holes, crossings, duplicates and flipped faces are fine; a sheet has no inside. Lengths are in the
input's units, or with a d in parts of the diagonal of the box around the inputs.)";

Boolean parseBoolean(const std::string& name) {
  if (name == "union")
    return Boolean::Union;
  if (name == "difference")
    return Boolean::Difference;
  return name == "intersection" ? Boolean::Intersection : Boolean::Materials;
}

TetrahedralizeJob makeJob(const TetrahedralizeArguments& options, const CLI::App& command) {
  TetrahedralizeJob job;
  job.inputs = options.inputs;
  job.output = options.output;
  job.preview = options.preview;
  setCleaning(options, job.clean);
  if (!options.epsilon.empty())
    job.epsilon = parseRelativeLength("--epsilon", options.epsilon, Voxels::None);
  if (!options.edgeLength.empty())
    job.edgeLength = parseRelativeLength("--edge-length", options.edgeLength, Voxels::None);
  // The regular tet has 3, so that smaller values cannot be reached.
  if (command.count("--stop-energy") > 0 &&
      (!std::isfinite(options.stopEnergy) || options.stopEnergy <= 3))
    throw Error(Status::Usage, "--stop-energy",
                fmt::format("'{}' cannot be reached", options.stopEnergy),
                "give a number above 3, the energy of a regular tet; 10 is a good mesh");
  job.mesher.stopEnergy = options.stopEnergy;
  job.mesher.maxPasses = options.maxPasses;
  job.mesher.boolean = parseBoolean(options.boolean);
  job.mesher.keepOutside = options.keepOutside;
  if (job.mesher.boolean != Boolean::Materials && job.inputs.size() < 2)
    throw Error(Status::Usage, "--boolean", "takes two inputs or more", "name another one");
  job.maxMemory = memoryLimit(options);
  job.threads = threadCount(options);
  return job;
}

std::string summaryOf(const TetrahedralizeResult& result, const Report& report) {
  double seconds = 0;
  for (const Stage& stage : report.stages)
    seconds += stage.seconds;
  std::size_t triangles = 0;
  for (const InputInfo& input : result.inputs)
    triangles += input.triangles;
  std::string text =
      fmt::format("{}: {}, from {} triangles, {:.2f} s\n", oneLine(result.output.path),
                  bytesText(result.output.bytes), triangles, seconds);
  for (std::size_t i = 0; i < result.repairedFaces.size(); ++i)
    if (result.repairedFaces[i] > 0)
      text += fmt::format("  {}: repaired first: {} faces were cut or removed\n",
                          oneLine(result.inputs[i].path), result.repairedFaces[i]);
  text += textOf(result.mesh);
  if (result.mesh.tetsOfRegion.size() < 2)
    return text;
  for (const auto& [number, tets] : result.mesh.tetsOfRegion)
    text += fmt::format("  region {} ({}): {} tets\n", number, oneLine(regionName(result, number)),
                        tets);
  return text;
}

void runTetrahedralize(const TetrahedralizeArguments& options, const CLI::App& command,
                       Session& session) {
  Json inputs = Json::array();
  for (const std::string& path : options.inputs)
    inputs.push_back({{"path", path}});
  session.sections = {{"device", "cpu"}, {"threads", options.threads}, {"input", inputs},
                      {"mesh", nullptr}, {"stages", nullptr},          {"output", Json::array()}};
  const TetrahedralizeJob job = makeJob(options, command);
  session.sections["threads"] = job.threads;
  limitProcess(options, session.progress);
  const AllowThreads allowed(job.threads);
  session.estimate.plan(plannedStages(job), secondsNow());
  const TetrahedralizeResult result = run(job, session.report, session.progress);
  session.sections = sectionsOf(job, result);
  session.text = summaryOf(result, session.report);
  session.textIsSummary = true;
}

} // namespace

Command addTetrahedralize(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "tetrahedralize", "Turn triangles with any defect into tetrahedra within epsilon of them");
  auto options = std::make_shared<TetrahedralizeArguments>();
  command
      ->add_option("IN", options->inputs,
                   "Meshes of triangles, one material each: " +
                       endingList(FormatUse::ReadTriangles, "and"))
      ->required()
      ->type_name("");
  command
      ->add_option("-o,--output", options->output,
                   "Mesh to write: " + endingList(FormatUse::WriteTets))
      ->required()
      ->type_name("FILE")
      ->check(notEmpty());
  addPreviewOption(*command, *options, "the input with its defects and the tets, cut open");
  addEpsilonOption(*command, *options,
                   "How far the tets' surface may be from the triangles (default 1e-3d: a "
                   "thousandth of the diagonal)");
  command
      ->add_option("--edge-length", options->edgeLength,
                   "Length that edges should have where the surface allows it (default 0.05d)")
      ->type_name("L|Ld")
      ->check(notEmpty());
  command
      ->add_option("--stop-energy", options->stopEnergy,
                   "Improve until no tet's AMIPS energy is above Q; a regular tet has 3, 10 is a "
                   "good mesh (default: stop when all faces are in and tets are few)")
      ->type_name("Q");
  command
      ->add_option("--max-passes", options->maxPasses,
                   fmt::format("Passes of improvement at most (default {})", options->maxPasses))
      ->check(CLI::Range(0, 1000000).description(""))
      ->type_name("N");
  command
      ->add_option("--boolean", options->boolean,
                   "One solid of several inputs: in any, only in the first, or in all "
                   "(default: a region for each, where they overlap the first one's)")
      ->check(CLI::IsMember({"union", "difference", "intersection"}).description(""))
      ->type_name("union|difference|intersection");
  command->add_flag("--keep-outside", options->keepOutside,
                    "Keep the tets around the solid too, up to a box, as region 0");
  addCleaningOptions(*command, *options);
  addLimitOptions(*command, *options);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kTetrahedralizeExamples);
  result.run = [options, command](Session& session) {
    runTetrahedralize(*options, *command, session);
  };
  result.files = [options] {
    return FileNames{options->inputs, {options->output, options->preview}};
  };
  return result;
}

} // namespace tetvdb::cli
