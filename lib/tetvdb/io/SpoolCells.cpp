// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/SpoolCells.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/FinishCells.h"
#include "tetvdb/io/source/Source.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kChunk = std::size_t(1) << 18;

// Appends the array's numbers where all of them are whole; says whether they are.
template <typename T>
bool appendWhole(const FileSpool& values, FileSpool& regions) {
  const T* all = values.as<T>();
  const std::size_t count = values.count<T>();
  const auto isWhole = [](T value) {
    const auto number = static_cast<double>(value);
    return std::abs(number) <= 2147483647.0 && number == std::floor(number);
  };
  if (!std::all_of(all, all + count, isWhole))
    return false;
  std::vector<std::int32_t> part;
  for (std::size_t done = 0; done < count; done += kChunk) {
    part.assign(std::min(kChunk, count - done), 0);
    std::transform(all + done, all + done + part.size(), part.begin(),
                   [](T value) { return static_cast<std::int32_t>(value); });
    regions.append(part);
  }
  return true;
}

// By the alternatives of Attribute::Values.
bool appendRegions(const SpooledArray& array, FileSpool& regions) {
  if (array.on != Attribute::On::Cells || array.components != 1)
    return false;
  array.values->finish();
  switch (array.type) {
  case 0:
    return appendWhole<float>(*array.values, regions);
  case 1:
    return appendWhole<double>(*array.values, regions);
  case 2:
    return appendWhole<std::int32_t>(*array.values, regions);
  default:
    return appendWhole<std::int64_t>(*array.values, regions);
  }
}

void chooseRegions(const std::string& path, const std::string& name, SpooledMesh& mesh) {
  if (!name.empty()) {
    const SpooledArray* array = mesh.find(name, Attribute::On::Cells);
    if (array == nullptr)
      throw Error(Status::Usage, path, "the mesh has no cell array '" + name + "'");
    mesh.regions.clear();
    if (!appendRegions(*array, mesh.regions))
      throw Error(Status::Usage, "cell array '" + name + "'",
                  "cannot tell regions: its values are not single whole numbers");
    return;
  }
  if (mesh.regions.size() > 0)
    return;
  std::vector<std::pair<int, const SpooledArray*>> usual;
  for (const SpooledArray& array : mesh.arrays)
    if (const int place = usualRegionName(array.name); place >= 0)
      usual.emplace_back(place, &array);
  std::stable_sort(usual.begin(), usual.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [place, array] : usual)
    if (appendRegions(*array, mesh.regions))
      return;
}

} // namespace

void refuseToSpool(const std::string& where, const std::string& kind) {
  throw Error(Status::Invalid, where,
              "holds cells of the kind '" + kind +
                  "'; only meshes of linear tets, hexahedra, wedges, pyramids and prisms can be "
                  "prepared",
              "write it as tets first, by `write_mesh`");
}

void spoolCells(const std::string& path, const ReadOptions& options, SpooledMesh& mesh,
                FileFormat& format, Report& report, Progress& progress) {
  const MappedFile file(path);
  const Source source = file.source();
  format = sniffFormat(source.bytes, path);
  const auto spool = formatOf(format).spoolCells;
  if (spool == nullptr)
    throw Error(Status::Usage, path,
                "is not of a format that can be read part by part" +
                    (format == FileFormat::Unknown ? std::string()
                                                   : " (" + std::string(formatName(format)) + ")"),
                "convert it to " + endingList(FormatUse::SpoolCells));
  spool(source, options, mesh, report, progress);
  if (mesh.cellCount() == 0)
    throw Error(Status::Invalid, path, "no tetrahedra or other solid cells",
                "mesh its volume first, or export the volume mesh too");
  chooseRegions(path, options.regionArray, mesh);
  const auto isUnwanted = [&](const SpooledArray& array) { return !options.wants(array.name); };
  if (options.attributes)
    for (const SpooledArray& array : mesh.arrays)
      if (isUnwanted(array))
        mesh.unread.push_back({array.name, array.on, array.components});
  mesh.arrays.erase(std::remove_if(mesh.arrays.begin(), mesh.arrays.end(),
                                   [&](const SpooledArray& array) {
                                     return !options.attributes || isUnwanted(array);
                                   }),
                    mesh.arrays.end());
  splitSpooled(mesh, report, progress);
  if (mesh.tetCount() == 0)
    throw Error(Status::Invalid, path, "no solid cell can be split into tetrahedra",
                "the corners of all of them coincide");
  mesh.finish();
}

} // namespace tetvdb
