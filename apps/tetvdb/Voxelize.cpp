// SPDX-License-Identifier: Apache-2.0
#include "ArrayFlags.h"
#include "Commands.h"
#include "FieldOptions.h"
#include "JobOptions.h"
#include "JsonReport.h"
#include "MeshReport.h"
#include "NumberText.h"
#include "OptionNames.h"
#include "ParseQuantities.h"
#include "ProcessLimits.h"
#include "ProgressDisplay.h"
#include "TileOptions.h"
#include "VoxelizeSequence.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/pipeline/PlannedStages.h"
#include "tetvdb/pipeline/PrepareMesh.h"
#include "tetvdb/pipeline/VoxelizeJob.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <set>
#include <string_view>
#include <utility>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct VoxelizeArguments : JobOptions {
  std::vector<std::string> inputs;
  std::string output, writeMesh;
  std::string origin, bbox;
  std::vector<std::string> grids; // none: a mask where the output holds nothing else, or density
  FieldTexts fields;
  SequenceTexts sequence;
  ArrayTexts arrays;
  TileTexts tiles;
  std::string device = "auto", upAxis = "z";
  std::string regionArray, units;
  std::vector<std::string> regions, exclude;
  bool allowEmpty = false, half = false;
  std::string mesher = "auto";
  std::string halfWidth = "3";
  int fit = 0, padding = 0;
  std::string shellSide = "both";
  std::string rule = "centre";
  std::string maskType = "bool", shard;
  unsigned shards = 0; // of `plan`
  std::string prepare; // of `plan`
  bool givesResolution = false;
};

const char* const kVoxelizeExamples = R"(Examples:
  tetvdb voxelize part.msh -o part.vdb
      256 voxels along the longest side, one fog grid "density"
  tetvdb voxelize engine.vtu -o engine.vdb --voxel-size 0.5 --grid density,material
      voxels of half a unit, with the region number of every voxel
  tetvdb voxelize beam.vtu -o beam.vdb --grid density,temperature,vel --derive mises=stress:mises
      arrays of the mesh as grids of their own, and one made of a tensor
  tetvdb voxelize run.pvd -o run.vdb --grid density,temperature --warp disp
      a sequence into run.0001.vdb, run.0002.vdb, ...; as well 'frame_*.vtu', or the steps of
      an Exodus, XDMF or other file of several steps, or an OpenFOAM case (.foam, or its
      system/controlDict), with --frames all
  tetvdb voxelize head.mesh -o skull.nvdb --region bone,4 --resolution 1024
      only the regions named "bone" and numbered 4
  tetvdb voxelize a.msh b.msh -o both.vdb --bbox 0,0,0,10,10,inf
      two meshes as one volume, only cells that meet the box
  tetvdb voxelize broken.stl -o solid.vdb --preview solid.png
      a picture besides: the input with its defects, the volume, a slice
  tetvdb voxelize part.vtu --write-mesh part.msh
      converts the mesh, without a volume
  tetvdb voxelize broken.stl -o solid.vdb --resolution 1024 --grid mask
      triangles with any defect; holes are closed where the winding number passes 0.5
  tetvdb voxelize hull.stl core.stl -o both.vdb --grid material,density
      a material a file: where they overlap, the first one's
  tetvdb voxelize chair.off -o chair.vdb --fit 64 --padding 2 --grid mask
      a cube of 64^3 voxels numbered from 0, the model at its centre
  tetvdb voxelize broken.stl -o solid.vdb --grid density,tet_id --write-mesh solid.msh
      by way of tets within half a voxel of the triangles, which are written as well
  tetvdb voxelize broken.stl -o solid.vdb --grid surface --half-width 5
      a level set: exact distances up to five voxels from the surface
  tetvdb voxelize part.stl -o part.npz --grid density,surface
      dense arrays for NumPy, with their transform; as well .npy, .vti, .nrrd, .h5, .tif, .raw and
      .binvox
  tetvdb voxelize part.stl -o part.npz --grid surface --half-width all
      signed distances in the mesh's whole box
  tetvdb voxelize cloth.obj -o cloth.vdb --shell 0.4
      an open sheet as a shell, 0.4 units thick, 0.2 on either side
  tetvdb voxelize part.stl -o hollow.vdb --shell 2 --shell-side inward
      a hollow part with walls of 2 units
  tetvdb voxelize ship.stl -o ship.vdb --resolution 8192 --grid surface --max-memory 1G
      streamed into the file where its trees would be larger than that
  tetvdb voxelize ship.stl -o ship.vdb --voxel-size 0.5 --grid mask --shard 3/16
      the fourth of 16 parts, into ship.3-of-16.vdb; see 'tetvdb help plan' and 'tetvdb help merge'
  tetvdb voxelize ship.stl --tiles ship --tile-size 1024 --voxel-size 0.5
      one .vdb file for every 1024^3 voxels: ship/tile_0.vdb and so on, and ship/tiles.json
  tetvdb voxelize ship.stl -o ship.vdb --resolution 4096 --lod 3:6
      the volume, and how much of every 8^3, 16^3, 32^3 and 64^3 voxels is inside

