// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/source/Hdf5File.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/Hdf5Handle.h"

#include <cstdlib>
#include <type_traits>

namespace tetvdb {
namespace {

/// How many bytes one byte of a file can become at most: zlib's limit.
constexpr double kMaxExpansion = 1100;

using Handle = Hdf5Handle;

herr_t refuseLink(const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) {
  return -1;
}

/// `flags`: with H5F_ACC_RDWR changes stay in memory.
hid_t openBytes(const Source& source, unsigned flags) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), std::size_t(1) << 20, 0);
  if (H5Pset_file_image(access.get(), const_cast<char*>(source.bytes.data()), source.bytes.size()) <
      0)
    return -1;
  return H5Fopen("bytes", flags, access.get());
}

void beCareful() {
  // The library locks what it reads, which read-only file systems refuse.
  ::setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5PLset_loading_state(0);
}

} // namespace

struct Hdf5File::State {
  State(std::string name, hid_t opened, double bytes)
      : path(std::move(name)), file(opened, H5Fclose), room(bytes * kMaxExpansion),
        datasets(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose),
        links(H5Pcreate(H5P_LINK_ACCESS), H5Pclose) {
    H5Pset_elink_cb(datasets.get(), refuseLink, nullptr);
    H5Pset_elink_cb(links.get(), refuseLink, nullptr);
    if (!file)
      throw Error(Status::Invalid, path, "is not a whole HDF5 file", kCut);
  }

  [[noreturn]] void fail(const std::string& where, const std::string& what,
                         const char* advice = kCut) const {
    throw Error(Status::Invalid, path + ":" + where, what, advice);
  }

  Handle open(const std::string& name) const {
    Handle dataset(H5Dopen2(file.get(), name.c_str(), datasets.get()), H5Dclose);
    if (!dataset)
      fail(name, "there is no such dataset", "the file is not that which is needed, or damaged");
    return dataset;
  }

  // Bytes of other files than the one that is named.
  void refuseForeignStorage(const std::string& name, hid_t dataset) const {
    const Handle plan(H5Dget_create_plist(dataset), H5Pclose);
    if (!plan)
      fail(name, "the dataset cannot be read");
    if (H5Pget_layout(plan.get()) == H5D_VIRTUAL || H5Pget_external_count(plan.get()) > 0)
      fail(name, "the dataset's numbers lie in other files, which is not read", "export it again");
  }

  std::uint64_t count(const std::string& name, hid_t space) const {
    const hssize_t n = H5Sget_simple_extent_npoints(space);
    if (n < 0 || H5Sget_simple_extent_ndims(space) < 0)
      fail(name, "the dataset has no extent");
    return static_cast<std::uint64_t>(n);
  }

