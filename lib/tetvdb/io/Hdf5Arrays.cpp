// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/Hdf5Arrays.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <hdf5.h>
#include <map>
#include <type_traits>
#include <utility>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCut = "the file is damaged or cut off; export it again";

/// Identifiers of the library's objects.
class Handle {
public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0)
      close_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle& operator=(Handle&&) = delete;

  hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

private:
  hid_t id_;
  Close close_;
};

/// How many bytes one byte of a file can become at most: zlib's limit.
constexpr double kMostExpansion = 1100;

herr_t refuseLink(const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) {
  return -1;
}

class Files {
public:
  Files() : access_(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);
    H5Pset_elink_cb(access_.get(), refuseLink, nullptr);
  }

  Attribute::Values read(const Hdf5Dataset& wanted) {
    where_ = wanted.file + ":" + wanted.path;
    const hid_t opened = file(wanted.file);
    room_ = sizes_.at(wanted.file) * kMostExpansion;
    const Handle dataset(H5Dopen2(opened, wanted.path.c_str(), access_.get()), H5Dclose);
    if (!dataset)
      fail("there is no such dataset", "put the .h5 file there that belongs to the .xdmf file");
    refuseForeignStorage(dataset.get());
    const Handle space(H5Dget_space(dataset.get()), H5Sclose);
    const std::uint64_t whole = count(space.get());
    const std::uint64_t numbers = wanted.sliced ? slice(space.get(), wanted.slab) : whole;
    if (numbers < wanted.least)
      fail("has " + std::to_string(numbers) + " numbers in place of " +
               std::to_string(wanted.least),
           kCut);
    return numbersOf(dataset.get(), space.get(), whole, numbers);
  }