Lengths are in the inputs' own units. Several inputs are laid together into one volume: cells that
overlap count once, and cells of the second file are numbered on from those of the first. Files
whose names differ in one number alone are the frames of a sequence, unless --union is given.)";

const char* const kPlanExamples = R"(Examples:
  tetvdb plan ship.stl --shards 16 --voxel-size 0.5
      which children of the root node, 4096^3 voxels each, every one of 16 shards would make,
      and its share of the work
  for i in $(seq 0 15); do tetvdb voxelize ship.stl -o ship.vdb --voxel-size 0.5 --shard $i/16; done
  tetvdb merge ship.*-of-16.vdb -o ship.vdb
      makes the shards one by one, or on as many machines, and joins them

  tetvdb plan engine.vtu --prepare engine.parts --voxel-size 0.5 --grid tet_id,T --max-memory 2G
  tetvdb voxelize engine.parts -o engine.vdb --grid tet_id,T --max-memory 2G
      a mesh of cells that is larger than memory: reads it part by part into a folder, which then is
      voxelized in place of the mesh, whole or by shards

Give the same options as to 'tetvdb voxelize'. A folder that was prepared has its voxels' size and
place, and the arrays that were named by --grid and --derive.)";

// Names that are no grid of ours are arrays of the mesh.
void parseGrids(const std::vector<std::string>& names, VoxelizeJob& job) {
  job.grids.clear();
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (name.empty())
      continue;
    if (!seen.insert(name).second)
      throw Error(Status::Usage, "--grid", "'" + name + "' is asked for twice",
                  "name every grid once");
    if (const std::optional<GridKind> kind = gridKindOf(name))
      job.grids.push_back(*kind);
    else if (name == "all")
      job.fields.all = true;
    else
      job.fields.requests.push_back({"", name, FieldPart::Whole, ""});
  }
}

ShellSide parseShellSide(const std::string& name) {
  if (name == "outward")
    return ShellSide::Outward;
  return name == "inward" ? ShellSide::Inward : ShellSide::Both;
}

VoxelRule parseRule(const std::string& name) {
  if (name == "any")
    return VoxelRule::Any;
  return name == "all" ? VoxelRule::All : VoxelRule::Centre;
}

void parseBox(const std::string& text, CellFilter& filter) {
  const std::vector<double> numbers = parseNumbers("--bbox", text);
  if (numbers.size() != 6)
    throw Error(Status::Usage, "--bbox", "'" + text + "' does not have six numbers",
                "give x0,y0,z0,x1,y1,z1; inf and -inf leave a side open");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    filter.boxMin[axis] = std::min(numbers[axis], numbers[axis + 3]);
    filter.boxMax[axis] = std::max(numbers[axis], numbers[axis + 3]);
  }
}

// A shard's own file: "out.3-of-16.vdb".
std::string shardPath(const std::string& output, const Shard& shard) {
  if (shard.isWhole() || output.empty())
    return output;
  const std::filesystem::path path(output);
  return (path.parent_path() / (path.stem().string() + "." + shard.name())).string() +
         path.extension().string();
}

