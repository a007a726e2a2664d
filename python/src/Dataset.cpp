// SPDX-License-Identifier: Apache-2.0
#include "DatasetNames.h"
#include "DeviceTensor.h"
#include "Functions.h"
#include "MeshArrays.h"
#include "ParseQuantities.h"
#include "Report.h"
#include "Settings.h"
#include "tetvdb/pipeline/Shard.h"
#include "tetvdb/pipeline/dataset/JoinDataset.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <limits>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <utility>

namespace tetvdb::python {
namespace {

constexpr std::uint64_t kMaxPoints = 100'000'000;
constexpr std::uint64_t kMaxSeed = std::uint64_t(1) << 53;

// Where a limit of time is not given: that of the command.
constexpr double kMaxSeconds = 300;

void refuseOutside(const char* name, double value, double low, double high) {
  if (value < low || value > high)
    Settings::refuse(name, "cannot be used",
                     "give a number from " + std::to_string(low) + " to " + std::to_string(high));
}

void takeShare(Settings& settings, const char* name, double low, double high, double& value) {
  settings.take(name, value);
  refuseOutside(name, value, low, high);
}

void takeCount(Settings& settings, const char* name, std::size_t& value) {
  std::uint64_t count = value;
  settings.takeWhole(name, 0, kMaxPoints, count);
  value = count;
}

std::vector<int> resolutionsOf(Settings& settings) {
  std::vector<std::string> texts;
  settings.take("resolution", texts);
  std::vector<int> resolutions;
  for (const std::string& text : texts) {
    int number = 0;
    std::size_t used = 0;
    try {
      number = std::stoi(text, &used);
    } catch (const std::exception&) {
    }
    if (used != text.size() || number < 1 || number > 2048)
      Settings::refuse("resolution", "'" + text + "' is no number of voxels",
                       "give whole numbers from 1 to 2048");
    resolutions.push_back(number);
  }
  return cli::sortedResolutions(resolutions.empty() ? std::vector<int>{64} : resolutions);
}

DatasetOptions optionsOf(Settings& settings) {
  DatasetOptions options;
  options.formats.clear();
  std::string device = "cpu";
  settings.take("device", device);
  options.device = cli::parseDevice("`device`", device);
  requireDevice(options.device);
  options.resolutions = resolutionsOf(settings);
  settings.takeWord("normalize", cli::kNormalLengths, options.normalize);
  takeShare(settings, "padding", 0, 10, options.padding);
  settings.takeWord("up", {{"z", false}, {"y", true}}, options.yUp);
  std::vector<std::string> content;
  settings.take("content", content);
  if (!content.empty()) {
    options.content = {};
    options.content.occupancy = false;
    for (const std::string& name : content)
      options.content.*Settings::numberOfWord("content", name, cli::kDatasetContents) = true;
  }
  if (nb::isinstance<nb::str>(settings.get("band"))) {
    bool all = false;
    settings.takeWord("band", {{"all", true}}, all);
    options.bandVoxels = std::numeric_limits<double>::infinity();
  } else {
    settings.takeLength("band", options.bandVoxels);
  }
  takeCount(settings, "points", options.uniformPoints);
  takeCount(settings, "near_points", options.nearPoints);
  takeCount(settings, "sharp_points", options.sharpPoints);
  takeCount(settings, "samples", options.samples);
  settings.takeLength("near_distance", options.nearDistance);
  settings.take("half_floats", options.halfFloats);
  std::uint64_t variants = 0;
  settings.takeWhole("variants", 0, 1'000'000, variants);
  options.variants = static_cast<int>(variants);
  settings.takeWord("turn", {{"vertical", false}, {"any", true}}, options.turnAny);
  takeShare(settings, "scale_jitter", 0, 0.99, options.scaleJitter);
  takeShare(settings, "move_jitter", 0, 10, options.moveJitter);
  std::vector<double> range;
  settings.takePair("epsilon_range", range);
  if (!range.empty()) {
    if (!(range[0] > 0 && range[0] <= range[1] && range[1] <= 0.1))
      Settings::refuse("epsilon_range", "is no range of shares of the diagonal",
                       "give two numbers such as (1e-4, 1e-2)");
    options.epsilonLow = range[0];
    options.epsilonHigh = range[1];
  }
  settings.takeWhole("seed", 0, kMaxSeed, options.seed);
  return options;
}

nb::dlpack::dtype dtypeOf(const std::string& type) {
  if (type == "|b1")
    return nb::dtype<bool>();
  const auto bits = static_cast<std::uint8_t>(8 * (type[2] - '0'));
  const nb::dlpack::dtype_code code = type[1] == 'f'   ? nb::dlpack::dtype_code::Float
                                      : type[1] == 'i' ? nb::dlpack::dtype_code::Int
                                                       : nb::dlpack::dtype_code::UInt;
  return {static_cast<std::uint8_t>(code), bits, 1};
}

class DatasetItems {
public:
  DatasetItems(nb::handle manifest, const nb::dict& keywords) {
    Settings settings(keywords);
    options_ = optionsOf(settings);
    std::string shardText;
    settings.take("shard", shardText);
    limits_ = settings.takeLimits();
    if (!settings.has("threads"))
      limits_.threads = 1;
    if (limits_.maxTime == 0)
      limits_.maxTime = kMaxSeconds;
    options_.maxMemory = limits_.maxMemory;
    settings.finish();
    const Shard shard = shardText.empty() ? Shard{} : parseShard(shardText);
    const std::string path = pathOf(manifest);
    const nb::gil_scoped_release released;
    for (DatasetItem& item : itemsOf(readManifest(path), options_.variants))
      if (hashOfId(item.entry.id) % shard.count == shard.index)
        items_.push_back(std::move(item));
  }

