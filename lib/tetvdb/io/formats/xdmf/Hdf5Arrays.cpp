// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/xdmf/Hdf5Arrays.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"

#include <filesystem>
#include <map>
#include <utility>
#include <variant>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

} // namespace

NumberArrays readHdf5(const std::vector<Hdf5Dataset>& datasets, const std::string& path,
                      Report& report, Progress& progress) {
  if (datasets.empty())
    return {};
  double bytes = 0;
  std::map<std::string, bool> seen;
  for (const Hdf5Dataset& dataset : datasets) {
    std::error_code error;
    if (!fs::is_regular_file(dataset.file, error))
      throw Error(Status::Invalid, path, "the file '" + dataset.file + "' is missing",
                  "put it beside the .xdmf file, under the name that this one gives");
    if (seen.emplace(dataset.file, true).second)
      bytes += static_cast<double>(fs::file_size(dataset.file, error));
  }
  const IsolationLimits limits = limitsForBytes(bytes);
  const auto read = [&](Report&, Progress& childProgress) {
    std::map<std::string, Hdf5File> files;
    NumberArrays arrays;
    for (const Hdf5Dataset& dataset : datasets) {
      auto file = files.find(dataset.file);
      if (file == files.end())
        file = files.emplace(dataset.file, Hdf5File(dataset.file)).first;
      arrays.push_back(file->second.read(dataset.path, dataset.sliced ? &dataset.slab : nullptr));
      const std::size_t n =
          std::visit([](const auto& values) { return values.size(); }, arrays.back());
      if (n < dataset.min)
        throw Error(Status::Invalid, dataset.file + ":" + dataset.path,
                    "has " + std::to_string(n) + " numbers in place of " +
                        std::to_string(dataset.min),
                    kCut);
      childProgress.check();
    }
    return arrays;
  };
  NumberArrays arrays = readArraysIsolated(read, path, limits, report, progress);
  if (arrays.size() != datasets.size())
    throw Error(Status::Invalid, path, "its HDF5 file cannot be read", kCut);
  for (std::size_t i = 0; i < arrays.size(); ++i)
    if (std::visit([](const auto& v) { return v.size(); }, arrays[i]) < datasets[i].min)
      throw Error(Status::Invalid, path, "its HDF5 file cannot be read", kCut);
  return arrays;
}

std::vector<std::uint64_t> hdf5Shape(const Hdf5Dataset& dataset, const std::string& path,
                                     Report& report, Progress& progress) {
  const NumberArrays found = readArraysIsolated(
      [&](Report&, Progress&) {
        const std::vector<std::uint64_t> shape = Hdf5File(dataset.file).shape(dataset.path);
        return NumberArrays{std::vector<std::int64_t>(shape.begin(), shape.end())};
      },
      path, {std::uint64_t(2) << 30, 60}, report, progress);
  const auto* shape =
      found.size() == 1 ? std::get_if<std::vector<std::int64_t>>(&found.front()) : nullptr;
  if (shape == nullptr || std::any_of(shape->begin(), shape->end(), [](auto n) { return n < 0; }))
    throw Error(Status::Invalid, path, "its HDF5 file cannot be read");
  return {shape->begin(), shape->end()};
}

} // namespace tetvdb
