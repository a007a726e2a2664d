// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/source/Hdf5Handle.h"
#include "tetvdb/io/volume/arrays/ArrayWriters.h"
#include "tetvdb/io/volume/arrays/NewHdf5File.h"

#include <algorithm>
#include <cerrno>
#include <vector>

namespace tetvdb {
namespace {

using Handle = Hdf5Handle;

// Of the types that grids have.
hid_t typeOf(ElementType element) {
  switch (element) {
  case ElementType::UInt8:
    return H5T_STD_U8LE;
  case ElementType::Int32:
    return H5T_STD_I32LE;
  case ElementType::Int64:
    return H5T_STD_I64LE;
  case ElementType::Float32:
    return H5T_IEEE_F32LE;
  case ElementType::Float64:
    return H5T_IEEE_F64LE;
  default:
    return -1;
  }
}

class Hdf5ArrayFile {
public:
  Hdf5ArrayFile(const ArrayContent& content, Progress& progress)
      : content_(content), stream_(content, progress), file_(content.path) {}

  void write() {
    const VoxelBox& box = content_.box;
    attribute("transform", H5T_IEEE_F64LE, {4, 4}, content_.transform.data());
    attribute("origin", H5T_STD_I32LE, {3}, box.low.data());
    const Vec3d size = content_.voxelSize();
    attribute("voxel_size", H5T_IEEE_F64LE, {3}, size.data());
    for (const auto& [key, value] : content_.metadata)
      text(key, value);
    for (std::size_t i = 0; i < content_.grids.size(); ++i)
      dataset(*content_.grids[i], content_.names[i]);
    file_.commit();
  }

private:
  void attribute(const std::string& name, hid_t type, const std::vector<hsize_t>& shape,
                 const void* values) const {
    const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                       H5Sclose);
    const Handle made(
        H5Acreate2(file_.id(), name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    file_.check(made.get());
    if (H5Awrite(made.get(), type, values) < 0)
      file_.fail();
  }

  void text(const std::string& name, const std::string& value) const {
    if (name.empty() || H5Aexists(file_.id(), name.c_str()) > 0)
      return;
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.get(), std::max<std::size_t>(value.size(), 1));
    H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
    H5Tset_cset(type.get(), H5T_CSET_UTF8);
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle made(
        H5Acreate2(file_.id(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    file_.check(made.get());
    if (H5Awrite(made.get(), type.get(), value.empty() ? "" : value.data()) < 0)
      file_.fail();
  }

  void dataset(const DenseGrid& grid, const std::string& name) {
    const VoxelBox& box = content_.box;
    std::vector<hsize_t> shape{box.size(0), box.size(1), box.size(2)};
    if (grid.components() > 1)
      shape.push_back(grid.components());
    const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                       H5Sclose);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER);
    if (content_.compress) {
      // Whole planes are written, so that no chunk is written twice.
      constexpr hsize_t kSide = 512;
      std::vector<hsize_t> chunk = shape;
      chunk[0] = 1;
      chunk[1] = std::min(chunk[1], kSide);
      chunk[2] = std::min(chunk[2], kSide);
      constexpr unsigned kLevel = 6;
      H5Pset_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data());
      H5Pset_shuffle(creation.get());
      H5Pset_deflate(creation.get(), kLevel);
    }
    const hid_t type = typeOf(grid.element());
    const Handle made(H5Dcreate2(file_.id(), name.c_str(), type, space.get(), H5P_DEFAULT,
                                 creation.get(), H5P_DEFAULT),
                      H5Dclose);
    file_.check(made.get());
    std::vector<hsize_t> start(shape.size(), 0), count = shape;
    stream_.send(grid, kXSlowest, [&](const char* bytes, std::size_t size) {
      count[0] = size / grid.planeBytes(kXSlowest);
      const Handle part(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                        H5Sclose);
      H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                          nullptr);
      errno = 0;
      if (H5Dwrite(made.get(), type, part.get(), space.get(), H5P_DEFAULT, bytes) < 0)
        file_.fail();
      start[0] += count[0];
    });
  }

  const ArrayContent& content_;
  ArrayStream stream_;
  NewHdf5File file_;
};

} // namespace

void writeHdf5(const ArrayContent& content, Progress& progress) {
  Hdf5ArrayFile(content, progress).write();
}

} // namespace tetvdb
