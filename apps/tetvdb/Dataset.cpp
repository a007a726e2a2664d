// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "DatasetNames.h"
#include "DatasetWorkers.h"
#include "JobOptions.h"
#include "OptionNames.h"
#include "ParseQuantities.h"
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/pipeline/Shard.h"
#include "tetvdb/pipeline/dataset/JoinDataset.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <set>
#include <sys/resource.h>
#include <tbb/task_arena.h>
#include <thread>

namespace tetvdb::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const char* const kDatasetExamples = R"(Examples:
  tetvdb dataset ModelNet40/ -o voxels --resolution 64,256
      every mesh of the folder and those below it; classes and splits by the folders' names
  tetvdb dataset models.csv -o onet --content points,samples --format occupancy-networks
      query points with occupancy, and surface points with normals, as Occupancy Networks reads them
  tetvdb dataset models.csv -o sdf --content points --format deepsdf --points 0 --near-points 500000
  tetvdb dataset models.csv -o vdb --format vdb --content occupancy,distance --resolution 512
  tetvdb dataset models.csv -o tars --archives 32 --shard auto
      in each task of a Slurm array or of mpirun; then, once all have ended:
  tetvdb dataset models.csv -o tars --archives 32 --join
  tetvdb dataset ModelNet40/ -o voxels --resolution 64,256 --resume
      after an interruption: goes on with the models that are not done

A list is a .csv file with a header, or .jsonl with an object a line: path, and where they are there
id, class, split. Each model ends in success.csv or in failed.csv with the reason; card.md says what
there is, preview.png shows some of it. Arrays have the model's longest side as 1 and the middle of
its box at 0, unless --normalize says otherwise; `transform` leads there. docs/datasets.md has all.)";

struct DatasetArguments {
  std::string input, output;
  std::vector<int> resolutions{64};
  std::vector<std::string> content{"occupancy"}, formats{"npz"};
  std::string normalize = "longest", up = "z", band = "3", shard, maxMemory, epsilonRange,
              turn = "vertical", device = "cpu";
  DatasetOptions make;
  bool noPack = false, resume = false, join = false, noPreview = false, worker = false;
  unsigned archives = 0;
  int workers = 0;
  double maxTime = 300;
};

template <typename Value>
using Choices = std::vector<std::pair<const char*, Value>>;

const Choices<DatasetFormat> kDatasetFormats{
    {"npz", DatasetFormat::Npz},        {"npy", DatasetFormat::Npy},
    {"binvox", DatasetFormat::Binvox},  {"vdb", DatasetFormat::Vdb},
    {"nvdb", DatasetFormat::Nvdb},      {"hdf5", DatasetFormat::Hdf5},
    {"zarr", DatasetFormat::Zarr},      {"occupancy-networks", DatasetFormat::OccupancyNetworks},
    {"deepsdf", DatasetFormat::DeepSdf}};
template <typename Value>
std::vector<std::string> namesOf(const Choices<Value>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices)
    names.emplace_back(name);
  return names;
}

template <typename Value>
Value valueOf(const Choices<Value>& choices, const std::string& name) {
  return std::find_if(choices.begin(), choices.end(),
                      [&](const auto& choice) { return choice.first == name; })
      ->second;
}

void checkFormats(const DatasetOptions& make) {
  const auto writes = [&](DatasetFormat format) {
    return std::find(make.formats.begin(), make.formats.end(), format) != make.formats.end();
  };
  const DatasetContent& content = make.content;
  if (writes(DatasetFormat::Binvox) && !content.occupancy)
    throw Error(Status::Usage, "--format binvox", "holds occupancy, which is not asked for",
                "add occupancy to --content");
  if (writes(DatasetFormat::DeepSdf) && !content.points)
    throw Error(Status::Usage, "--format deepsdf", "holds query points, which are not asked for",
                "give --content points");
  if (writes(DatasetFormat::OccupancyNetworks) && !content.points && !content.samples)
    throw Error(Status::Usage, "--format occupancy-networks",
                "holds query points and samples of the surface, which are not asked for",
                "give --content points,samples");
  if ((writes(DatasetFormat::Vdb) || writes(DatasetFormat::Nvdb)) && !content.occupancy &&
      !content.distance && !content.surface && !content.coordinates)
    throw Error(Status::Usage, "--format vdb", "holds grids, and none is asked for",
                "add occupancy, distance or surface to --content");
}

