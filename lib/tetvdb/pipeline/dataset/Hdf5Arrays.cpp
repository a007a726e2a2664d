// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/dataset/Hdf5Arrays.h"

#include "tetvdb/io/source/Hdf5Handle.h"
#include "tetvdb/io/volume/arrays/NewHdf5File.h"

namespace tetvdb {
namespace {

using Handle = Hdf5Handle;

constexpr std::size_t kContiguousBytes = 1024; // smaller arrays are not worth a chunk

// As NumPy names types; booleans and halves as h5py stores them.
Handle typeOf(const std::string& name) {
  if (name == "|b1") {
    Handle type(H5Tenum_create(H5T_STD_I8LE), H5Tclose);
    const signed char no = 0, yes = 1;
    H5Tenum_insert(type.get(), "FALSE", &no);
    H5Tenum_insert(type.get(), "TRUE", &yes);
    return type;
  }
  if (name == "<f2") {
    Handle type(H5Tcopy(H5T_IEEE_F32LE), H5Tclose);
    H5Tset_fields(type.get(), 15, 10, 5, 0, 10);
    H5Tset_size(type.get(), 2);
    H5Tset_ebias(type.get(), 15);
    return type;
  }
  const hid_t known = name == "<f8"   ? H5T_IEEE_F64LE
                      : name == "<f4" ? H5T_IEEE_F32LE
                      : name == "<i4" ? H5T_STD_I32LE
                                      : H5T_STD_U8LE;
  return {H5Tcopy(known), H5Tclose};
}

void writeText(const NewHdf5File& file, const std::string& name, const std::string& value) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE); // h5py has these as str, others as bytes
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle made(
      H5Acreate2(file.id(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  file.check(made.get());
  const char* const text = value.c_str();
  file.check(H5Awrite(made.get(), type.get(), &text));
}

void writeTransform(const NewHdf5File& file, hid_t object, const std::vector<double>& matrix) {
  const hsize_t shape[2] = {4, 4};
  const Handle space(H5Screate_simple(2, shape, nullptr), H5Sclose);
  const Handle made(
      H5Acreate2(object, "transform", H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  file.check(made.get());
  file.check(H5Awrite(made.get(), H5T_NATIVE_DOUBLE, matrix.data()));
}

void writeDataset(const NewHdf5File& file, const NamedArray& array) {
  const std::vector<hsize_t> shape(array.shape.begin(), array.shape.end());
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                     H5Sclose);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);
  H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER);
  if (array.bytes.size() > kContiguousBytes) {
    const std::vector<std::uint64_t> sides = chunkShape(array.shape);
    const std::vector<hsize_t> chunk(sides.begin(), sides.end());
    H5Pset_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data());
    H5Pset_shuffle(creation.get());
    H5Pset_deflate(creation.get(), kChunkDeflateLevel);
    H5Pset_alloc_time(creation.get(), H5D_ALLOC_TIME_INCR);
  }
  const Handle type = typeOf(array.type);
  const Handle made(H5Dcreate2(file.id(), array.name.c_str(), type.get(), space.get(), H5P_DEFAULT,
                               creation.get(), H5P_DEFAULT),
                    H5Dclose);
  file.check(made.get());
  if (!array.bytes.empty())
    file.check(H5Dwrite(made.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, array.bytes.data()));
  if (!array.transform.empty())
    writeTransform(file, made.get(), array.transform);
}

} // namespace

void writeHdf5Arrays(const std::string& path, const std::vector<NamedArray>& arrays,
                     const ArrayAttributes& about) {
  NewHdf5File file(path);
  for (const auto& [name, value] : about.texts)
    writeText(file, name, value);
  writeTransform(file, file.id(), about.transform);
  for (const NamedArray& array : arrays)
    writeDataset(file, unpacked(array));
  file.commit();
}

void joinHdf5Files(const std::string& path,
                   const std::vector<std::pair<std::string, std::string>>& members,
                   Progress& progress) {
  NewHdf5File file(path);
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links.get(), 1);
  H5Pset_char_encoding(links.get(), H5T_CSET_UTF8);
  for (const auto& [name, from] : members) {
    progress.check();
    const Handle member(H5Fopen(from.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!member)
      throw Error(Status::Invalid, from, "is no HDF5 file",
                  "remove its row and run the command again with `resume`");
    file.check(H5Ocopy(member.get(), "/", file.id(), name.c_str(), H5P_DEFAULT, links.get()));
  }
  file.commit();
}

} // namespace tetvdb