private:
  [[noreturn]] void fail(const std::string& what, const char* advice = kCut) const {
    throw Error(Status::Invalid, where_, what, advice);
  }

  hid_t file(const std::string& path) {
    const auto known = files_.find(path);
    if (known != files_.end())
      return known->second.get();
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(path, error);
    if (error)
      fail("the file cannot be read: " + error.message(), "put it beside the .xdmf file");
    Handle opened(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!opened)
      fail("is not a whole HDF5 file");
    sizes_[path] = static_cast<double>(bytes);
    return files_.emplace(path, std::move(opened)).first->second.get();
  }

  // Bytes of other files than the one that is named.
  void refuseForeignStorage(hid_t dataset) const {
    const Handle plan(H5Dget_create_plist(dataset), H5Pclose);
    if (!plan)
      fail("the dataset cannot be read");
    if (H5Pget_layout(plan.get()) == H5D_VIRTUAL || H5Pget_external_count(plan.get()) > 0)
      fail("the dataset's numbers lie in other files, which is not read", "export it again");
  }

  std::uint64_t count(hid_t space) const {
    const hssize_t n = H5Sget_simple_extent_npoints(space);
    if (n < 0 || H5Sget_simple_extent_ndims(space) < 0)
      fail("the dataset has no extent");
    return static_cast<std::uint64_t>(n);
  }

  std::uint64_t slice(hid_t space, const Slab& slab) const {
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 0 || static_cast<std::size_t>(rank) != slab.start.size() || rank > H5S_MAX_RANK)
      fail("the dataset has " + std::to_string(rank) + " dimensions, its hyperslab " +
           std::to_string(slab.start.size()));
    hsize_t extent[H5S_MAX_RANK], start[H5S_MAX_RANK], stride[H5S_MAX_RANK], number[H5S_MAX_RANK];
    H5Sget_simple_extent_dims(space, extent, nullptr);
    std::uint64_t all = 1;
    for (std::size_t k = 0; k < slab.start.size(); ++k) {
      const std::uint64_t last = extent[k];
      if (slab.stride[k] == 0 || slab.count[k] == 0 || slab.start[k] >= last ||
          (slab.count[k] - 1) > (last - 1 - slab.start[k]) / slab.stride[k])
        fail("a hyperslab lies outside the dataset");
      start[k] = slab.start[k];
      stride[k] = slab.stride[k];
      number[k] = slab.count[k];
      all *= slab.count[k]; // no more than the extent
    }
    if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start, stride, number, nullptr) < 0)
      fail("a hyperslab cannot be selected");
    return all;
  }

  template <class Stored, class Kept>
  Attribute::Values numbersAs(hid_t dataset, hid_t space, std::uint64_t n, hid_t type) const {
    std::vector<Stored> stored(n);
    const hsize_t size = n;
    const Handle memory(H5Screate_simple(1, &size, nullptr), H5Sclose);
    if (n > 0 && H5Dread(dataset, type, memory.get(), space, H5P_DEFAULT, stored.data()) < 0)
      fail("the dataset cannot be read");
    if constexpr (std::is_same_v<Stored, Kept>)
      return stored;
    else
      return std::vector<Kept>(stored.begin(), stored.end());
  }

  Attribute::Values numbersOf(hid_t dataset, hid_t space, std::uint64_t whole,
                              std::uint64_t n) const {
    const Handle type(H5Dget_type(dataset), H5Tclose);
    if (!type)
      fail("the dataset has no type");
    const std::size_t each = H5Tget_size(type.get());
    const H5T_class_t kind = H5Tget_class(type.get());
    if (each == 0 || each > 8 || (kind != H5T_FLOAT && kind != H5T_INTEGER && kind != H5T_ENUM))
      fail("the dataset does not hold numbers of at most 64 bits", "export the file again");
    if (static_cast<double>(whole) * static_cast<double>(each) > room_)
      fail(std::to_string(whole) + " numbers are declared, more than the file holds");
    if (kind == H5T_FLOAT)
      return each <= 4 ? numbersAs<float, float>(dataset, space, n, H5T_NATIVE_FLOAT)
                       : numbersAs<double, double>(dataset, space, n, H5T_NATIVE_DOUBLE);
    if (kind == H5T_ENUM) // h5py's booleans
      return numbersAs<signed char, std::int32_t>(dataset, space, n, H5T_NATIVE_SCHAR);
    const bool positive = H5Tget_sign(type.get()) == H5T_SGN_NONE;
    if (each < 4 || (each == 4 && !positive))
      return numbersAs<std::int32_t, std::int32_t>(dataset, space, n, H5T_NATIVE_INT32);
    return numbersAs<std::int64_t, std::int64_t>(dataset, space, n, H5T_NATIVE_INT64);
  }

  Handle access_;
  std::map<std::string, Handle> files_;
  std::map<std::string, double> sizes_;
  double room_ = 0; ///< bytes that the dataset's file can hold after decompression
  std::string where_;
};

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
  IsolationLimits limits;
  limits.memory = (std::uint64_t(2) << 30) + static_cast<std::uint64_t>(40 * bytes);
  limits.seconds = 60 + static_cast<unsigned>(std::min(bytes / 5e6, 1e6));
  const auto read = [&](Report&, Progress& childProgress) {
    // The library locks what it reads, which read-only file systems refuse.
    ::setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);
    Files files;
    NumberArrays arrays;
    for (const Hdf5Dataset& dataset : datasets) {
      arrays.push_back(files.read(dataset));
      childProgress.check();
    }
    return arrays;
  };
  NumberArrays arrays = readArraysIsolated(read, path, limits, report, progress);
  if (arrays.size() != datasets.size())
    throw Error(Status::Invalid, path, "its HDF5 file cannot be read", kCut);
  for (std::size_t i = 0; i < arrays.size(); ++i)
    if (std::visit([](const auto& v) { return v.size(); }, arrays[i]) < datasets[i].least)
      throw Error(Status::Invalid, path, "its HDF5 file cannot be read", kCut);
  return arrays;
}

} // namespace tetvdb