  std::uint64_t slice(const std::string& name, hid_t space, const Slab& slab) const {
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 0 || static_cast<std::size_t>(rank) != slab.start.size() || rank > H5S_MAX_RANK)
      fail(name, "the dataset has " + std::to_string(rank) + " dimensions, its hyperslab " +
                     std::to_string(slab.start.size()));
    hsize_t extent[H5S_MAX_RANK], start[H5S_MAX_RANK], stride[H5S_MAX_RANK], number[H5S_MAX_RANK];
    H5Sget_simple_extent_dims(space, extent, nullptr);
    std::uint64_t all = 1;
    for (std::size_t k = 0; k < slab.start.size(); ++k) {
      const std::uint64_t last = extent[k];
      if (slab.stride[k] == 0 || slab.count[k] == 0 || slab.start[k] >= last ||
          (slab.count[k] - 1) > (last - 1 - slab.start[k]) / slab.stride[k])
        fail(name, "a hyperslab lies outside the dataset");
      start[k] = slab.start[k];
      stride[k] = slab.stride[k];
      number[k] = slab.count[k];
      all *= slab.count[k]; // no more than the extent
    }
    if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start, stride, number, nullptr) < 0)
      fail(name, "a hyperslab cannot be selected");
    return all;
  }

  template <class Stored, class Kept>
  Attribute::Values numbersAs(const std::string& name, hid_t dataset, hid_t space, std::uint64_t n,
                              hid_t type) const {
    std::vector<Stored> stored(n);
    const hsize_t size = n;
    const Handle memory(H5Screate_simple(1, &size, nullptr), H5Sclose);
    if (n > 0 && H5Dread(dataset, type, memory.get(), space, H5P_DEFAULT, stored.data()) < 0)
      fail(name, "the dataset cannot be read");
    if constexpr (std::is_same_v<Stored, Kept>)
      return stored;
    else
      return std::vector<Kept>(stored.begin(), stored.end());
  }

  Attribute::Values numbersOf(const std::string& name, hid_t dataset, hid_t space,
                              std::uint64_t whole, std::uint64_t n) const {
    const Handle type(H5Dget_type(dataset), H5Tclose);
    if (!type)
      fail(name, "the dataset has no type");
    const std::size_t each = H5Tget_size(type.get());
    const H5T_class_t kind = H5Tget_class(type.get());
    if (each == 0 || each > 8 || (kind != H5T_FLOAT && kind != H5T_INTEGER && kind != H5T_ENUM))
      fail(name, "the dataset does not hold numbers of at most 64 bits", "export the file again");
    if (static_cast<double>(whole) * static_cast<double>(each) > room)
      fail(name, std::to_string(whole) + " numbers are declared, more than the file holds");
    if (kind == H5T_FLOAT)
      return each <= 4 ? numbersAs<float, float>(name, dataset, space, n, H5T_NATIVE_FLOAT)
                       : numbersAs<double, double>(name, dataset, space, n, H5T_NATIVE_DOUBLE);
    if (kind == H5T_ENUM) // h5py's booleans
      return numbersAs<signed char, std::int32_t>(name, dataset, space, n, H5T_NATIVE_SCHAR);
    const bool positive = H5Tget_sign(type.get()) == H5T_SGN_NONE;
    if (each < 4 || (each == 4 && !positive))
      return numbersAs<std::int32_t, std::int32_t>(name, dataset, space, n, H5T_NATIVE_INT32);
    return numbersAs<std::int64_t, std::int64_t>(name, dataset, space, n, H5T_NATIVE_INT64);
  }

  Handle attribute(const std::string& group, const char* name) const {
    return {H5Aopen_by_name(file.get(), group.c_str(), name, H5P_DEFAULT, links.get()), H5Aclose};
  }

  std::string path;
  Handle file;
  double room; ///< bytes that the file can hold after decompression
  Handle datasets, links;
};

Hdf5File::Hdf5File(const Source& source) {
  beCareful();
  const hid_t opened = source.isMapped ? H5Fopen(source.path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)
                                       : openBytes(source, H5F_ACC_RDONLY);
  state_ = std::make_unique<State>(source.path, opened, static_cast<double>(source.bytes.size()));
}

Hdf5File::Hdf5File(const std::string& path) {
  beCareful();
  const MappedFile file(path);
  const hid_t opened = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  state_ = std::make_unique<State>(path, opened, static_cast<double>(file.bytes().size()));
}

Hdf5File::~Hdf5File() = default;
Hdf5File::Hdf5File(Hdf5File&&) noexcept = default;

bool Hdf5File::has(const std::string& path) const {
  // Every link on the way must exist before the next is asked for.
  for (std::size_t slash = path.find('/', 1);; slash = path.find('/', slash + 1)) {
    const std::string part = path.substr(0, slash);
    if (H5Lexists(state_->file.get(), part.c_str(), state_->links.get()) <= 0)
      return false;
    if (slash == path.npos)
      return H5Oexists_by_name(state_->file.get(), part.c_str(), state_->links.get()) > 0;
  }
}

