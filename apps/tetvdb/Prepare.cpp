// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "JobOptions.h"
#include "JsonReport.h"
#include "NumberText.h"
#include "ParseQuantities.h"
#include "ProcessLimits.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/pipeline/PrepareJob.h"

#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <utility>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct PrepareArguments : JobOptions {
  std::string input, output, grid;
  std::string offset, wall, close, fillVoids;
  std::vector<std::string> drains;
  std::string infill, cellSize, thickness, density;
  std::optional<double> simplify;
};

const char* const kPrepareExamples = R"(Examples:
  tetvdb prepare figure.stl -o hollow.stl --hollow 2
      walls of 2 mm, nowhere thinner; the faces of the outside stay as they are
  tetvdb prepare figure.stl -o hollow.3mf --hollow 2 --close 1.5
      no cavity narrower than 3 mm
  tetvdb prepare figure.stl -o hollow.stl --hollow 2 --drain auto:1.5
      a hole of that radius at the lowest point of every cavity; plugs in hollow_plug_1.stl and on
  tetvdb prepare figure.stl -o hollow.stl --hollow 2 --drain 12,0,3,-1,0,0,1.5
      a hole at (12, 0, 3), inward along -x
  tetvdb prepare part.stl -o part.vdb --hollow 1.5
      a level set, for 'tetvdb slice part.vdb'
  tetvdb prepare part.stl -o light.stl --hollow 1.5 --infill gyroid --cell-size 6 --density 0.15
      a gyroid in the cavity that fills 15 % of it
  tetvdb prepare beam.vtu -o beam.stl --hollow 1 --infill gyroid --cell-size 5
      --thickness stress:0.4:1.6
      sheets from 0.4 mm where 'stress' is at its minimum to 1.6 mm where it is at its maximum
  tetvdb prepare scan.stl -o solid.stl --fill-voids 1000
      fills enclosed cavities of less than a cubic centimetre
  tetvdb prepare insert.stl -o loose.stl --offset -0.15
      shrunk by 0.15 mm on every side; convex edges stay sharp

Lengths are in the input's units, volumes in cubes of them. A mesh that is not closed is repaired
first, as by 'repair'. docs/print.md has the methods and their accuracy.)";

std::string infillNames() {
  std::string names;
  for (const InfillKind kind : {InfillKind::Gyroid, InfillKind::SchwarzP, InfillKind::Diamond,
                                InfillKind::Bcc, InfillKind::Octet})
    (names += names.empty() ? "" : ", ") += nameOf(kind);
  return names;
}

double parseOffset(const std::string& text) {
  const std::vector<double> numbers = parseNumbers("--offset", text);
  if (numbers.size() != 1 || !std::isfinite(numbers[0]) || numbers[0] == 0)
    throw Error(Status::Usage, "--offset", "'" + text + "' cannot be used",
                "give a length, below zero to shrink");
  return numbers[0];
}

// "auto", "auto:R" or seven numbers.
void addDrain(const std::string& text, PrepareJob& job) {
  constexpr const char* kAuto = "auto";
  const std::size_t colon = text.find(':');
  if (text.substr(0, colon) == kAuto) {
    if (colon == text.npos && !(job.wall > 0))
      throw Error(Status::Usage, "--drain", "without --hollow a hole has no radius by default",
                  "use auto:R");
    job.drainRadius =
        colon == text.npos ? job.wall : parseLength("--drain", text.substr(colon + 1));
    return;
  }
  const std::vector<double> numbers = parseNumbers("--drain", text);
  bool finite = numbers.size() == 7;
  for (const double number : numbers)
    finite = finite && std::isfinite(number);
  if (!finite || !(numbers[6] > 0) || (numbers[3] == 0 && numbers[4] == 0 && numbers[5] == 0))
    throw Error(Status::Usage, "--drain", "'" + text + "' cannot be used",
                "give X,Y,Z,DX,DY,DZ,R: a point, a direction and a radius; or auto, or auto:R");
  DrainHole hole;
  for (std::size_t k = 0; k < 3; ++k) {
    hole.point[k] = numbers[k];
    hole.direction[k] = numbers[3 + k];
  }
  hole.radius = numbers[6];
  job.drains.push_back(hole);
}

// "0.8" or "ARRAY:LOW:HIGH".
InfillAmount parseAmount(const std::string& option, const std::string& text, bool isDensity) {
  InfillAmount amount;
  amount.isDensity = isDensity;
  const std::size_t last = text.rfind(':');
  const std::size_t first = last == text.npos || last == 0 ? text.npos : text.rfind(':', last - 1);
  if (last == text.npos) {
    amount.low = parseLength(option, text);
    return amount;
  }
  if (first == text.npos || first == 0)
    throw Error(Status::Usage, option, "'" + text + "' cannot be used",
                "give a number, or ARRAY:LOW:HIGH");
  amount.array = text.substr(0, first);
  amount.low = parseLength(option, text.substr(first + 1, last - first - 1));
  amount.high = parseLength(option, text.substr(last + 1));
  return amount;
}

