// SPDX-License-Identifier: Apache-2.0
#include "Grids.h"

#include "Report.h"
#include "RunJob.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/volume/arrays/ArrayVolume.h"
#include "tetvdb/io/volume/arrays/MakeDenseGrid.h"
#include "tetvdb/io/volume/arrays/NpyArray.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <openvdb/io/Stream.h>
#include <sstream>
#include <tuple>
#include <utility>
#include <vector>

namespace tetvdb::python {
namespace {

using NumpyArray = nb::ndarray<nb::numpy>;
using Corners = std::pair<std::array<int, 3>, std::array<int, 3>>; ///< both included

struct PyVolume {
  Volume volume;
  ReportText report;
};

struct PyGrid {
  openvdb::GridBase::Ptr grid;
};

nb::dlpack::dtype typeOf(const DenseGrid& grid) {
  if (grid.isBits())
    return nb::dtype<bool>();
  using Code = nb::dlpack::dtype_code;
  const Code code = isFloat(grid.element())                ? Code::Float
                    : grid.element() == ElementType::UInt8 ? Code::UInt
                                                           : Code::Int;
  return {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(8 * bytesOf(grid.element())),
          1};
}

// Memory that an array owns.
struct Buffer {
  std::unique_ptr<char[]> bytes;
  explicit Buffer(std::size_t size) : bytes(new char[size]) {}
};

Buffer bufferOf(double bytes, const std::string& name, const char* advice) {
  constexpr double kNoticeable = double(std::size_t(1) << 26);
  if (bytes > kNoticeable && bytes > static_cast<double>(availableBytes()))
    throw Error(Status::Limit, name,
                "an array of " + std::to_string(static_cast<std::uint64_t>(bytes / 1e6)) +
                    " MB does not fit into memory",
                advice);
  return Buffer(static_cast<std::size_t>(bytes));
}

NumpyArray arrayOf(Buffer buffer, const std::vector<std::size_t>& shape, nb::dlpack::dtype type) {
  char* data = buffer.bytes.release();
  const nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<char*>(p); });
  return NumpyArray(data, shape.size(), shape.data(), owner, nullptr, type);
}

VoxelBox activeBox(const openvdb::GridBase& grid) {
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  VoxelBox result;
  if (!box.empty())
    for (int axis = 0; axis < 3; ++axis) {
      result.low[static_cast<std::size_t>(axis)] = box.min()[axis];
      result.high[static_cast<std::size_t>(axis)] = box.max()[axis];
    }
  return result;
}

VoxelBox boxOf(const openvdb::GridBase& grid, const std::optional<Corners>& corners) {
  if (!corners)
    return activeBox(grid);
  VoxelBox box;
  box.low = corners->first;
  box.high = corners->second;
  return box;
}

std::unique_ptr<DenseGrid> denseOf(const PyGrid& self, const VoxelBox& box) {
  return denseGrid(*self.grid, box);
}

NumpyArray toNumpy(const PyGrid& self, const std::optional<Corners>& corners) {
  const VoxelBox box = boxOf(*self.grid, corners);
  const auto dense = denseOf(self, box);
  Buffer buffer = bufferOf(dense->bytes(), self.grid->getName(),
                           "read a part of it with `box`, or use sparse()");
  if (!box.empty()) {
    const nb::gil_scoped_release released;
    dense->fill(kXSlowest, 0, box.size(0), buffer.bytes.get());
  }
  std::vector<std::size_t> shape{box.size(0), box.size(1), box.size(2)};
  if (dense->components() > 1)
    shape.push_back(dense->components());
  return arrayOf(std::move(buffer), shape, typeOf(*dense));
}