std::vector<std::string> Hdf5File::members(const std::string& group) const {
  constexpr hsize_t max = 100000;
  std::vector<std::string> names;
  if (!has(group))
    return names;
  H5G_info_t info;
  if (H5Gget_info_by_name(state_->file.get(), group.c_str(), &info, state_->links.get()) < 0)
    return names; // a dataset
  if (info.nlinks > max)
    state_->fail(group, "has " + std::to_string(info.nlinks) + " members");
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    char name[1024] = {};
    if (H5Lget_name_by_idx(state_->file.get(), group.c_str(), H5_INDEX_NAME, H5_ITER_INC, i, name,
                           sizeof name, state_->links.get()) < 0)
      state_->fail(group, "its members cannot be listed");
    names.emplace_back(name);
  }
  return names;
}

bool Hdf5File::isGroup(const std::string& path) const {
  H5G_info_t info;
  return has(path) &&
         H5Gget_info_by_name(state_->file.get(), path.c_str(), &info, state_->links.get()) >= 0;
}

std::size_t Hdf5File::numberBytes(const std::string& dataset) const {
  const Handle opened = state_->open(dataset);
  const Handle type(H5Dget_type(opened.get()), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type.get());
  return kind == H5T_INTEGER || kind == H5T_FLOAT ? H5Tget_size(type.get()) : 0;
}

std::vector<std::uint64_t> Hdf5File::shape(const std::string& dataset) const {
  const Handle opened = state_->open(dataset);
  const Handle space(H5Dget_space(opened.get()), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 0 || rank > H5S_MAX_RANK)
    state_->fail(dataset, "the dataset has no extent");
  hsize_t extent[H5S_MAX_RANK];
  H5Sget_simple_extent_dims(space.get(), extent, nullptr);
  return {extent, extent + rank};
}

Attribute::Values Hdf5File::read(const std::string& dataset, const Slab* slab) const {
  const Handle opened = state_->open(dataset);
  state_->refuseForeignStorage(dataset, opened.get());
  const Handle space(H5Dget_space(opened.get()), H5Sclose);
  const std::uint64_t whole = state_->count(dataset, space.get());
  const std::uint64_t n = slab != nullptr ? state_->slice(dataset, space.get(), *slab) : whole;
  return state_->numbersOf(dataset, opened.get(), space.get(), whole, n);
}

