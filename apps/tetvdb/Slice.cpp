// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "JobOptions.h"
#include "JsonReport.h"
#include "NumberText.h"
#include "PrinterOptions.h"
#include "ProcessLimits.h"
#include "ProgressDisplay.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/text/NumberParser.h"
#include "tetvdb/pipeline/PlannedStages.h"
#include "tetvdb/pipeline/SliceJob.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct SliceArguments : JobOptions, PrinterOptions {
  std::vector<std::string> inputs;
  std::string output, format, aa = "volume", table;
  std::string exposure, bottomExposure, liftHeight, liftSpeed, retractSpeed, lightOffDelay;
  double gamma = 1;
  int levels = 256, bottomLayers = 1, fadedLayers = 0;
  bool materials = false, dither = false;
};

const char* const kSliceExamples = R"(Examples:
  tetvdb slice part.stl -o part.sl1 --printer sl1s.ini
      the printer from an exported configuration of PrusaSlicer
  tetvdb slice part.stl -o layers --pixels 11520,5120 --display 218.88,122.88 --layer-height 0.05
      a folder of PNG files with manifest.json
  tetvdb slice part.3mf -o part.goo --printer saturn.ini --exposure 2.5 --bottom-exposure 30
  tetvdb slice part.stl -o part.sl1 --printer sl1s.ini --aa area --levels 9
      grey levels of the middle plane, nine of them
  tetvdb slice engine.msh -o layers --printer jet.ini --materials
      every pixel the number of its region, as PNG files with a palette
  tetvdb slice a.stl b.stl -o layers --printer jet.ini --materials
  tetvdb slice part.stl -o part.cli --printer lpbf.ini
      contours in place of pixels, as with .svg and .3mf
  tetvdb slice lattice.vdb -o lattice.sl1 --printer sl1s.ini

A grey level is round(255 c), where c is the exact share of the pixel that is solid: of its whole
layer (--aa volume), or of the layer's middle plane (--aa area). The model stands in the middle of
the plate unless --place says otherwise. Lengths of the printer are in millimetres; those of the
model too, unless its file or --units says otherwise. docs/print.md explains formats and options.)";

std::array<std::uint8_t, 256> readTable(const std::string& path) {
  const MappedFile file(path);
  std::string text(file.bytes());
  std::replace(text.begin(), text.end(), ',', ' ');
  NumberParser in(text, path, '#');
  std::array<std::uint8_t, 256> table{};
  for (std::uint8_t& level : table) {
    const double number = in.real();
    if (!(number >= 0 && number <= 255) || number != std::floor(number))
      throw Error(Status::Invalid, path, "holds a level that is not a whole number from 0 to 255");
    level = static_cast<std::uint8_t>(number);
  }
  in.skipSpace();
  if (in.remaining() > 0)
    throw Error(Status::Invalid, path, "holds more than 256 levels");
  return table;
}

void setExposure(const SliceArguments& options, const CLI::App& command, PrinterSettings& printer) {
  takeNumber("--exposure", options.exposure, printer.exposure);
  takeNumber("--bottom-exposure", options.bottomExposure, printer.firstExposure);
  if (command.count("--bottom-layers") > 0)
    printer.bottomLayers = options.bottomLayers;
  if (command.count("--transition-layers") > 0)
    printer.fadedLayers = options.fadedLayers;
  if (!options.liftHeight.empty()) {
    takeNumber("--lift-height", options.liftHeight, printer.liftHeight);
    printer.bottomLiftHeight = printer.liftHeight;
  }
  if (!options.liftSpeed.empty()) {
    takeNumber("--lift-speed", options.liftSpeed, printer.liftSpeed);
    printer.bottomLiftSpeed = printer.liftSpeed;
  }
  takeNumber("--retract-speed", options.retractSpeed, printer.retractSpeed);
  takeNumber("--light-off-delay", options.lightOffDelay, printer.lightOffDelay);
}

SliceJob makeJob(const SliceArguments& options, const CLI::App& command) {
  SliceJob job = sliceJobFrom(options, options.inputs);
  job.output = options.output;
  job.format = options.format;
  setExposure(options, command, job.printer);
  job.aa = options.aa == "area"   ? SliceAa::Area
           : options.aa == "none" ? SliceAa::None
                                  : SliceAa::Volume;
  job.grey.levels = options.levels;
  job.grey.gamma = command.count("--gamma") > 0 ? options.gamma : job.printer.gamma;
  if (!options.table.empty())
    job.grey.table = readTable(options.table);
  job.dither = options.dither;
  job.materials = options.materials;
  setCleaning(options, job.clean);
  job.maxMemory = memoryLimit(options);
  job.threads = threadCount(options);
  return job;
}

