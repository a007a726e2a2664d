// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "JobOptions.h"
#include "JsonReport.h"
#include "ParsePictures.h"
#include "ProcessLimits.h"
#include "ProgressDisplay.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/pipeline/PlannedStages.h"
#include "tetvdb/pipeline/RenderJob.h"

#include <cmath>
#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct RenderArguments : JobOptions {
  std::vector<std::string> inputs;
  std::string output, view, upAxis = "z", cut, color, colorMap, range, size, background;
  std::string style, grid, slice; // of volumes
  bool perspective = false, wire = false, smooth = false, defects = false;
  int turntable = 0;
};

const char* const kRenderExamples = R"(Examples:
  tetvdb render part.stl -o part.png
      640 x 480 pixels, from the front, right and above
  tetvdb render broken.stl -o broken.png --defects --size 1280x960
      open edges red, edges of three faces and more yellow, flipped faces blue
  tetvdb render beam.vtu -o beam.png --color temperature --cut y=0.5 --wire
      an array's values in colours, cut open in the middle: cells at the cut stand by themselves
  tetvdb render part.msh -o quality.png --cut x=0.5 --color quality
      how far tets are from regular, by their AMIPS energy: 3 is best
  tetvdb render a.stl b.stl c.obj -o all.png --view front
      side by side, at one scale, with their names
  tetvdb render part.stl -o turn.png --turntable 36 --perspective
      turn.0001.png to turn.0036.png

  tetvdb render smoke.vdb -o smoke.png --style fog
      a volume: surface, voxels, fog, or a slice of its values
  tetvdb render run.0040.vdb -o slice.png --slice y=0.5 --color temperature --range 290:600

--cut and --slice take a share of the box, x=0.5, or a coordinate with the unit u, x=12.5u;
of what is cut the part on the eye's side goes away. --range is low:high of the colours. Lengths are in the input's units.)";

VolumeStyle styleNamed(const std::string& name) {
  if (name == "voxels")
    return VolumeStyle::Voxels;
  if (name == "surface")
    return VolumeStyle::Surface;
  return name == "fog" ? VolumeStyle::Fog : VolumeStyle::Auto;
}

// Without --view: onto the slice, or from the front, right and above.
std::string viewFor(const RenderArguments& options, const VolumeShow& volume) {
  if (!options.view.empty())
    return options.view;
  if (volume.style != VolumeStyle::Slice)
    return "iso";
  if (volume.slice.axis == 0)
    return "right";
  const bool isLevel = (volume.slice.axis == 2) == (options.upAxis == "z");
  return isLevel ? "top" : "front";
}

void setVolume(const RenderArguments& options, RenderJob& job) {
  bool anyVolume = false;
  for (const RenderInput& input : job.inputs)
    anyVolume = anyVolume || input.isVolume;
  if (!anyVolume && !(options.style.empty() && options.grid.empty() && options.slice.empty()))
    throw Error(Status::Usage, "--style, --grid, --slice", "are for volumes; the input is a mesh",
                "leave them out");
  if (!options.slice.empty() && !options.style.empty())
    throw Error(Status::Usage, "--slice", "is a style of its own",
                "leave --style out, or use --cut to open the volume");
  job.volume.style = styleNamed(options.style);
  job.volume.grid = options.grid;
  if (options.slice.empty())
    return;
  const Cut plane = parseCut("--slice", options.slice);
  job.volume.style = VolumeStyle::Slice;
  job.volume.slice.axis = static_cast<int>(plane.axis);
  job.volume.slice.at = plane.at;
  job.volume.slice.inUnits = plane.inUnits;
}

RenderJob makeJob(const RenderArguments& options) {
  RenderJob job;
  for (const std::string& path : options.inputs) {
    const MappedFile readable(path); // says so at once if the file is not there
    job.inputs.push_back({path, isVolumeFile(path)});
  }
  job.output = options.output;
  job.look.color = options.color;
  job.look.wire = options.wire;
  job.look.smooth = options.smooth;
  job.look.defects = options.defects;
  PictureOptions& picture = job.picture;
  setVolume(options, job);
  picture.view = viewFor(options, job.volume);
  if (options.upAxis == "y")
    picture.worldUp = {0, 1, 0};
  picture.lens.perspective = options.perspective;
  picture.colorMap = options.colorMap;
  if (!options.cut.empty())
    picture.cut = parseCut("--cut", options.cut);
  if (!options.range.empty())
    picture.range = parseRange("--range", options.range);
  if (!options.size.empty())
    parseSize("--size", options.size, picture.width, picture.height);
  if (!options.background.empty())
    parseBackground("--background", options.background, picture.backgroundTop,
                    picture.backgroundBottom);
  job.turntable = static_cast<std::size_t>(options.turntable);
  job.maxMemory = memoryLimit(options);
  job.threads = threadCount(options);
  return job;
}