std::string Hdf5File::firstOutside() const {
  std::string found;
  const auto lookAtLink = [](hid_t, const char* name, const H5L_info_t* info, void* to) -> herr_t {
    if (info->type == H5L_TYPE_HARD || info->type == H5L_TYPE_SOFT)
      return 0;
    *static_cast<std::string*>(to) = name;
    return 1;
  };
  if (H5Lvisit(state_->file.get(), H5_INDEX_NAME, H5_ITER_NATIVE, lookAtLink, &found) < 0)
    state_->fail("/", "its groups cannot be listed");
  const auto lookAtObject = [](hid_t file, const char* name, const H5O_info_t* info,
                               void* to) -> herr_t {
    if (info->type != H5O_TYPE_DATASET)
      return 0;
    const Handle dataset(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
    const Handle plan(dataset ? H5Dget_create_plist(dataset.get()) : -1, H5Pclose);
    if (plan && H5Pget_layout(plan.get()) != H5D_VIRTUAL && H5Pget_external_count(plan.get()) == 0)
      return 0;
    *static_cast<std::string*>(to) = name;
    return 1;
  };
  if (found.empty() &&
      H5Ovisit(state_->file.get(), H5_INDEX_NAME, H5_ITER_NATIVE, lookAtObject, &found) < 0)
    state_->fail("/", "its groups cannot be listed");
  return found;
}

std::optional<std::string> Hdf5File::text(const std::string& group, const char* attribute) const {
  const Handle opened = state_->attribute(group, attribute);
  if (!opened)
    return {};
  const Handle type(H5Aget_type(opened.get()), H5Tclose);
  if (H5Tget_class(type.get()) != H5T_STRING)
    return {};
  if (H5Tis_variable_str(type.get()) > 0) {
    const Handle space(H5Aget_space(opened.get()), H5Sclose);
    if (H5Sget_simple_extent_npoints(space.get()) != 1)
      return {};
    char* found = nullptr;
    const Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(memory.get(), H5T_VARIABLE);
    H5Tset_cset(memory.get(), H5Tget_cset(type.get()));
    if (H5Aread(opened.get(), memory.get(), &found) < 0 || found == nullptr)
      return {};
    std::string text(found);
    H5free_memory(found);
    return text;
  }
  const std::size_t size = H5Tget_size(type.get());
  if (size == 0 || size > 1000 || H5Aget_storage_size(opened.get()) != size)
    return {};
  std::string text(size, '\0');
  if (H5Aread(opened.get(), type.get(), text.data()) < 0)
    return {};
  return std::string(text.c_str());
}

std::vector<double> Hdf5File::numbers(const std::string& group, const char* attribute,
                                      std::size_t count) const {
  const Handle opened = state_->attribute(group, attribute);
  if (!opened)
    return {};
  const Handle type(H5Aget_type(opened.get()), H5Tclose),
      space(H5Aget_space(opened.get()), H5Sclose);
  const H5T_class_t kind = H5Tget_class(type.get());
  double numbers[16] = {};
  if ((kind != H5T_INTEGER && kind != H5T_FLOAT) || count > std::size(numbers) ||
      H5Sget_simple_extent_npoints(space.get()) != static_cast<hssize_t>(count) ||
      H5Aread(opened.get(), H5T_NATIVE_DOUBLE, numbers) < 0)
    return {};
  return {numbers, numbers + count};
}

std::optional<std::int64_t> Hdf5File::integer(const std::string& group,
                                              const char* attribute) const {
  const Handle opened = state_->attribute(group, attribute);
  if (!opened)
    return {};
  const Handle type(H5Aget_type(opened.get()), H5Tclose),
      space(H5Aget_space(opened.get()), H5Sclose);
  const hssize_t n = H5Sget_simple_extent_npoints(space.get());
  if (H5Tget_class(type.get()) != H5T_INTEGER || n < 1 || n > 16)
    return {};
  std::int64_t numbers[16] = {};
  if (H5Aread(opened.get(), H5T_NATIVE_INT64, numbers) < 0)
    return {};
  return numbers[0];
}

std::vector<ByteChange> changesForNumber(const Source& source, const std::string& dataset,
                                         double number) {
  beCareful();
  const Handle file(openBytes(source, H5F_ACC_RDWR), H5Fclose);
  const Handle opened(file ? H5Dopen2(file.get(), dataset.c_str(), H5P_DEFAULT) : -1, H5Dclose);
  const Handle space(opened ? H5Dget_space(opened.get()) : -1, H5Sclose);
  std::string image(source.bytes.size(), '\0');
  if (!space || H5Sget_simple_extent_npoints(space.get()) != 1 ||
      H5Dwrite(opened.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &number) < 0 ||
      H5Fflush(file.get(), H5F_SCOPE_GLOBAL) < 0 ||
      H5Fget_file_image(file.get(), image.data(), image.size()) !=
          static_cast<ssize_t>(image.size()))
    throw Error(Status::Invalid, source.path + ":" + dataset, "the number cannot be replaced",
                kCut);
  // The superblock is the same, but the library gives it the checksum of one of a file that is
  // open.
  constexpr std::size_t superblock = 48;
  std::vector<ByteChange> changes;
  for (std::size_t i = superblock; i < image.size(); ++i)
    if (image[i] != source.bytes[i])
      changes.push_back({i, image[i]});
  return changes;
}

} // namespace tetvdb
