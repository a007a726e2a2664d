// SPDX-License-Identifier: Apache-2.0
#include "ArrayFlags.h"
#include "Commands.h"
#include "FrameOptions.h"
#include "JobOptions.h"
#include "JobReport.h"
#include "JsonReport.h"
#include "NumberText.h"
#include "ProcessLimits.h"
#include "TileOptions.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/pipeline/ConvertJob.h"
#include "tetvdb/pipeline/ConvertSequence.h"
#include "tetvdb/pipeline/FindFrames.h"

#include <cmath>
#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ConvertArguments : JobOptions {
  std::vector<std::string> inputs;
  FrameTexts frames;
  std::string output;
  std::vector<std::string> grids;
  ArrayTexts arrays;
  ArrayInputTexts arrayInput;
  TileTexts tiles;
  double simplify = 0;
};

const char* const kConvertExamples = R"(Examples:
  tetvdb convert part.stl -o part.3mf       triangles, every one as it stands
  tetvdb convert engine.vtu -o engine.msh   tetrahedra with their arrays and regions
  tetvdb convert engine.vtu -o engine.stl   the surface of tetrahedra
  tetvdb convert smoke.vdb -o smoke.nvdb
  tetvdb convert smoke.vdb -o smoke.npz --grid density,temperature --compress
      dense arrays [x][y][z] of the box of the active voxels, and the 4x4 matrix "transform" that
      takes index space to world space; element [0,0,0] is voxel "origin"
  tetvdb convert smoke.vdb -o smoke.npz --sparse
      "NAME.coordinates" and "NAME.values" of the active voxels
  tetvdb convert scan.vdb -o scan.nrrd --grid surface --box 0,0,0,127,127,127
  tetvdb convert mask.vdb -o mask.binvox
  tetvdb convert smoke.vdb -o smoke.obj --simplify 0.1
      the surface of a volume: a mask, a fog at 0.5 or a level set at 0
  tetvdb convert scan.nrrd -o scan.vdb
  tetvdb convert predicted.npy -o predicted.vdb --voxel-size 0.5
      arrays as sparse grids; voxels of the value 0 are left out
  tetvdb convert 'slices/*.tif' -o scan.vdb --voxel-size 0.01
      pages in the order of their numbers as one volume
  tetvdb convert 'run_*.vti' -o run.vdb
  tetvdb convert 'smoke.*.vdb' -o smoke.npz --frames 1:100
  tetvdb convert run.exo -o run.vtu --frames all
      a sequence into run.0001.vdb, run.0002.vdb and so on
  tetvdb convert smoke.vdb --tiles smoke --tile-size 512
      one .vdb file for every 512^3 voxels that hold any: smoke/tile_0.vdb and so on, and
      smoke/tiles.json
  tetvdb convert smoke.vdb -o coarser.vdb --lod 1:4
      the volume, and means of every 2^3, 4^3, 8^3 and 16^3 voxels

Meshes become volumes by 'tetvdb voxelize', triangles tetrahedra by 'tetvdb tetrahedralize'. Arrays
are dense: 1000 voxels a side take 4 GB a grid of floats. docs/formats.md has the order of axes.)";

// Whether the inputs are the pages of one stack.
bool arePages(const ConvertArguments& options) {
  return options.frames.frames.empty() &&
         formatForEnding(options.inputs.front(), FormatUse::ReadArrays) ==
             &formatOf(FileFormat::Tiff) &&
         (options.inputs.size() > 1 || isPattern(options.inputs.front()));
}

// In the order of their numbers, where these are all that differs.
std::vector<std::string> pagesOf(const ConvertArguments& options, Session& session) {
  std::vector<std::string> files;
  for (const Frame& page :
       findFrames(options.inputs, {}, /*allowGaps=*/true, session.report, session.progress))
    files.push_back(page.inputs.front());
  return files.empty() ? options.inputs : files;
}

// Of one file, or of the first frame.
ConvertJob makeJob(const ConvertArguments& options, const std::vector<std::string>& files) {
  ConvertJob job;
  job.input = files.front();
  job.output = options.output;
  setTiles(options.tiles, job.output, job.tileSize, job.levels);
  if (job.output.empty())
    throw Error(Status::Usage, "", "no output was given", "name one with -o FILE");
  const MappedFile readable(job.input); // says so at once if the file is not there
  job.isVolume = isVolumeFile(job.input);
  for (const std::string& name : options.grids)
    if (!name.empty())
      job.grids.push_back(name);
  job.arrays = parseArrays(options.arrays, options.output);
  job.arrayInput = parseArrayInput(options.arrayInput, job.input);
  job.arrayInput.pages.assign(files.begin() + 1, files.end());
  if (files.size() > 1 && volumeFormatOf(job.input) != FileFormat::Tiff)
    throw Error(Status::Usage, files[1],
                "is a second file, and the names differ in more than a number",
                "convert one file at a time, the frames of a sequence, or the pages of a .tif");
  if (!std::isfinite(options.simplify) || options.simplify < 0)
    throw Error(Status::Usage, "--simplify", "must be a number of voxels, zero or more");
  job.simplify = options.simplify;
  job.maxMemory = memoryLimit(options);
  job.threads = threadCount(options);
  return job;
}