DatasetOptions datasetOptions(const DatasetArguments& options) {
  DatasetOptions make = options.make;
  make.resolutions = sortedResolutions(options.resolutions);
  make.normalize = valueOf(kNormalLengths, options.normalize);
  make.yUp = options.up == "y";
  make.content = {};
  make.content.occupancy = false;
  for (const std::string& name : options.content)
    make.content.*valueOf(kDatasetContents, name) = true;
  make.formats.clear();
  for (const std::string& name : options.formats)
    make.formats.push_back(valueOf(kDatasetFormats, name));
  make.packBits = !options.noPack;
  make.turnAny = options.turn == "any";
  make.bandVoxels = options.band == "all" ? std::numeric_limits<double>::infinity()
                                          : parseLength("--band", options.band);
  if (!options.epsilonRange.empty()) {
    const std::size_t colon = options.epsilonRange.find(':');
    make.epsilonLow = parseLength("--epsilon-range", options.epsilonRange.substr(0, colon));
    make.epsilonHigh = colon == std::string::npos
                           ? make.epsilonLow
                           : parseLength("--epsilon-range", options.epsilonRange.substr(colon + 1));
    if (make.epsilonHigh < make.epsilonLow || make.epsilonHigh > 0.1)
      throw Error(Status::Usage, "--epsilon-range",
                  "'" + options.epsilonRange + "' is no range of shares of the diagonal",
                  "give LOW:HIGH, such as 1e-4:1e-2");
  }
  JobOptions limits;
  limits.maxMemory = options.maxMemory;
  make.maxMemory = memoryLimit(limits);
  make.device = parseDevice("--device", options.device);
  requireDevice(make.device);
  checkFormats(make);
  if (options.archives > 0 && options.formats == std::vector<std::string>{"zarr"})
    throw Error(Status::Usage, "--archives",
                "packs no zarr stores: the folder is one store already",
                "leave --archives out, or add another --format");
  return make;
}

// Everything that the files of the data set depend on.
Json settingsOf(const DatasetArguments& options, const DatasetOptions& make) {
  return {{"version", version()},
          {"manifest", options.input},
          {"resolutions", make.resolutions},
          {"normalize", options.normalize},
          {"padding", make.padding},
          {"up_axis", options.up},
          {"content", options.content},
          {"formats", options.formats},
          {"pack_bits", make.packBits},
          {"band", options.band},
          {"points", make.uniformPoints},
          {"near_points", make.nearPoints},
          {"near_distance", make.nearDistance},
          {"sharp_points", make.sharpPoints},
          {"samples", make.samples},
          {"half_floats", make.halfFloats},
          {"variants", make.variants},
          {"turn", options.turn},
          {"scale_jitter", make.scaleJitter},
          {"move_jitter", make.moveJitter},
          {"epsilon_range", options.epsilonRange},
          {"seed", make.seed},
          {"archives", options.archives}};
}

// The settings are written by the first task; every other must have the same.
void requireSameSettings(const DatasetArguments& options, const Json& settings, bool goesOn) {
  const fs::path path = fs::path(options.output) / "dataset.json";
  std::error_code error;
  if (fs::exists(path, error)) {
    if (!goesOn)
      throw Error(Status::Usage, options.output, "holds a data set already",
                  "go on with it by --resume, or choose another folder");
    const MappedFile file(path.string());
    const Json there = Json::parse(file.bytes(), nullptr, false);
    for (const auto& [key, value] : settings.items())
      if (!there.is_object() || there.value(key, Json()) != value)
        throw Error(Status::Usage, options.output, "was made with another setting of '" + key + "'",
                    "use the same, or choose another folder");
    return;
  }
  if (options.join)
    throw Error(Status::Invalid, options.output, "holds no data set",
                "run the tasks first, with --shard");
  fs::create_directories(options.output, error);
  if (!goesOn && !fs::is_empty(options.output, error) && !error)
    throw Error(Status::Usage, options.output, "is not empty", "choose a new folder");
  AtomicFile file(path.string());
  const std::string text = settings.dump(2) + "\n";
  file.write(text.data(), text.size());
  file.commit();
}