void runSlice(const SliceArguments& options, const CLI::App& command, Session& session) {
  Json paths = Json::array();
  for (const std::string& input : options.inputs)
    paths.push_back({{"path", input}});
  session.sections = {{"device", "cpu"},   {"threads", options.threads}, {"input", paths},
                      {"stages", nullptr}, {"slices", nullptr},          {"output", Json::array()}};
  const SliceJob job = makeJob(options, command);
  session.sections["threads"] = job.threads;
  limitProcess(options, session.progress);
  session.estimate.plan(plannedStages(job), secondsNow());
  const AllowThreads allowed(job.threads);
  const SliceResult result = run(job, session.report, session.progress);
  session.sections = sectionsOf(job, result);
  session.text =
      fmt::format("{}: {}, {} layers of {} x {} pixels, {:.6g} ml\n", oneLine(result.output.path),
                  bytesText(result.output.bytes), result.frame.layers, result.frame.width,
                  result.frame.height, result.volume / 1000);
  session.textIsSummary = true;
}

void addExposureOptions(CLI::App& command, SliceArguments& options) {
  const auto add = [&](const char* name, std::string& value, const char* type,
                       const std::string& description) {
    return command.add_option(name, value, description)->type_name(type)->check(notEmpty());
  };
  add("--exposure", options.exposure, "SECONDS", "Exposure of a layer");
  add("--bottom-exposure", options.bottomExposure, "SECONDS", "Exposure of the bottom layers");
  command.add_option("--bottom-layers", options.bottomLayers, "How many of these (default 1)")
      ->check(CLI::Range(0, 1 << 20).description(""))
      ->type_name("N");
  command
      .add_option("--transition-layers", options.fadedLayers,
                  "Layers over which exposure goes from the bottom's to the others' (default 0)")
      ->check(CLI::Range(0, 1 << 20).description(""))
      ->type_name("N");
  add("--lift-height", options.liftHeight, "H", "How far the plate is lifted, mm (default 5)");
  add("--lift-speed", options.liftSpeed, "V", "mm a minute (default 60)");
  add("--retract-speed", options.retractSpeed, "V", "mm a minute (default 150)");
  add("--light-off-delay", options.lightOffDelay, "SECONDS", "Wait before a layer (default 0)");
}

void addPixelOptions(CLI::App& command, SliceArguments& options) {
  command
      .add_option("--aa", options.aa,
                  "Grey levels: volume (default), the share of the pixel through the whole layer; "
                  "area, that of the middle plane; none, white where the centre is solid")
      ->type_name("RULE")
      ->check(CLI::IsMember({"volume", "area", "none"}).description(""));
  command.add_option("--levels", options.levels, "Grey levels, evenly spaced (default 256)")
      ->type_name("N")
      ->check(CLI::Range(2, 256).description(""));
  command
      .add_option("--gamma", options.gamma,
                  "Raise shares to this power (default: the printer's, else 1; 0: half and more "
                  "is white)")
      ->type_name("G");
  command
      .add_option("--lut", options.table,
                  "A file of 256 levels that replace the levels 0 to 255, in the end")
      ->type_name("FILE")
      ->check(notEmpty());
  command.add_flag("--dither", options.dither,
                   "Spread what rounding to --levels, or to 1 bit, leaves over the grey pixels "
                   "nearby");
  command.add_flag("--materials", options.materials,
                   "Pixels are numbers of materials: regions of tets, or inputs of triangles");
}

std::string endingsOfFormats() {
  std::string list;
  for (const LayerFormat& format : layerFormats())
    if (!format.endings.empty() && list.find(format.endings) == std::string::npos)
      (list += list.empty() ? "" : " ") += format.endings;
  return list;
}

std::string namesOfFormats() {
  std::string list;
  for (const LayerFormat& format : layerFormats())
    (list += list.empty() ? "" : ", ") += format.name;
  return list;
}

} // namespace

Command addSlice(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("slice", "Cut a mesh or a volume into the layers of a 3D printer");
  auto options = std::make_shared<SliceArguments>();
  command->add_option("IN", options->inputs, "Meshes of triangles or one of tets, or a volume")
      ->required()
      ->type_name("");
  command
      ->add_option("-o,--output", options->output,
                   "A file: " + endingsOfFormats() + "; without an ending: a folder of PNG files")
      ->required()
      ->type_name("FILE|FOLDER")
      ->check(notEmpty());
  command
      ->add_option("--format", options->format,
                   "Where the ending does not tell: " + namesOfFormats())
      ->type_name("NAME")
      ->check(notEmpty());
  addPrinterOptions(*command, *options);
  addExposureOptions(*command, *options);
  addModelOptions(*command, *options);
  addPixelOptions(*command, *options);
  addCleaningOptions(*command, *options);
  addLimitOptions(*command, *options);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kSliceExamples);
  result.run = [options, command](Session& session) { runSlice(*options, *command, session); };
  result.files = [options] {
    FileNames names{options->inputs, {options->output}};
    names.read.insert(names.read.end(), {options->printer, options->table});
    return names;
  };
  return result;
}

} // namespace tetvdb::cli