std::optional<InfillSettings> infillOf(const PrepareArguments& options) {
  if (options.infill.empty()) {
    for (const auto& [name, value] :
         {std::pair("--cell-size", &options.cellSize), std::pair("--thickness", &options.thickness),
          std::pair("--density", &options.density)})
      if (!value->empty())
        throw Error(Status::Usage, name, "is of an infill", "give --infill too");
    return std::nullopt;
  }
  InfillSettings infill;
  if (!readInfill(options.infill, infill.kind))
    throw Error(Status::Usage, "--infill", "'" + options.infill + "' is none that is known here",
                "choose from " + infillNames());
  if (options.cellSize.empty())
    throw Error(Status::Usage, "--infill", "needs the size of its cells", "give --cell-size");
  infill.cell = parseLength("--cell-size", options.cellSize);
  if (options.thickness.empty() == options.density.empty())
    throw Error(Status::Usage, "--infill", "needs either a thickness or a density",
                "give --thickness or --density");
  infill.amount = options.density.empty() ? parseAmount("--thickness", options.thickness, false)
                                          : parseAmount("--density", options.density, true);
  return infill;
}

PrepareJob makeJob(const PrepareArguments& options) {
  PrepareJob job;
  job.input = options.input;
  const MappedFile readable(options.input); // says so at once if the file is not there
  job.isVolume = isVolumeFile(options.input);
  job.grid = options.grid;
  if (!job.grid.empty() && !job.isVolume)
    throw Error(Status::Usage, "--grid", "chooses a grid of a volume; the input is a mesh",
                "leave it out");
  job.output = options.output;
  if (!options.offset.empty())
    job.offset = parseOffset(options.offset);
  if (!options.wall.empty())
    job.wall = parseLength("--hollow", options.wall);
  if (!options.close.empty())
    job.close = parseLength("--close", options.close);
  job.simplify = options.simplify;
  if (!options.fillVoids.empty())
    job.fillVolume = parseLength("--fill-voids", options.fillVoids);
  job.infill = infillOf(options);
  for (const std::string& drain : options.drains)
    addDrain(drain, job);
  if (!options.voxelSize.empty())
    job.voxelSize = parseLength("--voxel-size", options.voxelSize);
  setCleaning(options, job.clean);
  job.maxMemory = memoryLimit(options);
  job.threads = threadCount(options);
  return job;
}

Json orNull(bool there, double value) {
  return there ? Json(value) : Json();
}

Json drainsOf(const PrepareResult& result) {
  Json drains = Json::array();
  for (const PreparedDrain& drain : result.drains)
    drains.push_back({{"point", drain.hole.point},
                      {"direction", drain.hole.direction},
                      {"radius", drain.hole.radius},
                      {"plug", drain.plug.path},
                      {"plug_volume", drain.plugVolume}});
  return drains;
}

Json preparedOf(const PrepareResult& result) {
  return {{"source", nameOf(result.source)},
          {"repaired", result.repaired},
          {"voxel_size", orNull(result.voxel > 0, result.voxel)},
          {"voxel_is_coarse", result.voxelIsCoarse},
          {"wall_min", orNull(result.wall > 0, result.wall)},
          {"cavity_triangles", result.wall > 0 ? Json(result.cavityFaces) : Json()},
          {"volume_before", result.volumeBefore},
          {"volume", result.volumeAfter},
          {"volume_saved", result.volumeBefore - result.volumeAfter},
          {"cavities_before", result.cavitiesBefore},
          {"cavities", result.cavities},
          {"filled_voids", result.filledCavities},
          {"filled_volume", result.filledVolume},
          {"loose_infill", result.islands},
          {"drains", drainsOf(result)},
          {"faces_kept", result.keptFaces},
          {"triangles", result.triangles},
          {"vertices", result.vertices},
          {"units", result.units.empty() ? Json() : Json(result.units)},
          {"cleaned", result.source == SolidSource::Triangles ? toJson(result.cleaned) : Json()}};
}