// Processor seconds of all threads of this process so far.
double processorSeconds() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto of = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return of(used.ru_utime) + of(used.ru_stime);
}

DatasetRow tryItem(const DatasetItem& item, const DatasetOptions& make, const std::string& folder) {
  const auto began = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  Report report;
  Progress progress;
  const auto failed = [&](Status status, const std::string& text) {
    const std::string stage = report.stages.empty() ? "" : report.stages.back().name;
    return failureRow(item, status, withOptionNames(text), stage, seconds());
  };
  try {
    const ItemResult result = makeItem(item, make, folder, report, progress);
    return successRow(item, result, report, seconds());
  } catch (const Error& error) {
    return failed(error.status(), error.what());
  } catch (const std::bad_alloc&) {
    return failed(Status::Limit, "out of memory");
  } catch (const std::exception& error) {
    return failed(Status::Invalid, error.what());
  }
}

// In a process that makes no other item meanwhile.
DatasetRow makeRow(const DatasetItem& item, const DatasetOptions& make, const std::string& folder) {
  const double before = processorSeconds();
  DatasetRow row = tryItem(item, make, folder);
  row["processor_seconds"] = processorSeconds() - before;
  return row;
}

std::string summaryOf(const DatasetSummary& summary, const std::string& output) {
  std::string text = fmt::format("{}: {} models, {} done, {} failed; {:.1f} s", output,
                                 summary.items, summary.succeeded, summary.failed, summary.seconds);
  if (summary.sameFile > 0)
    text += fmt::format("; {} repeat another's file", summary.sameFile);
  return text + "\n";
}

void runDataset(const DatasetArguments& options, Session& session) {
  const DatasetOptions make = datasetOptions(options);
  if (options.worker) {
    tbb::task_arena arena(1);
    const AllowThreads allowed(1);
    arena.execute([&] {
      serveItems([&](const DatasetItem& item) { return makeRow(item, make, options.output); });
    });
    return;
  }
  const Shard shard = options.shard.empty() ? Shard{} : parseShard(options.shard);
  const std::vector<DatasetItem> items = itemsOf(readManifest(options.input), make.variants);
  const Json settings = settingsOf(options, make);
  requireSameSettings(options, settings, options.resume || options.join || !shard.isWhole());
  const std::string rowFolder = options.output + "/rows";
  std::map<std::string, DatasetRow> rows = readRows(rowFolder);

  std::size_t succeeded = 0, failed = 0;
  if (!options.join) {
    std::vector<DatasetItem> left;
    for (const DatasetItem& item : items)
      if (hashOfId(item.entry.id) % shard.count == shard.index && rows.count(item.name()) == 0)
        left.push_back(item);
    session.progress.stage("dataset");
    RowJournal journal(rowFolder + "/" + (shard.isWhole() ? "all" : shard.name()) + ".jsonl");
    WorkerOptions workers;
    workers.count = options.workers > 0
                        ? options.workers
                        : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    workers.maxSeconds = options.maxTime;
    makeInWorkers(
        left, workers,
        [&](const DatasetRow& row) {
          journal.append(row);
          ++(isSuccess(row) ? succeeded : failed);
          const std::string name = row.at("name");
          rows[name] = row;
        },
        session.progress);
  }
  session.sections["settings"] = settings;
  if (!shard.isWhole() && !options.join) {
    session.sections["shard"] = {{"index", shard.index}, {"count", shard.count}};
    session.sections["succeeded"] = succeeded;
    session.sections["failed"] = failed;
    session.text = fmt::format("{}: task {} of {}: {} models done, {} failed\n", options.output,
                               shard.index, shard.count, succeeded, failed);
    session.textIsSummary = true;
    return;
  }
  const DatasetSummary summary = joinDataset(
      items, rows, make, {options.archives, !options.noPreview}, options.output, session.progress);
  session.sections["models"] = summary.items;
  session.sections["succeeded"] = summary.succeeded;
  session.sections["failed"] = summary.failed;
  session.sections["same_file"] = summary.sameFile;
  session.sections["same_grid"] = summary.sameGrid;
  session.sections["seconds"] = summary.seconds;
  Json outputs = Json::array();
  for (const std::string& file : summary.files)
    outputs.push_back({{"path", options.output + "/" + file}});
  session.sections["output"] = std::move(outputs);
  session.text = summaryOf(summary, options.output);
  session.textIsSummary = true;
  if (summary.succeeded == 0)
    throw Error(Status::Invalid, options.output, "no model succeeded", "failed.csv says why");
}

