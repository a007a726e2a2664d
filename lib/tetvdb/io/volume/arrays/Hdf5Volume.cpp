// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/arrays/Hdf5Volume.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Hdf5File.h"

#include <string>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kMostDatasets = 64, kDeepest = 4;

class VolumeInHdf5 {
public:
  VolumeInHdf5(const Source& source, Progress& progress)
      : path_(source.path), file_(source), progress_(progress) {}

  NumberArrays read() {
    addGroup("", 0);
    std::vector<double> place = file_.numbers("/", "transform", 16);
    const std::vector<double> origin = file_.numbers("/", "origin", 3);
    if (place.empty() || origin.empty())
      place.clear();
    else
      place.insert(place.end(), origin.begin(), origin.end());
    NumberArrays all;
    all.emplace_back(std::move(description_));
    all.emplace_back(std::move(place));
    for (Attribute::Values& values : arrays_)
      all.push_back(std::move(values));
    return all;
  }

private:
  void addGroup(const std::string& group, std::size_t depth) {
    for (const std::string& name : file_.members(group.empty() ? "/" : group)) {
      progress_.check();
      const std::string path = group + "/" + name;
      if (!file_.isGroup(path))
        addDataset(path);
      else if (depth < kDeepest)
        addGroup(path, depth + 1);
    }
  }

  void addDataset(const std::string& path) {
    if (count_++ == kMostDatasets)
      throw Error(Status::Limit, path_,
                  "has more than " + std::to_string(kMostDatasets) + " datasets",
                  "write those that are grids into a file of their own");
    const std::vector<std::uint64_t> shape = file_.shape(path);
    const std::size_t bytes = shape.size() >= 3 && shape.size() <= 5 ? file_.numberBytes(path) : 0;
    description_.push_back(static_cast<std::int64_t>(bytes));
    description_.push_back(static_cast<std::int64_t>(shape.size()));
    for (const std::uint64_t length : shape)
      description_.push_back(static_cast<std::int64_t>(length));
    const std::string name = path.substr(1);
    description_.push_back(static_cast<std::int64_t>(name.size()));
    description_.insert(description_.end(), name.begin(), name.end());
    if (bytes > 0)
      arrays_.push_back(file_.read(path));
  }

  std::string path_;
  Hdf5File file_;
  Progress& progress_;
  std::size_t count_ = 0;
  std::vector<std::int64_t> description_;
  NumberArrays arrays_;
};

} // namespace

NumberArrays readHdf5Volume(const Source& source, Report& report, Progress& progress) {
  const auto bytes = static_cast<double>(source.bytes.size());
  const IsolationLimits limits = limitsForBytes(bytes);
  const auto read = [&](Report&, Progress& childProgress) {
    return VolumeInHdf5(source, childProgress).read();
  };
  return readArraysIsolated(read, source.path, limits, report, progress);
}

} // namespace tetvdb
