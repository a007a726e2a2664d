// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "InfoReport.h"
#include "InfoTriangles.h"
#include "JsonReport.h"
#include "NumberText.h"
#include "OptionNames.h"
#include "ProcessLimits.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/VolumeStream.h"
#include "tetvdb/pipeline/ReadInput.h"

#include <cmath>
#include <exception>
#include <fmt/format.h>
#include <new>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct InfoArguments {
  std::vector<std::string> files;
  std::string regionArray;
  bool hash = false;
  DefectOptions defects;
  JobOptions limits;
};

const char* const kInfoExamples = R"(Examples:
  tetvdb info part.msh                 cells, regions, attributes, box, volume, defects
  tetvdb info part.stl                 holes, flips, crossings, whether it is watertight
  tetvdb info part.vdb --hash          grids, and a hash that is equal for equal volumes
  tetvdb info *.vtu --json - | jq .    the same for programs)";

std::string meshText(const InputInfo& info, const TetMesh& mesh) {
  const TetStatistics& statistics = info.statistics;
  std::string text = fmt::format("{}: {}\n  vertices    {}\n", oneLine(info.path),
                                 formatName(info.format), info.vertices);
  std::string cells;
  for (const auto& [type, count] : info.cells)
    cells += fmt::format("{}{} {}", cells.empty() ? "" : ", ", type, count);
  text += fmt::format("  cells       {}\n  tets        {}", cells, info.tets);
  text += fmt::format(" ({} inverted, {} flat)\n", statistics.inverted, statistics.flat);
  const double extent = extentOf(statistics.boxMin, statistics.boxMax);
  text += fmt::format("  box         {} to {}\n  volume      {:.7g}\n",
                      pointText(statistics.boxMin, extent), pointText(statistics.boxMax, extent),
                      statistics.volume);
  if (!info.times.empty())
    text += fmt::format("  steps       {}, from {:.6g} to {:.6g}; values below are of the last\n",
                        info.times.size(), info.times.front(), info.times.back());
  for (const auto& [number, count] : countRegions(mesh))
    text += fmt::format("  region      {} {}: {} cells\n", number,
                        oneLine(regionName(mesh, number)), count);
  for (const Attribute& attribute : mesh.attributes) {
    const ValueSpan range = rangeOf(attribute);
    text += fmt::format("  attribute   {} ({}, {} x {}): {:.6g} to {:.6g}", oneLine(attribute.name),
                        attribute.on == Attribute::On::Points ? "points" : "cells",
                        attribute.components, typeName(attribute), range.min, range.max);
    text += range.notFinite == 0 ? "\n" : fmt::format(", {} not finite\n", range.notFinite);
  }
  return text;
}

std::string gridText(const GridInfo& grid) {
  std::string text =
      fmt::format("  grid        {} ({}, {})\n", oneLine(grid.name), grid.type, grid.gridClass);
  const Vec3d& voxel = grid.transform.voxelSize;
  text +=
      fmt::format("    voxel     {} at origin {}{}\n", lengthText(voxel),
                  pointText(grid.transform.origin, voxel[0]), grid.linear ? "" : ", not linear");
  text += fmt::format("    active    {} voxels: {} leaves, {} tiles; volume {:.7g}\n",
                      grid.activeVoxels, grid.leaves, grid.activeTiles, grid.volume);
  if (grid.activeVoxels > 0)
    text +=
        fmt::format("    box       ({}, {}, {}) to ({}, {}, {}) in voxels\n    values    {:.6g} to "
                    "{:.6g}\n",
                    grid.boxMin[0], grid.boxMin[1], grid.boxMin[2], grid.boxMax[0], grid.boxMax[1],
                    grid.boxMax[2], grid.minValue, grid.maxValue);
  return text + fmt::format("    memory    {}\n", bytesText(grid.bytes));
}

StreamedInfo readInfo(const std::string& path, bool withHash, std::vector<UnreadGrid>& unread,
                      Session& session) {
  Progress& progress = session.progress;
  if (isLargeVolume(path)) // all of its grids are of types that are read
    return describeVolumeFile(path, withHash, progress);
  const Volume volume = readVolume(path, progress);
  unread = volume.unread;
  warnOfNaN(volume, path, session.report);
  return {volume.metadata, describe(volume), withHash ? hash(volume) : "", {}};
}