VoxelizeJob makeJob(const VoxelizeArguments& options) {
  VoxelizeJob job;
  job.inputs = options.inputs;
  job.output = options.output;
  job.arrays = parseArrays(options.arrays, options.output);
  job.meshOutput = options.writeMesh;
  job.preview = options.preview;
  job.read.regionArray = options.regionArray;
  job.filter.regions = options.regions;
  job.filter.exclude = options.exclude;
  if (!options.bbox.empty())
    parseBox(options.bbox, job.filter);
  job.mesher = parseMesher(options.mesher);
  if (!options.epsilon.empty())
    job.epsilon = parseRelativeLength("--epsilon", options.epsilon, Voxels::Known);
  setInside(options, job.solid);
  job.solid.side = parseShellSide(options.shellSide);
  setCleaning(options, job.clean);
  job.up = options.upAxis == "y" ? UpAxis::Y : UpAxis::Z;
  setSize(options, job.voxelize.voxelSize, job.voxelize.resolution);
  if (!options.origin.empty())
    job.voxelize.origin = parsePoint("--origin", options.origin);
  job.voxelize.fit = {options.fit, options.padding};
  const std::vector<std::string> usual{isMaskFile(options.output) ? "mask" : "density"};
  parseGrids(options.grids.empty() ? usual : options.grids, job);
  const SettingName optionName = [](const char* setting) { return "--" + std::string(setting); };
  setFields(options.fields, optionName, job.fields);
  if (!options.fields.warp.empty())
    job.warp = parseWarp("--warp", options.fields.warp);
  job.smooth = options.fields.smooth;
  job.read.attributes =
      !options.writeMesh.empty() || !job.fields.empty() || !job.warp.array.empty();
  job.shapes.halfWidth =
      options.halfWidth == "all" ? kWholeBox : parseLength("--half-width", options.halfWidth);
  job.voxelize.rule = parseRule(options.rule);
  job.voxelize.allowEmpty = options.allowEmpty;
  job.maxMemory = memoryLimit(options);
  job.units = options.units;
  job.half = options.half;
  job.maskType = options.maskType == "mask" ? MaskType::Mask : MaskType::Bool;
  if (!options.shard.empty())
    job.shard = parseShard(options.shard);
  job.output = shardPath(job.output, job.shard);
  setTiles(options.tiles, job.output, job.tileSize, job.levels);
  job.plan = options.shards;
  job.device = parseDevice("--device", options.device);
  job.threads = threadCount(options);
  return job;
}

std::string summaryOf(const VoxelizeJob& job, const VoxelizeResult& result, const Report& report) {
  double seconds = 0;
  for (const Stage& stage : report.stages)
    seconds += stage.seconds;
  std::string text;
  for (const OutputInfo& output : result.outputs)
    text += fmt::format("{}: {}, {} {}, {:.2f} s\n", oneLine(output.path), bytesText(output.bytes),
                        result.holdsTriangles ? result.triangles : result.tets,
                        result.holdsTriangles ? "triangles" : "tets", seconds);
  if (job.tileSize > 0)
    text += fmt::format("  {} tiles of {}^3 voxels\n", result.tileFiles, job.tileSize);
  if (result.made)
    text += textOf(*result.made);
  if (const CleanCounts& cleaned = result.cleaned; cleaned.closedHoles > 0)
    text += fmt::format("  {} holes of components that bound a volume: closed by {} faces\n",
                        cleaned.closedHoles, cleaned.closingFaces);
  if (result.holdsTriangles && result.openEdges > 0 && job.solid.shell == 0)
    text += fmt::format("  {} open edges: closed by {}\n", result.openEdges,
                        result.made ? "winding number" : methodText(job, result));
  for (const GridInfo& grid : result.grids)
    text +=
        fmt::format("  {} ({}): {} active voxels of {}, {} leaves, {} tiles, volume {:.6g}\n",
                    grid.name, grid.type, grid.activeVoxels, lengthText(grid.transform.voxelSize),
                    grid.leaves, grid.activeTiles, grid.volume);
  return text;
}

// The report's sections before anything is known, in the order in which they are printed.
void prepareSections(const VoxelizeArguments& options, Session& session) {
  Json inputs = Json::array();
  for (const std::string& path : options.inputs)
    inputs.push_back({{"path", path}});
  session.sections = {{"device", "cpu"}, {"threads", options.threads}, {"input", inputs},
                      {"mesh", nullptr}, {"stages", nullptr},          {"transform", nullptr},
                      {"fit", nullptr},  {"grids", Json::array()},     {"output", Json::array()}};
}

// What a prepared mesh fixes and the library cannot tell from a default.
void checkPrepared(const VoxelizeArguments& options) {
  const bool prepared = std::any_of(options.inputs.begin(), options.inputs.end(), isPreparedMesh);
  if (prepared && options.givesResolution)
    throw Error(Status::Usage, "--resolution", "was decided when the mesh was prepared",
                "leave it out, or prepare the mesh again");
}