std::string summaryOf(const RenderResult& result, const RenderArguments& options) {
  const OutputInfo& first = result.outputs.front();
  std::string text = fmt::format(
      "{}{}: {} x {} pixels", oneLine(first.path),
      result.outputs.size() > 1 ? fmt::format(" and {} more", result.outputs.size() - 1) : "",
      result.width, result.height);
  if (result.scale && result.scale->kinds.empty())
    text += fmt::format(", {} from {:.6g} to {:.6g}", oneLine(result.scale->title),
                        result.scale->low, result.scale->high);
  text += "\n";
  if (options.defects)
    for (std::size_t i = 0; i < result.drawn.size(); ++i)
      text += fmt::format("{}: {} open edges, {} edges of three faces or more, {} flipped faces\n",
                          oneLine(result.inputs[i].path), result.drawn[i].openEdges,
                          result.drawn[i].nonManifoldEdges, result.drawn[i].flippedFaces);
  return text;
}

void runRender(const RenderArguments& options, Session& session) {
  Json inputs = Json::array();
  for (const std::string& path : options.inputs)
    inputs.push_back({{"path", path}});
  session.sections = {{"device", "cpu"},   {"threads", options.threads},
                      {"input", inputs},   {"picture", nullptr},
                      {"stages", nullptr}, {"output", Json::array()}};
  const RenderJob job = makeJob(options);
  session.sections["threads"] = job.threads;
  limitProcess(options, session.progress);
  const AllowThreads allowed(job.threads);
  session.estimate.plan(plannedStages(job), secondsNow());
  const RenderResult result = run(job, session.report, session.progress);
  session.sections = sectionsOf(job, result);
  session.text = summaryOf(result, options);
  session.textIsSummary = true;
}

void addPictureOptions(CLI::App& command, RenderArguments& options) {
  command
      .add_option("--view", options.view,
                  "iso (default), front, back, left, right, top, bottom, or a direction to the eye")
      ->type_name("NAME|X,Y,Z")
      ->check(notEmpty());
  command.add_option("--up-axis", options.upAxis, "Which axis of the input points up (default z)")
      ->check(CLI::IsMember({"y", "z"}).description(""))
      ->type_name("y|z");
  command.add_flag("--perspective", options.perspective,
                   "What is nearer looks larger (default: parallel rays)");
  command
      .add_option("--size", options.size,
                  "Of the whole picture in pixels (default 640x480 for each file)")
      ->type_name("WxH")
      ->check(notEmpty());
  command
      .add_option("--turntable", options.turntable, "So many pictures of a full turn, OUT.0001.png")
      ->check(CLI::Range(1, 9999).description(""))
      ->type_name("N");
  command
      .add_option("--background", options.background,
                  "sky (default), white, black, transparent, or a colour; two from top to bottom")
      ->type_name("NAME|#RRGGBB[,#RRGGBB]")
      ->check(notEmpty());
}

void addLookOptions(CLI::App& command, RenderArguments& options) {
  command.add_option("--cut", options.cut, "Cut open at a share of the box, or a coordinate in u")
      ->type_name("AXIS=SHARE|AXIS=Xu")
      ->check(notEmpty());
  command
      .add_option("--color", options.color,
                  "Of tets: quality, region, or an array; of volumes: a grid (vectors by length)")
      ->type_name("NAME")
      ->check(notEmpty());
  command
      .add_option("--colormap", options.colorMap,
                  fmt::format("{} (default viridis, for quality viridis_r); NAME_r is backward",
                              fmt::join(ColorMap::names(), ", ")))
      ->type_name("NAME")
      ->check(notEmpty());
  command.add_option("--range", options.range, "Values of the first and the last colour")
      ->type_name("LOW:HIGH")
      ->check(notEmpty());
  command.add_flag("--wire", options.wire, "Draw the edges of all faces");
  command.add_flag("--smooth", options.smooth, "Shade flat faces as one curved surface");
  command.add_flag(
      "--defects", options.defects,
      "Of triangles: open edges red, of three faces or more yellow, flipped faces blue");
}

void addVolumeOptions(CLI::App& command, RenderArguments& options) {
  command
      .add_option("--style", options.style,
                  "Of volumes: surface, voxels (default where there are few), or fog")
      ->check(CLI::IsMember({"auto", "surface", "voxels", "fog"}).description(""))
      ->type_name("auto|surface|voxels|fog");
  command
      .add_option(
          "--grid", options.grid,
          "The grid that is drawn (default: surface, density, coverage, mask, or the first)")
      ->type_name("NAME")
      ->check(notEmpty());
  command
      .add_option("--slice", options.slice, "Of volumes: values on a plane, every voxel as it is")
      ->type_name("AXIS=SHARE|AXIS=Xu")
      ->check(notEmpty());
}

} // namespace

Command addRender(CLI::App& program) {
  CLI::App* command = program.add_subcommand("render", "Draw meshes and volumes");
  auto options = std::make_shared<RenderArguments>();
  command->add_option("FILE", options->inputs, "Meshes of triangles or tets, volumes")
      ->required()
      ->type_name("...");
  command->add_option("-o,--output", options->output, "Picture to write: .png")
      ->required()
      ->type_name("FILE")
      ->check(notEmpty());
  addPictureOptions(*command, *options);
  addLookOptions(*command, *options);
  addVolumeOptions(*command, *options);
  addLimitOptions(*command, *options);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kRenderExamples);
  result.run = [options](Session& session) { runRender(*options, session); };
  result.files = [options] {
    return FileNames{options->inputs,
                     pictureNames(options->output, static_cast<std::size_t>(options->turntable))};
  };
  return result;
}

} // namespace tetvdb::cli