void describeVolume(const std::string& path, bool withHash, Json& section, Session& session) {
  std::vector<UnreadGrid> unread;
  const StreamedInfo volume = readInfo(path, withHash, unread, session);
  section["format"] = formatName(volumeFormatOf(path));
  section["kind"] = "volume";
  session.text += fmt::format("{}: {}\n", oneLine(path), section["format"].get<std::string>());
  Json metadata = Json::object();
  for (const auto& [key, value] : volume.metadata) {
    metadata[key] = value;
    session.text += fmt::format("  {:<11} {}\n", oneLine(key), oneLine(value));
  }
  section["metadata"] = std::move(metadata);
  Json grids = Json::array();
  for (const GridInfo& grid : volume.grids) {
    grids.push_back(sectionOf(grid));
    session.text += gridText(grid);
  }
  section["grids"] = std::move(grids);
  section["unread"] = Json::array();
  for (const UnreadGrid& grid : unread) {
    section["unread"].push_back({{"name", grid.name}, {"type", grid.type}});
    session.text += fmt::format("  not read    {} ({})\n", oneLine(grid.name), oneLine(grid.type));
  }
  if (!withHash)
    return;
  section["hash"] = volume.hash;
  session.text += fmt::format("  hash        {}\n", volume.hash);
}

void describeFile(const std::string& path, const InfoArguments& options, Json& section,
                  Session& session) {
  if (isVolumeFile(path)) {
    session.progress.stage("read");
    describeVolume(path, options.hash, section, session);
    return;
  }
  if (holdsTriangles(path)) {
    describeTriangles(path, options.defects, section, session);
    return;
  }
  session.progress.stage("read");
  InputInfo info;
  ReadOptions read;
  read.regionArray = options.regionArray;
  const TetMesh mesh = readTets(path, read, {}, &info, session.report, session.progress);
  section = sectionOf(info, mesh);
  session.text += meshText(info, mesh);
}

// Goes on with the next file after one that cannot be read; the first error gives the status.
void runInfo(const InfoArguments& options, Session& session) {
  limitProcess(options.limits, session.progress);
  session.sections["input"] = Json::array();
  for (const std::string& path : options.files) {
    Json section = {{"path", path}};
    const auto goOn = [&](Status status, const std::string& text) {
      if (session.status == Status::Ok)
        session.status = status;
      section["error"] = text;
      session.errors.push_back(text);
    };
    try {
      describeFile(path, options, section, session);
    } catch (const Error& error) {
      if (error.status() == Status::Cancelled || options.files.size() == 1)
        throw;
      goOn(error.status(), withOptionNames(error.what()));
    } catch (const std::bad_alloc&) {
      if (options.files.size() == 1)
        throw;
      goOn(Status::Limit, path + ": does not fit in memory");
    }
    session.sections["input"].push_back(std::move(section));
  }
  // A kind of cell that cannot be voxelized is reported, but is not an error of `info`.
  session.report.partial = false;
}

} // namespace

Command addInfo(CLI::App& program) {
  CLI::App* command = program.add_subcommand("info", "Say what meshes and volumes hold");
  auto options = std::make_shared<InfoArguments>();
  command->add_option("FILE", options->files, "Meshes and volumes")->required()->type_name("");
  command->add_flag("--hash", options->hash,
                    "Print a hash of each volume: names, classes, transforms, topology, values");
  command
      ->add_option("--region-array", options->regionArray, "Cell array that holds region numbers")
      ->type_name("NAME");
  command
      ->add_option("--max-intersections", options->defects.maxIntersections,
                   "Pairs of triangles that cross: stop counting at this many; 0: do not count")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str()
      ->type_name("N");
  addProcessLimitOptions(*command, options->limits);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kInfoExamples);
  result.run = [options](Session& session) { runInfo(*options, session); };
  result.files = [options] { return FileNames{options->files, {}}; };
  return result;
}

} // namespace tetvdb::cli