std::string textOf(const ConvertResult& result) {
  std::string text;
  for (const OutputInfo& output : result.outputs) {
    text += fmt::format("{}: {}", oneLine(output.path), bytesText(output.bytes));
    if (&output == &result.outputs.front()) {
      if (result.triangles > 0)
        text += fmt::format(", {} triangles", result.triangles);
      if (result.tets > 0)
        text += fmt::format(", {} tets", result.tets);
    }
    text += "\n";
  }
  for (const GridInfo& grid : result.grids)
    text += fmt::format("  {} ({}): {} active voxels\n", grid.name, grid.type, grid.activeVoxels);
  return text;
}

void runConvert(const ConvertArguments& options, Session& session) {
  session.sections = {{"device", "cpu"},
                      {"threads", options.threads},
                      {"input", {{{"path", options.inputs.front()}}}},
                      {"stages", nullptr},
                      {"grids", Json::array()},
                      {"output", Json::array()}};
  std::vector<Frame> frames;
  std::vector<std::string> files = options.inputs;
  if (arePages(options)) {
    files = pagesOf(options, session);
  } else {
    frames = framesOf(options.inputs, options.frames, session.report, session.progress);
    if (!frames.empty())
      files = {frames.front().inputs.front()};
  }
  const ConvertJob job = makeJob(options, files);
  session.sections["threads"] = job.threads;
  limitProcess(options, session.progress);
  const AllowThreads allowed(job.threads);
  if (!frames.empty()) {
    const std::vector<FrameResult> results =
        convertSequence(job, frames, session.report, session.progress);
    addFrames(results, session.sections);
    session.text = framesText(results);
    session.textIsSummary = true;
    return;
  }
  const ConvertResult result = run(job, session.report, session.progress);
  session.sections["input"][0] = inputSection(job.input, result.source, &result.input);
  session.sections["grids"] = toJson(result.grids);
  Json outputs = Json::array();
  for (const OutputInfo& output : result.outputs)
    outputs.push_back({{"path", output.path}, {"bytes", output.bytes}});
  if (job.tileSize > 0)
    outputs[0]["tiles"] = result.tileFiles;
  if (result.triangles > 0)
    outputs[0]["triangles"] = result.triangles;
  if (result.tets > 0)
    outputs[0]["tets"] = result.tets;
  session.sections["output"] = std::move(outputs);
  session.text = textOf(result);
  session.textIsSummary = true;
}

} // namespace

Command addConvert(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "convert", "Write a mesh or a volume in another format, as arrays, or as its surface");
  auto options = std::make_shared<ConvertArguments>();
  command
      ->add_option(
          "IN", options->inputs,
          "A mesh of triangles or tets, a volume, or dense arrays: " +
              endingList(FormatUse::ReadArrays) +
              "; several .tif files, or a pattern of them, as the pages of one stack; a sequence: "
              ".pvd, 'run_*.vti', or files whose names differ in one number")
      ->required()
      ->type_name("");
  command
      ->add_option("-o,--output", options->output,
                   "Triangles: " + endingList(FormatUse::WriteTriangles) +
                       "; tets: " + endingList(FormatUse::WriteTets) +
                       "; a volume: " + endingList(FormatUse::WriteVolume) +
                       "; arrays: " + endingList(FormatUse::WriteArrays))
      ->type_name("FILE")
      ->check(notEmpty());
  command
      ->add_option(
          "--grid", options->grids,
          "Grids of a volume, by name, several with commas (default: all; of a surface the "
          "first solid one)")
      ->type_name("NAME")
      ->delimiter(',')
      ->allow_extra_args(false);
  addFrameOptions(*command, options->frames);
  addTileOptions(*command, options->tiles);
  addArrayFlags(*command, options->arrays);
  addArrayInputOptions(*command, options->arrayInput);
  command
      ->add_option("--simplify", options->simplify,
                   "Merge triangles of a volume's surface while it moves no more than E voxels "
                   "(default 0: keep all)")
      ->type_name("E");
  addLimitOptions(*command, *options);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kConvertExamples);
  result.run = [options](Session& session) { runConvert(*options, session); };
  result.files = [options] {
    FileNames names{options->inputs, arrayFiles(options->output)};
    if (!arePages(*options))
      for (const std::string& frame : frameNames(options->inputs, options->output, options->frames))
        for (std::string& path : arrayFiles(frame))
          names.written.push_back(std::move(path));
    if (!options->tiles.folder.empty())
      names.written.push_back(options->tiles.folder + "/tiles.json");
    return names;
  };
  return result;
}

} // namespace tetvdb::cli