std::string summaryOf(const PrepareResult& result) {
  std::string text = fmt::format("{}: {}, {} triangles, volume {:.6g} of {:.6g}",
                                 oneLine(result.output.path), bytesText(result.output.bytes),
                                 result.triangles, result.volumeAfter, result.volumeBefore);
  if (result.volumeBefore > 0)
    text += fmt::format(" ({:+.1f} %)", 100 * (result.volumeAfter / result.volumeBefore - 1));
  text += fmt::format("\n  cavities: {}, before {}", result.cavities, result.cavitiesBefore);
  if (result.filledCavities > 0)
    text += fmt::format("; {} filled, volume {:.6g}", result.filledCavities, result.filledVolume);
  text += "\n";
  if (result.wall > 0)
    text += fmt::format("  no wall thinner than {:.6g}\n", result.wall);
  for (const PreparedDrain& drain : result.drains)
    text += fmt::format("  hole at {:.6g}, {:.6g}, {:.6g}: plug in {}\n", drain.hole.point[0],
                        drain.hole.point[1], drain.hole.point[2], oneLine(drain.plug.path));
  if (result.voxel > 0)
    text += fmt::format("  voxels of {:.4g}{}\n", result.voxel,
                        result.voxelIsCoarse ? ", coarser than the lengths ask for: the model is "
                                               "large; --voxel-size sets finer ones"
                                             : "");
  return text;
}

void runPrepare(const PrepareArguments& options, Session& session) {
  session.sections = {
      {"device", "cpu"},   {"threads", options.threads}, {"input", {{{"path", options.input}}}},
      {"stages", nullptr}, {"prepare", nullptr},         {"output", Json::array()}};
  const PrepareJob job = makeJob(options);
  session.sections["threads"] = job.threads;
  limitProcess(options, session.progress);
  const AllowThreads allowed(job.threads);
  const PrepareResult result = run(job, session.report, session.progress);
  session.sections["input"][0] = inputSection(options.input, result.source, &result.input);
  session.sections["prepare"] = preparedOf(result);
  Json outputs = {{{"path", result.output.path}, {"bytes", result.output.bytes}}};
  for (const PreparedDrain& drain : result.drains)
    outputs.push_back({{"path", drain.plug.path}, {"bytes", drain.plug.bytes}});
  session.sections["output"] = outputs;
  session.text = summaryOf(result);
  session.textIsSummary = true;
}

} // namespace

Command addPrepare(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("prepare", "Make a solid ready for a 3D printer: hollow, offset");
  auto options = std::make_shared<PrepareArguments>();
  command->add_option("IN", options->input, "A mesh of triangles or tets, or a volume")
      ->required()
      ->type_name("");
  command
      ->add_option("-o,--output", options->output,
                   "A mesh (" + endingList(FormatUse::WriteTriangles) + ") or a level set (" +
                       endingList(FormatUse::WriteVolume) + ")")
      ->required()
      ->type_name("FILE")
      ->check(notEmpty());
  const auto add = [&](const char* name, std::string& value, const char* type,
                       const std::string& description) {
    command->add_option(name, value, description)->type_name(type)->check(notEmpty());
  };
  add("--hollow", options->wall, "T", "Leave walls of this thickness, nowhere thinner");
  add("--close", options->close, "R",
      "With --hollow: the cavity is nowhere narrower than twice this");
  command
      ->add_option(
          "--simplify", options->simplify,
          "With --hollow: merge triangles of the cavity while walls get thicker by no more "
          "than E voxels (default 0.25, with an infill 0; 0: keep all)")
      ->type_name("E");
  add("--fill-voids", options->fillVoids, "V",
      "Fill enclosed cavities of a volume below V, including those that --hollow makes");
  add("--offset", options->offset, "D",
      "Grow the solid by D, or shrink it if D is negative, as the first step");
  add("--infill", options->infill, "KIND", "A lattice in the cavity: " + infillNames());
  add("--cell-size", options->cellSize, "L", "Of the infill: length of a cell");
  add("--thickness", options->thickness, "T",
      "Of the infill's sheets or struts: a length, or ARRAY:LOW:HIGH by an array of the "
      "tetrahedra, LOW at its minimum");
  add("--density", options->density, "D",
      "Instead of the thickness: the filled share of a cell, 0 to 1, or ARRAY:LOW:HIGH");
  command
      ->add_option("--drain", options->drains,
                   "A round hole into a cavity at X,Y,Z along DX,DY,DZ of radius R; repeat it "
                   "for several holes; auto or auto:R: one at the lowest point of every cavity (R: "
                   "default the wall). Plugs are written beside the output")
      ->type_name("HOLE")
      ->allow_extra_args(false)
      ->check(notEmpty());
  add("--voxel-size", options->voxelSize, "H",
      "Of the intermediate grid (default: a 20th of the wall, an 8th of other lengths, larger for "
      "large "
      "models)");
  add("--grid", options->grid, "NAME", "Grid of a volume (default: the first solid one)");
  addCleaningOptions(*command, *options);
  addLimitOptions(*command, *options);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kPrepareExamples);
  result.run = [options](Session& session) { runPrepare(*options, session); };
  result.files = [options] { return FileNames{{options->input}, {options->output}}; };
  return result;
}

} // namespace tetvdb::cli