  std::size_t size() const { return items_.size(); }
  std::vector<int> resolutions() const { return options_.resolutions; }

  nb::dict about(std::size_t at) const {
    const DatasetItem& item = this->at(at);
    nb::dict about;
    about["name"] = item.name();
    about["id"] = item.entry.id;
    about["variant"] = item.variant;
    about["class"] = item.entry.className;
    about["split"] = item.entry.split;
    about["path"] = item.entry.path;
    return about;
  }

  // The arrays by their names, booleans a byte each.
  nb::dict make(std::size_t at) const {
    const DatasetItem& item = this->at(at);
    JobRun work(limits_, false);
    std::vector<NamedArray> arrays = work([&](Report& report, Progress& progress) {
      return inArena(limits_.threads, [&] {
        std::vector<NamedArray> made;
        makeItemArrays(item, options_, made, report, progress);
        for (NamedArray& array : made)
          if (array.device == nullptr)
            array = unpacked(std::move(array));
        return made;
      });
    });
    nb::dict named;
    for (NamedArray& array : arrays) {
      const std::vector<std::size_t> shape(array.shape.begin(), array.shape.end());
      if (array.device != nullptr) {
        named[array.name.c_str()] =
            deviceTensor(std::move(array.device), shape, array.type == "<f4");
        continue;
      }
      named[array.name.c_str()] = arrayObject(std::move(array.bytes), shape, dtypeOf(array.type));
    }
    return named;
  }

private:
  const DatasetItem& at(std::size_t number) const {
    if (number >= items_.size())
      throw nb::index_error("there is no such model");
    return items_[number];
  }

  DatasetOptions options_;
  JobLimits limits_;
  std::vector<DatasetItem> items_;
};

} // namespace

void addDataset(nb::module_& module) {
  nb::class_<DatasetItems>(module, "_DatasetItems")
      .def(nb::init<nb::handle, nb::dict>(), nb::arg("manifest"), nb::arg("settings"))
      .def("__len__", &DatasetItems::size)
      .def("about", &DatasetItems::about, nb::arg("number"))
      .def("make", &DatasetItems::make, nb::arg("number"))
      .def_prop_ro("resolutions", &DatasetItems::resolutions);
}

} // namespace tetvdb::python