std::pair<NumpyArray, NumpyArray> sparse(const PyGrid& self) {
  const VoxelBox box = activeBox(*self.grid);
  const auto dense = denseOf(self, box);
  const std::size_t count = dense->countActive();
  const std::size_t size = dense->voxelBytes();
  const char* advice = "make it with larger voxels";
  bufferOf(static_cast<double>(count) * static_cast<double>(12 + size), self.grid->getName(),
           advice);
  Buffer voxels(12 * count), values(size * count);
  {
    const nb::gil_scoped_release released;
    char *nextVoxel = voxels.bytes.get(), *nextValue = values.bytes.get();
    std::vector<std::int32_t> plane;
    std::vector<char> planeValues;
    for (std::uint64_t x = 0; x < box.size(0); ++x) {
      plane.clear();
      planeValues.clear();
      dense->activeOf(x, &plane, &planeValues);
      nextVoxel = std::copy_n(reinterpret_cast<const char*>(plane.data()),
                              plane.size() * sizeof(std::int32_t), nextVoxel);
      nextValue = std::copy(planeValues.begin(), planeValues.end(), nextValue);
    }
  }
  std::vector<std::size_t> shape{count};
  if (dense->components() > 1)
    shape.push_back(dense->components());
  return {arrayOf(std::move(voxels), {count, 3}, nb::dtype<std::int32_t>()),
          arrayOf(std::move(values), shape, typeOf(*dense))};
}

nb::tuple tupleOf(const Vec3i& v) {
  return nb::make_tuple(v[0], v[1], v[2]);
}

// World from index: columns are the images of the axes, as for column vectors.
nb::object matrixOf(const openvdb::GridBase& grid, const Vec3i& first) {
  const openvdb::math::Mat4d map = grid.transform().baseMap()->getAffineMap()->getMat4();
  Buffer buffer(16 * sizeof(double));
  auto* rows = reinterpret_cast<double*>(buffer.bytes.get());
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      rows[4 * row + column] = map(column, row);
  if (first != Vec3i{0, 0, 0}) {
    const openvdb::Vec3d origin = grid.indexToWorld(openvdb::Coord(first[0], first[1], first[2]));
    for (int row = 0; row < 3; ++row)
      rows[4 * row + 3] = origin[row];
  }
  return nb::cast(arrayOf(std::move(buffer), {4, 4}, nb::dtype<double>()));
}

std::string streamOf(const openvdb::GridPtrVec& grids) {
  std::ostringstream out(std::ios_base::binary);
  openvdb::io::Stream(out).write(grids);
  return out.str();
}

nb::bytes bytesOf(const openvdb::GridPtrVec& grids) {
  std::string bytes;
  {
    const nb::gil_scoped_release released;
    bytes = streamOf(grids);
  }
  return nb::bytes(bytes.data(), bytes.size());
}

// Python's own OpenVDB takes bytes: nothing of its memory is shared with this module's OpenVDB.
nb::object toOpenVdb(const PyGrid& self) {
  nb::object python;
  try {
    python = nb::module_::import_("pyopenvdb");
  } catch (const nb::python_error&) {
    python = nb::module_::import_("openvdb");
  }
  const std::string type = self.grid->valueType();
  for (const auto& [ours, theirs] :
       {std::pair("float", "FloatGrid"), std::pair("bool", "BoolGrid"),
        std::pair("vec3s", "Vec3SGrid"), std::pair("double", "DoubleGrid"),
        std::pair("int32", "Int32Grid"), std::pair("int64", "Int64Grid")})
    if (type == ours && nb::hasattr(python, theirs)) {
      nb::object grid = python.attr(theirs)();
      grid.attr("__setstate__")(nb::make_tuple(nb::dict(), bytesOf({self.grid})));
      return grid;
    }
  throw Error(Status::Usage, self.grid->getName(),
              "is a grid of " + type + ", which Python's OpenVDB does not know",
              "use to_numpy() or sparse()");
}

std::string requireName(const PyVolume& self, const std::string& name) {
  std::string names;
  for (const auto& grid : self.volume.grids().all) {
    if (grid->getName() == name)
      return name;
    names += (names.empty() ? "" : ", ") + grid->getName();
  }
  throw nb::key_error(("no grid '" + name + "'; there are " + names).c_str());
}