void addContentOptions(CLI::App& command, DatasetArguments& options) {
  const auto oneOf = [](const std::vector<std::string>& names) {
    return CLI::IsMember(names).description("");
  };
  command
      .add_option("--content", options.content,
                  "What to make: occupancy, distance (signed, of voxel centres), surface (voxels "
                  "that faces pass through), coordinates (numbers of voxels), points (query points "
                  "with occupancy and distance), samples (of the surface, with normals)")
      ->delimiter(',')
      ->check(oneOf(namesOf(kDatasetContents)))
      ->type_name("NAME,...")
      ->capture_default_str();
  command
      .add_option("--format", options.formats,
                  "npz, npy, binvox, vdb, nvdb, hdf5, zarr, occupancy-networks, deepsdf; several "
                  "at once")
      ->delimiter(',')
      ->check(oneOf(namesOf(kDatasetFormats)))
      ->type_name("NAME,...")
      ->capture_default_str();
  command
      .add_option("--resolution", options.resolutions,
                  "Voxels along each side of the cube; several")
      ->delimiter(',')
      ->check(CLI::Range(1, 2048).description(""))
      ->type_name("N,...")
      ->capture_default_str();
  command
      .add_option(
          "--normalize", options.normalize,
          "The length that becomes 1: the longest side of the box, its diagonal, or twice the "
          "largest distance from its centre; none keeps the coordinates")
      ->check(oneOf(namesOf(kNormalLengths)))
      ->type_name("longest|diagonal|sphere|none")
      ->capture_default_str();
  command
      .add_option("--padding", options.make.padding,
                  "Free space around the model, both sides together, as a share of that length")
      ->check(CLI::Range(0.0, 10.0).description(""))
      ->type_name("P")
      ->capture_default_str();
  command.add_option("--up", options.up, "The models' axis that points up; it becomes z")
      ->check(oneOf({"y", "z"}))
      ->type_name("y|z")
      ->capture_default_str();
  command
      .add_option(
          "--band", options.band,
          "Distances up to so many voxels from the surface, farther ones are cut; all: none")
      ->type_name("V|all")
      ->capture_default_str();
  command.add_flag("--no-pack", options.noPack,
                   "Booleans of .npz and .npy as a byte each, not as numpy.packbits() packs them");
  command.add_flag("--half-floats", options.make.halfFloats, "Points as 16-bit floats");
  const auto count = [&](const char* name, std::size_t& value, const char* what) {
    command.add_option(name, value, what)
        ->check(CLI::Range(std::size_t(0), std::size_t(100'000'000)).description(""))
        ->type_name("N")
        ->capture_default_str();
  };
  count("--points", options.make.uniformPoints, "Query points, uniform in the cube");
  count("--near-points", options.make.nearPoints, "Query points near the surface");
  count("--sharp-points", options.make.sharpPoints, "Query points near edges above 30 degrees");
  command
      .add_option("--near-distance", options.make.nearDistance,
                  "How near: the standard deviation, a share of the model's length")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("D")
      ->capture_default_str();
  count("--samples", options.make.samples, "Samples of the surface");
}