void noteDevices(const VoxelizeJob& job, const VoxelizeResult& result, Session& session) {
  const DeviceUsed& grids = result.device;
  if (!grids.why.empty() && grids.name != "cpu")
    session.notes.push_back(fmt::format("device: {}, since {}", grids.name, grids.why));
  const auto note = [&](const char* what, const DeviceUsed& used) {
    if (used.name != grids.name)
      session.notes.push_back(fmt::format("device of the {}: {}", what, used.name));
  };
  if (!job.fields.empty())
    note("arrays", result.fieldsDevice);
  if (!madeBy(job.grids, {GridMaker::Distance}).empty())
    note("level set", result.shapes.device);
  if (!madeBy(job.grids, {GridMaker::Share}).empty())
    note("coverage", result.shapes.coverageDevice);
}

void runVoxelize(const VoxelizeArguments& options, Session& session) {
  prepareSections(options, session);
  checkPrepared(options);
  VoxelizeJob job = makeJob(options);
  session.sections["threads"] = job.threads;
  if (options.fit > 0)
    session.sections["fit"] = {{"voxels", options.fit}, {"padding", options.padding}};
  limitProcess(options, session.progress);
  const AllowThreads allowed(job.threads);
  if (runAsSequence(job, options.sequence, session))
    return;
  session.estimate.plan(plannedStages(job), secondsNow());
  const VoxelizeResult result = run(job, session.report, session.progress);
  session.sections = sectionsOf(job, result, withOptionNames);
  if (job.tileSize > 0)
    session.sections["output"][0]["tiles"] = result.tileFiles;
  if (!job.shard.isWhole())
    session.sections["shard"] = {{"index", job.shard.index}, {"count", job.shard.count}};
  session.text = summaryOf(job, result, session.report);
  noteDevices(job, result, session);
  if (result.mesher)
    session.notes.push_back(
        fmt::format("mesher: {}, since {}", nameOf(result.mesher->method), result.mesher->why));
  session.textIsSummary = true;
}

// What `--prepare` wrote.
void reportPrepared(const PreparedMesh& mesh, const std::string& folder, Session& session) {
  session.sections["prepared"] = preparedSection(mesh, folder);
  session.text +=
      fmt::format("{}: {}, {} tets, {} boundary faces, {} parts\n", oneLine(folder),
                  bytesText(mesh.bytes), mesh.input.tets, mesh.counts.boundaryFaces, mesh.buckets);
}

void reportShards(const VoxelizeResult& result, Session& session) {
  Json shards = Json::array();
  session.text +=
      fmt::format("{:>6} {:>13} {:>8} {:>7}  voxels\n", "shard", "root children", "full", "work");
  for (std::size_t i = 0; i < result.plan.size(); ++i) {
    const ShardPlan& one = result.plan[i];
    shards.push_back({{"index", i},
                      {"root_children", one.rootChildren},
                      {"full", one.fullRootChildren},
                      {"share", one.share},
                      {"box", {{"min", one.boxMin}, {"max", one.boxMax}}}});
    session.text += fmt::format("{:>6} {:>13} {:>8} {:>6.1f}%", i, one.rootChildren,
                                one.fullRootChildren, 100 * one.share);
    if (one.rootChildren > 0)
      session.text += fmt::format("  {},{},{} to {},{},{}", one.boxMin[0], one.boxMin[1],
                                  one.boxMin[2], one.boxMax[0], one.boxMax[1], one.boxMax[2]);
    session.text += "\n";
  }
  session.sections["shards"] = std::move(shards);
}

void runPlan(const VoxelizeArguments& options, Session& session) {
  if (options.shards == 0 && options.prepare.empty())
    throw Error(Status::Usage, "--shards", "is required, unless --prepare is given",
                "give the number of shards");
  checkPrepared(options);
  VoxelizeJob job = makeJob(options);
  job.output = "plan.vdb"; // is not written
  session.sections = {{"threads", job.threads},
                      {"input", Json::array()},
                      {"prepared", nullptr},
                      {"stages", nullptr},
                      {"shards", nullptr}};
  for (const std::string& path : options.inputs)
    session.sections["input"].push_back({{"path", path}});
  limitProcess(options, session.progress);
  const AllowThreads allowed(job.threads);
  if (!options.prepare.empty()) {
    reportPrepared(prepareMesh(job, options.prepare, session.report, session.progress),
                   options.prepare, session);
    session.textIsSummary = options.shards == 0;
    if (options.shards == 0)
      return;
    job.inputs = {options.prepare};
    job.voxelize.voxelSize = job.voxelize.origin = {0, 0, 0};
    job.read.regionArray.clear();
    job.up = UpAxis::Z;
  } else {
    runAsSequence(job, options.sequence, session); // which is refused
  }
  reportShards(run(job, session.report, session.progress), session);
}