PyGrid gridNamed(const PyVolume& self, const std::string& name) {
  requireName(self, name);
  for (const auto& grid : self.volume.grids().all)
    if (grid->getName() == name)
      return {grid};
  return {};
}

std::vector<std::string> namesOf(const PyVolume& self) {
  std::vector<std::string> names;
  for (const auto& grid : self.volume.grids().all)
    names.push_back(grid->getName());
  return names;
}

void write(const PyVolume& self, nb::handle where, const std::optional<Corners>& corners,
           bool sparse, bool compress) {
  const std::string path = pathOf(where);
  ArrayOptions arrays;
  arrays.sparse = sparse;
  arrays.compress = compress;
  if (corners)
    arrays.box = VoxelBox{corners->first, corners->second};
  if ((sparse || compress || arrays.box) && !isArrayFile(path))
    throw Error(Status::Usage,
                arrays.box ? "`box`"
                : compress ? "`compress`"
                           : "`sparse`",
                "is for arrays, and the file is none",
                "leave it out, or end the name with " + arrayEndings());
  JobRun run({});
  run([&](Report&, Progress& progress) {
    if (isArrayFile(path))
      writeArrays(path, self.volume, arrays, progress);
    else
      writeVolume(path, self.volume, progress);
    return true;
  });
}

ArrayInput inputOf(const std::optional<Vec3d>& voxelSize, const std::optional<Vec3d>& origin,
                   bool zSlowest, const std::optional<double>& background) {
  ArrayInput options;
  options.voxelSize = voxelSize;
  options.origin = origin;
  options.zSlowest = zSlowest;
  options.background = background;
  return options;
}

PyVolume read(nb::handle where, const std::optional<Vec3d>& voxelSize,
              const std::optional<Vec3d>& origin, const std::string& axes,
              const std::optional<double>& background) {
  const std::string path = pathOf(where);
  const ArrayInput options = inputOf(voxelSize, origin, axes == "zyx", background);
  if (axes != "xyz" && axes != "zyx")
    throw Error(Status::Usage, "`axes`", "'" + axes + "' is neither xyz nor zyx");
  JobRun run({});
  return {run([&](Report& report, Progress& progress) {
            Volume volume = voxelSize || origin || options.zSlowest || background
                                ? readArrays(path, options, progress)
                                : readVolume(path, progress);
            warnOfReading(volume, path, report);
            return volume;
          }),
          {}};
}

using ContiguousArray = nb::ndarray<nb::ro, nb::device::cpu, nb::c_contig>;

// The type of the numbers of an array, and whether it is bool.
std::pair<ElementType, bool> elementOf(const ContiguousArray& array, const std::string& name) {
  using Code = nb::dlpack::dtype_code;
  const nb::dlpack::dtype type = array.dtype();
  const auto code = static_cast<Code>(type.code);
  for (const ElementType element : kElementTypes) {
    const bool isSigned = namesOf(element).plain[0] == 'i';
    const Code own = isFloat(element) ? Code::Float : isSigned ? Code::Int : Code::UInt;
    const bool isBits = code == Code::Bool && element == ElementType::UInt8;
    if (type.bits == 8 * bytesOf(element) && type.lanes == 1 && (code == own || isBits))
      return {element, isBits};
  }
  throw Error(Status::Usage, "`" + name + "`", "is no array of integers, floats or booleans",
              "convert it, as with astype(\"float32\")");
}