void addVariantOptions(CLI::App& command, DatasetArguments& options) {
  command
      .add_option("--variants", options.make.variants,
                  "Further versions of every model, changed at random as the next options say")
      ->check(CLI::Range(0, 10'000).description(""))
      ->type_name("K")
      ->capture_default_str();
  command.add_option("--turn", options.turn, "Turned about the vertical, or about any axis")
      ->check(CLI::IsMember(std::vector<std::string>{"vertical", "any"}).description(""))
      ->type_name("vertical|any")
      ->capture_default_str();
  command.add_option("--scale-jitter", options.make.scaleJitter, "Scaled by 1 - J to 1")
      ->check(CLI::Range(0.0, 0.99).description(""))
      ->type_name("J");
  command
      .add_option("--move-jitter", options.make.moveJitter,
                  "Moved by up to J along each axis, a share of the model's length")
      ->check(CLI::Range(0.0, 10.0).description(""))
      ->type_name("J");
  command
      .add_option("--epsilon-range", options.epsilonRange,
                  "Surfaces of tets within epsilon of the model: shares of the diagonal, chosen at "
                  "random in the range by their logarithm")
      ->type_name("LOW:HIGH");
  command.add_option("--seed", options.make.seed, "Of all that is random")->type_name("N");
}

void addRunOptions(CLI::App& command, DatasetArguments& options) {
  command
      .add_option("--workers", options.workers,
                  "Processes of one thread each (default: one a core)")
      ->check(CLI::Range(1, 4096).description(""))
      ->type_name("N");
  command
      .add_option("--max-time", options.maxTime, "Seconds for one model; then it counts as failed")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("S")
      ->capture_default_str();
  command.add_option("--max-memory", options.maxMemory, "For one model: bytes, or 500M, 4G")
      ->check(notEmpty())
      ->type_name("B");
  command
      .add_option("--shard", options.shard,
                  "Do the share I of N, I from 0 to N - 1; auto: as a Slurm array, mpirun or srun "
                  "says. Models are shared out by their identifiers")
      ->check(notEmpty())
      ->type_name("I/N|auto");
  command
      .add_option(
          "--device", options.device,
          "cpu, or cuda, cuda:1: the GPU that models become voxels on; the files are the same")
      ->check(notEmpty())
      ->type_name("cpu|cuda|cuda:N")
      ->capture_default_str();
  command.add_flag("--join", options.join, "Once all shares are done: tables, archives, card");
  command.add_flag("--resume", options.resume, "Go on with a data set: models that are done stay");
  command
      .add_option("--archives", options.archives,
                  "Pack the files into so many .tar files, as WebDataset reads them; HDF5 into so "
                  "many .h5 files, a group a model")
      ->check(CLI::Range(1, 100'000).description(""))
      ->type_name("N");
  command.add_flag("--no-preview", options.noPreview, "Leave preview.png out");
  command.add_flag("--worker", options.worker, "")->group("");
}

} // namespace

Command addDataset(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "dataset", "Voxels, distances and points of many models, for machine learning");
  auto options = std::make_shared<DatasetArguments>();
  command->add_option("LIST|DIR", options->input, "A folder of meshes, or a list of them")
      ->required()
      ->check(notEmpty())
      ->type_name("");
  command->add_option("-o,--output", options->output, "The folder of the data set")
      ->required()
      ->check(notEmpty())
      ->type_name("DIR");
  addContentOptions(*command, *options);
  addVariantOptions(*command, *options);
  addRunOptions(*command, *options);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kDatasetExamples);
  result.run = [options](Session& session) { runDataset(*options, session); };
  result.files = [] { return FileNames{}; };
  return result;
}

} // namespace tetvdb::cli