FileNames fileNamesOf(const VoxelizeArguments& options) {
  std::vector<std::string> written;
  if (!options.sequence.unite)
    written = frameNames(options.inputs, options.output, options.sequence);
  if (!options.shard.empty())
    written = {shardPath(options.output, parseShard(options.shard))};
  for (const std::string& path : arrayFiles(options.output))
    if (options.shard.empty())
      written.push_back(path);
  if (!options.tiles.folder.empty())
    written.push_back(options.tiles.folder + "/tiles.json");
  written.insert(written.end(), {options.writeMesh, options.preview});
  return {options.inputs, std::move(written)};
}

CLI::Validator oneOf(const std::set<std::string>& words) {
  return CLI::IsMember(words).description(""); // the help's type already lists the words
}

void addGridOptions(CLI::App& command, VoxelizeArguments& options) {
  command
      .add_option("--grid", options.grids,
                  "Grids to make: " + listGridKinds() +
                      " (tetvdb grids describes them; default density), "
                      "arrays of the mesh by name, or all (arrays); several with commas")
      ->type_name("NAME")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      .add_option("--half-width", options.halfWidth,
                  "Voxels on either side of the surface that hold distances, 1 to 100 (default 3), "
                  "or all of the mesh's box")
      ->type_name("N|all");
  command
      .add_option("--rule", options.rule,
                  "Voxels of density and mask: those whose centre is inside (default), any part of "
                  "their cube, or all of it")
      ->check(oneOf({"centre", "any", "all"}))
      ->type_name("centre|any|all");
  command
      .add_option("--mask-type", options.maskType,
                  "OpenVDB's type of the grid mask: bool (default), which Blender and Houdini "
                  "show, or mask, a third smaller")
      ->check(oneOf({"bool", "mask"}))
      ->type_name("bool|mask");
  command.add_flag("--half", options.half, "Store float grids with 16 bits a value");
  command
      .add_option("--up-axis", options.upAxis,
                  "Axis that points up for the reader: z as in the input (default); y maps (x,y,z) "
                  "to (x,z,-y)")
      ->check(oneOf({"y", "z"}))
      ->type_name("y|z");
  command.add_option("--units", options.units, "Name of the length unit, stored as metadata")
      ->type_name("NAME");
  command.add_flag("--allow-empty", options.allowEmpty, "Write a volume without voxels too");
}

void addSolidOptions(CLI::App& command, VoxelizeArguments& options) {
  command
      .add_option("--mesher", options.mesher,
                  "How triangles become a solid: envelope makes tets within epsilon; winding asks "
                  "the winding number at every voxel, exact for closed meshes; auto (default) is "
                  "winding, and envelope where tets are asked for")
      ->check(oneOf({"auto", "envelope", "winding"}))
      ->type_name("auto|envelope|winding");
  addEpsilonOption(
      command, options,
      "The largest distance of the tets' surface from the triangles: a length, a share of the "
      "diagonal (1e-3d) or voxels (default 0.5v)");
  addInsideOptions(command, options);
  command
      .add_option(
          "--shell-side", options.shellSide,
          "Where the shell lies: on both sides (default), or with all of T outward or inward "
          "of the triangles")
      ->check(oneOf({"both", "outward", "inward"}))
      ->type_name("both|outward|inward")
      ->needs("--shell");
  addCleaningOptions(command, options);
}

void addFilterOptions(CLI::App& command, VoxelizeArguments& options) {
  command.add_option("--region", options.regions, "Regions to keep, by number or name")
      ->type_name("NAME")
      ->delimiter(',')
      ->allow_extra_args(false);
  command.add_option("--exclude", options.exclude, "Regions to leave out, by number or name")
      ->type_name("NAME")
      ->delimiter(',')
      ->allow_extra_args(false);
  command.add_option("--region-array", options.regionArray, "Cell array that holds region numbers")
      ->type_name("NAME");
  command.add_option("--bbox", options.bbox, "Keep cells that meet this box of the input's space")
      ->type_name("x0,y0,z0,x1,y1,z1")
      ->check(notEmpty());
}

void addInputs(CLI::App& command, VoxelizeArguments& options) {
  command
      .add_option("IN", options.inputs,
                  "Meshes: of triangles: " + endingList(FormatUse::ReadTriangles, "and") +
                      "; of solid cells: " + endingList(FormatUse::ReadCells, "and") +
                      "; a sequence: .pvd or 'frame_*.vtu'; "
                      "or one folder of 'tetvdb plan --prepare'")
      ->required()
      ->type_name("");
}

