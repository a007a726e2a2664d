// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/MeshReader.h"

#include "tetvdb/core/ClosestName.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/FinishCells.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/SplitCells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>

namespace tetvdb {
namespace {

// --- Regions ------------------------------------------------------------------------------------

/// "Material Ids" and "material_ids" as "materialids".
std::string normalized(std::string_view name) {
  std::string text;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z')
      text += static_cast<char>(c - 'A' + 'a');
    else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
      text += c;
  }
  return text;
}

/// Usual names of arrays with material and region numbers, the most frequent first.
constexpr std::array<std::string_view, 28> kRegionNames{
    "material",      "materials",    "materialid",     "materialids", "mat",         "matid",
    "matids",        "region",       "regions",        "regionid",    "regionids",   "gmshphysical",
    "cellentityids", "cellentityid", "elementblockid", "blockid",     "objectid",    "physical",
    "physicalid",    "physicaltag",  "celltags",       "subdomain",   "subdomainid", "domain",
    "meditref",      "tetgenref",    "attribute",      "partid"};

/// The array as integers; empty if it has several components or other values.
std::vector<std::int32_t> wholeNumbers(const Attribute& array) {
  std::vector<std::int32_t> numbers;
  if (array.components != 1)
    return numbers;
  numbers.reserve(array.size());
  const bool whole = std::visit(
      [&](const auto& values) {
        for (const auto value : values) {
          const auto number = static_cast<double>(value);
          if (!(std::abs(number) <= 2147483647.0) || number != std::floor(number))
            return false;
          numbers.push_back(static_cast<std::int32_t>(number));
        }
        return true;
      },
      array.values);
  if (!whole)
    numbers.clear();
  return numbers;
}

void useRegionArray(CellMesh& mesh, const std::string& name) {
  std::string others;
  std::vector<std::string> names;
  for (const Attribute& array : mesh.attributes) {
    if (array.on != Attribute::On::Cells)
      continue;
    if (array.name != name) {
      others += (others.empty() ? "'" : ", '") + array.name + "'";
      names.push_back(array.name);
      continue;
    }
    mesh.regions = wholeNumbers(array);
    mesh.regionNames.clear();
    if (mesh.regions.empty())
      throw Error(Status::Usage, "cell array '" + name + "'",
                  "cannot tell regions: its values are not single whole numbers");
    return;
  }
  throw Error(
      Status::Usage, "", "the mesh has no cell array '" + name + "'",
      suggestName(name, names,
                  others.empty() ? "it has no cell arrays" : "its cell arrays are " + others));
}

void chooseRegions(CellMesh& mesh, const ReadOptions& options) {
  if (!options.regionArray.empty())
    return useRegionArray(mesh, options.regionArray);
  if (!mesh.regions.empty())
    return;
  for (const std::string_view usual : kRegionNames)
    for (const Attribute& array : mesh.attributes)
      if (array.on == Attribute::On::Cells && normalized(array.name) == usual) {
        mesh.regions = wholeNumbers(array);
        if (!mesh.regions.empty())
          return;
      }
}

// Removes arrays that were read only for regions, or by a reader that reads all.
void leaveOutUnwanted(CellMesh& mesh, const ReadOptions& options) {
  std::vector<Attribute> wanted;
  for (Attribute& array : mesh.attributes) {
    if (options.wants(array.name))
      wanted.push_back(std::move(array));
    else if (options.attributes)
      mesh.unread.push_back({array.name, array.on, array.components});
  }
  mesh.attributes = std::move(wanted);
}

} // namespace

int usualRegionName(std::string_view name) {
  const auto found = std::find(kRegionNames.begin(), kRegionNames.end(), normalized(name));
  return found == kRegionNames.end() ? -1 : static_cast<int>(found - kRegionNames.begin());
}

void finishCells(const std::string& where, CellMesh& mesh, const ReadOptions& options) {
  const bool solid = std::any_of(mesh.runs.begin(), mesh.runs.end(), [](const CellRun& run) {
    return run.count > 0 && run.type != CellType::Flat;
  });
  if (!solid)
    throw Error(Status::Invalid, where,
                "no tetrahedra or other solid cells; it holds " + describeCells(mesh),
                "mesh its volume first, or export the volume mesh too");
  chooseRegions(mesh, options);
  leaveOutUnwanted(mesh, options);
}

CellMesh readCells(const std::string& path, const ReadOptions& options, Report& report,
                   Progress& progress, FileFormat* format) {
  const MappedFile file(path);
  const Source source = file.source();
  const FileFormat found = sniffFormat(source.bytes, path);
  if (format != nullptr)
    *format = found;
  const auto read = formatOf(found).readCells;
  if (read == nullptr)
    throw Error(Status::Invalid, path, describeUnknownFormat(source.bytes, path),
                "readable are " + (found == FileFormat::Unknown
                                       ? endingList(FormatUse::ReadMesh, "and")
                                       : endingList(FormatUse::ReadCells, "and")));
  CellMesh mesh;
  try {
    mesh = read(source, options, report, progress);
  } catch (const std::bad_alloc&) {
    throw Error(Status::Limit, path, "not enough memory to read the mesh",
                "split it into several files or use a machine with more memory");
  }
  finishCells(path, mesh, options);
  return mesh;
}

} // namespace tetvdb