// Transform: of index space, row by row.
PyVolume fromArrays(const std::vector<std::pair<std::string, ContiguousArray>>& arrays,
                    const std::optional<Vec3d>& voxelSize, const std::optional<Vec3d>& origin,
                    const std::optional<std::array<double, 16>>& transform,
                    const std::array<int, 3>& first, const std::optional<double>& background) {
  const ArrayInput options = inputOf(voxelSize, origin, false, background);
  std::vector<NpyArray> found;
  for (const auto& [name, array] : arrays) {
    NpyArray one;
    std::tie(one.element, one.isBits) = elementOf(array, name);
    for (std::size_t k = 0; k < array.ndim(); ++k)
      one.shape.push_back(array.shape(k));
    one.bytes = {static_cast<const char*>(array.data()), array.nbytes()};
    found.push_back(std::move(one));
  }
  JobRun run({});
  return {run([&](Report& report, Progress& progress) {
            ArrayVolume volume("arrays", options, progress);
            for (std::size_t i = 0; i < found.size(); ++i) {
              StoredArray array;
              if (!setVoxels(found[i], array))
                throw Error(Status::Usage, "`" + arrays[i].first + "`",
                            "is no array of voxels but " + found[i].describe(),
                            "give [x][y][z], with up to 4 components on a last axis");
              array.name = arrays[i].first;
              array.low = first;
              array.placed = transform.has_value();
              array.transform = transform.value_or(kIdentity);
              volume.add(std::move(array));
            }
            Volume made = volume.finish();
            warnOfReading(made, "arrays", report);
            return made;
          }),
          {}};
}

void restore(PyVolume& self, const nb::bytes& state) {
  std::istringstream in(std::string(state.c_str(), state.size()), std::ios_base::binary);
  auto set = std::make_shared<GridSet>();
  initializeOpenVDB();
  set->all = *openvdb::io::Stream(in).getGrids();
  new (&self) PyVolume{Volume(std::move(set)), {}};
}

void addGrid(nb::module_& module) {
  nb::class_<PyGrid>(module, "Grid", "One sparse grid of a Volume, which it keeps alive.")
      .def_prop_ro("name", [](const PyGrid& self) { return self.grid->getName(); })
      .def_prop_ro(
          "type", [](const PyGrid& self) { return self.grid->valueType(); },
          "As OpenVDB names value types: \"float\", \"bool\", \"int32\", ...")
      .def_prop_ro(
          "grid_class",
          [](const PyGrid& self) {
            return openvdb::GridBase::gridClassToString(self.grid->getGridClass());
          },
          "\"level set\", \"fog volume\" or \"unknown\".")
      .def_prop_ro(
          "active_voxels", [](const PyGrid& self) { return self.grid->activeVoxelCount(); },
          "Active voxels, tiles counted in full.")
      .def_prop_ro(
          "voxel_size",
          [](const PyGrid& self) {
            const openvdb::Vec3d size = self.grid->voxelSize();
            return nb::make_tuple(size[0], size[1], size[2]);
          },
          "A voxel's sides, world units.")
      .def_prop_ro(
          "box",
          [](const PyGrid& self) -> nb::object {
            const VoxelBox box = activeBox(*self.grid);
            if (box.empty())
              return nb::none();
            return nb::make_tuple(tupleOf(box.low), tupleOf(box.high));
          },
          "Index coordinates of the lowest and the highest corner of the active voxels, both "
          "included; None where there are none.")
      .def_prop_ro(
          "origin", [](const PyGrid& self) { return tupleOf(activeBox(*self.grid).low); },
          "Index coordinates of the voxel that is [0, 0, 0] in to_numpy().")
      .def_prop_ro(
          "transform",
          [](const PyGrid& self) {
            return matrixOf(*self.grid, {0, 0, 0});
          },
          "4 x 4 matrix from index space (voxel centres at integers) to world space, for column "
          "vectors.")
      .def_prop_ro(
          "array_transform",
          [](const PyGrid& self) { return matrixOf(*self.grid, activeBox(*self.grid).low); },
          "4 x 4 matrix from indices of to_numpy() to world space, for column vectors.")
      .def("to_numpy", &toNumpy, nb::arg("box").none() = nb::none(),
           "The voxels of a box as a dense array [x, y, z] (vectors: [x, y, z, component]).\n\n"
           "box: the lowest and the highest corner in index coordinates, both included; None: the "
           "box of the active voxels.\n"
           "Voxels that are not active have the value that the grid holds there, its background or "
           "an inactive tile's. Bool and mask grids become bool.")
      .def("sparse", &sparse,
           "The active voxels: int32 coordinates (N, 3), ascending by x, then y, then z, and their "
           "values (N).")
      .def(
          "to_bytes", [](const PyGrid& self) { return bytesOf({self.grid}); },
          "The grid as the bytes of a .vdb stream.")
      .def("to_openvdb", &toOpenVdb,
           "The grid as one of Python's own OpenVDB (pyopenvdb or openvdb), by its bytes.")
      .def("__repr__", [](const PyGrid& self) {
        return "<tetvdb.Grid '" + self.grid->getName() + "' (" + self.grid->valueType() +
               "): " + std::to_string(self.grid->activeVoxelCount()) + " active voxels>";
      });
}

} // namespace