// Options for the places of voxels.
void addPlacing(CLI::App& command, VoxelizeArguments& options) {
  addSizeOptions(command, options);
  command.get_option("--resolution")->each([&options](const std::string&) {
    options.givesResolution = true;
  });
  CLI::Option* origin =
      command.add_option("--origin", options.origin, "Centre of voxel (0, 0, 0) (default 0,0,0)")
          ->type_name("X,Y,Z")
          ->check(notEmpty());
  CLI::Option* fit =
      command
          .add_option("--fit", options.fit,
                      "A cube of N x N x N voxels numbered from 0, the model at its centre")
          ->type_name("N")
          ->check(CLI::Range(1, 1 << 30).description(""))
          ->excludes("--resolution", "--voxel-size")
          ->excludes(origin);
  command
      .add_option("--padding", options.padding,
                  "Voxels on each side of the cube that --fit leaves free (default 0)")
      ->type_name("P")
      ->check(CLI::Range(0, 1 << 29).description(""))
      ->needs(fit);
}

} // namespace

Command addVoxelize(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "voxelize", "Turn meshes, of tetrahedra or triangles, into a sparse volume");
  auto options = std::make_shared<VoxelizeArguments>();
  addInputs(*command, *options);
  command
      ->add_option("-o,--output", options->output,
                   "Volume to write: " + endingList(FormatUse::WriteVolume) +
                       "; or arrays: " + endingList(FormatUse::WriteArrays))
      ->type_name("FILE")
      ->check(notEmpty());
  command
      ->add_option("--write-mesh", options->writeMesh,
                   "Also write the tets, or write only them: " + endingList(FormatUse::WriteTets) +
                       "; or the cleaned triangles: " + endingList(FormatUse::WriteTriangles))
      ->type_name("FILE")
      ->check(notEmpty());
  addPreviewOption(*command, *options, "the input, its tets if there are, the volume and a slice");
  addPlacing(*command, *options);
  addGridOptions(*command, *options);
  addTileOptions(*command, options->tiles);
  addArrayFlags(*command, options->arrays);
  addFieldOptions(*command, options->fields);
  addSequenceOptions(*command, options->sequence);
  addSolidOptions(*command, *options);
  addFilterOptions(*command, *options);
  command
      ->add_option(
          "--device", options->device,
          "Where to voxelize tets and triangles, sample arrays, compute distances and coverage "
          "(default auto)")
      ->type_name("auto|cpu|cuda[:N[,M...]]");
  command
      ->add_option(
          "--shard", options->shard,
          "Make part I of N, from 0 on, of a .vdb, into "
          "OUT.I-of-N.vdb; auto: as Slurm's arrays, mpirun or srun say; tetvdb merge joins "
          "them")
      ->type_name("I/N|auto")
      ->check(notEmpty());
  addLimitOptions(*command, *options);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kVoxelizeExamples);
  result.run = [options](Session& session) { runVoxelize(*options, session); };
  result.files = [options] { return fileNamesOf(*options); };
  return result;
}

Command addPlan(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "plan",
      "Say what the shards of a volume would have to do, or prepare a mesh larger than memory");
  auto options = std::make_shared<VoxelizeArguments>();
  addInputs(*command, *options);
  command->add_option("--shards", options->shards, "Shards to plan")
      ->check(CLI::Range(1, 1 << 20).description(""))
      ->type_name("N");
  command
      ->add_option("--prepare", options->prepare,
                   "Write a mesh of cells that may be larger than memory (" +
                       endingList(FormatUse::SpoolCells) +
                       ") into a folder that 'tetvdb voxelize' takes in its place")
      ->type_name("DIR")
      ->check(notEmpty());
  addPlacing(*command, *options);
  addGridOptions(*command, *options);
  addFieldOptions(*command, options->fields);
  addInsideOptions(*command, *options);
  addCleaningOptions(*command, *options);
  addFilterOptions(*command, *options);
  addLimitOptions(*command, *options);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kPlanExamples);
  result.run = [options](Session& session) { runPlan(*options, session); };
  result.files = [options] {
    FileNames files{options->inputs, {}};
    if (!options->prepare.empty())
      files.written.push_back(options->prepare + "/prepared.json");
    return files;
  };
  return result;
}

} // namespace tetvdb::cli