void addGrids(nb::module_& module) {
  addGrid(module);
  nb::class_<PyVolume>(module, "Volume",
                       "Sparse grids that belong together: a mapping from names to grids.")
      .def("__getitem__", &gridNamed, nb::arg("name"))
      .def("__len__", [](const PyVolume& self) { return self.volume.grids().all.size(); })
      .def("__iter__", [](const PyVolume& self) { return nb::iter(nb::cast(namesOf(self))); })
      .def("__contains__",
           [](const PyVolume& self, const std::string& name) {
             const std::vector<std::string> names = namesOf(self);
             return std::find(names.begin(), names.end(), name) != names.end();
           })
      .def("keys", &namesOf, "Names of the grids, in order.")
      .def_prop_ro(
          "metadata", [](const PyVolume& self) { return self.volume.metadata; },
          "Metadata of the file: \"creator\", \"source\", \"units\" and others.")
      .def_prop_ro(
          "report", [](const PyVolume& self) { return reportDict(self.report); },
          "What the job did that made the volume, a dict: the object that the command line writes "
          "with --json. Empty for a volume that was read.")
      .def("write", &write, nb::arg("path"), nb::arg("box").none() = nb::none(),
           nb::arg("sparse") = false, nb::arg("compress") = false,
           "Writes .vdb or .nvdb, or dense arrays: .npy, .npz, .vti, .nrrd, .h5, .tif, .raw, "
           ".binvox. The file is whole or absent. Of arrays: box, two corners in index "
           "coordinates, both included; sparse, coordinates and values of active voxels (.npz); "
           "compress, by deflate.")
      .def(
          "hash",
          [](const PyVolume& self) {
            const nb::gil_scoped_release released;
            return hash(self.volume);
          },
          "32 hexadecimal digits over names, classes, transforms, topology and values: equal for "
          "equal volumes, as of 'tetvdb info --hash'.")
      .def("__getstate__", [](const PyVolume& self) { return bytesOf(self.volume.grids().all); })
      .def("__setstate__", &restore)
      .def("__repr__", [](const PyVolume& self) {
        std::string names;
        for (const std::string& name : namesOf(self))
          names += (names.empty() ? "" : ", ") + name;
        return "<tetvdb.Volume: " + names + ">";
      });
  module.def("read", &read, nb::arg("path"), nb::kw_only(), nb::arg("voxel_size") = nb::none(),
             nb::arg("origin") = nb::none(), nb::arg("axes") = "xyz",
             nb::arg("background") = nb::none(),
             "Reads a .vdb or .nvdb file, or dense arrays, to which the settings apply.");
  module.def("from_arrays", &fromArrays);
}

nb::object volumeObject(Volume volume, ReportText report) {
  return nb::cast(PyVolume{std::move(volume), std::move(report)});
}

Volume volumeOf(nb::handle object) {
  return nb::cast<const PyVolume&>(object).volume;
}

} // namespace tetvdb::python
